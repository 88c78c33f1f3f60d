//! 1. The campaign: TOML in, a checked `Campaign` or the list of *all* faults out.

pub mod schema;

pub use schema::*;
