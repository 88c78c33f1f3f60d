#![no_main]
//! X3P: `main.xml` and the member of its heights.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("map_x3p", bytes));
