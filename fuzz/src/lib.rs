//! The readers, asked as `cargo fuzz` asks: bytes in, nothing out.

mod readers;
mod scans;
mod traced;

pub use readers::read;
