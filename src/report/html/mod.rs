//! The page: its sections, its pictures and the data that its viewer reads.

pub mod inline;
pub mod page;
pub(crate) mod sections;
pub(crate) mod shown;
pub mod specimen;
pub mod thinned;
