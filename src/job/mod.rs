//! A measurement from its campaign to its files: locks, resumed runs, tables with their summaries, pages and cards. What
//! `gonio measure` does, for any caller.

mod measurement;
pub mod paths;
mod resume;
mod run;
mod sweep;
mod table_output;
mod tables;
pub mod threads;
mod watcher;

pub use measurement::{Measurement, Written};
pub use paths::TablePaths;
pub use sweep::SweepPaths;
pub use table_output::WrittenTable;
pub use tables::{TableWriting, realisations_fit};
pub use watcher::{Silent, Watcher};
