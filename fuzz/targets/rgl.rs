#![no_main]
//! RGL tensor files.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("rgl", bytes));
