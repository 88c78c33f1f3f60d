//! What the program does when something is done to it from outside: killed, short of memory or disk, let down by the
//! system, given files that are meant to harm.
//!
//! `cargo test --test process NAME` runs the tests whose path holds `NAME`. All else is in `tests/it`.

#[path = "../support/mod.rs"]
mod support;

mod bad_inputs;
mod bombs;
mod failing_calls;
mod files_under_failure;
mod full_disk;
mod hostile_maps;
mod kills_and_resume;
mod kills_in_bands;
mod shards;
mod signals;
mod two_hosts;
