//! 9. What a measurement says to its reader: the summary, the page, the plot in the terminal.

pub mod card;
pub mod chart;
pub mod convergence;
pub mod inline;
pub mod markdown;
pub mod masking;
pub mod page;
pub mod plots;
pub mod polar;
mod sections;
mod shown;
pub mod slices;
pub mod specimen;
pub mod summary;
pub mod terminal;
pub mod thinned;

pub use card::{Facts, card, card_of};
pub use page::{Page, page};
pub use slices::Scene;
pub use thinned::{thinned, thinned_summary};
