#![no_main]
//! Rays over heights of any size.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("traced_map", bytes));
