#![no_main]
//! What checkpoints, shards and finished bands hold behind their checksum, for a small campaign to resume.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("checkpoint", bytes));
