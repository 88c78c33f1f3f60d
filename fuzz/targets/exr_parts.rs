#![no_main]
//! EXR with one part a stop.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("exr_parts", bytes));
