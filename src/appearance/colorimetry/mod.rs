//! CIE's colorimetry: from a table's colours to XYZ and L*a*b*.

mod cie;
mod lab;
mod scale;

pub use cie::{Illuminant, Observer};
pub use lab::lab;
pub use scale::{ColourScale, Tristimulus};
