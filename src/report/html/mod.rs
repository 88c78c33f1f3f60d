//! The page: its sections, its pictures and the data that its viewer reads.

pub mod appearance;
pub(crate) mod figures;
pub(crate) mod head;
pub mod inline;
pub mod page;
pub mod render;
pub(crate) mod sections;
pub(crate) mod shown;
pub mod specimen;
pub mod thinned;
pub(crate) mod through;
