//! What a measurement says to its reader: the summary, the page, the plot in the terminal.

pub mod budget_page;
pub mod card;
pub mod html;
pub mod markdown;
pub mod plot;
mod quality;
pub mod scan_law;
pub mod slices;
pub mod summary;
pub mod sweep;

pub use card::card;
pub use html::page::Page;
pub use html::render::page;
pub use html::thinned::thinned;
pub use quality::Facts;
pub use slices::Scene;
pub use summary::{IncidenceSummary, Summary};
