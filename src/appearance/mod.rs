//! What standards ask of a surface's look: gloss, haze, distinctness of image, integrated scatter, reflectance, colour.
//!
//! Input: a table, and its realisations where they are kept. Output: an [`Appearance`], each number a [`Quantity`] with its
//! standard error over the realisations, or with the reason why the table does not say it. An instrument is a
//! [`Receptor`] under an incidence; what it collects is a weighted sum of bins (a [`Reading`]), so that realisations are read
//! with the very weights of the table.

mod collected;
pub mod colorimetry;
pub mod gloss;
pub mod haze;
mod hemisphere;
pub mod incidence;
mod quantity;
pub mod reading;
pub mod receptor;
pub mod reflectance;
pub mod report;
mod samples;
pub mod scatter;

pub use colorimetry::ColourScale;
pub use quantity::Quantity;
pub use reading::Reading;
pub use receptor::Receptor;
pub use report::{Appearance, appearance};
