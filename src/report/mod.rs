//! What a measurement says to its reader: the summary, the page, the plot in the terminal.

pub mod card;
pub mod html;
pub mod markdown;
pub mod plot;
pub mod slices;
pub mod summary;

pub use card::{Facts, card, card_of};
pub use html::page::{Page, page};
pub use html::thinned::{thinned, thinned_summary};
pub use slices::Scene;
