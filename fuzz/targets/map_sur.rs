#![no_main]
//! Maps of Digital Surf, plain and compressed.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("map_sur", bytes));
