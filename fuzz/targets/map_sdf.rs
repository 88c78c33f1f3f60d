#![no_main]
//! Surface data files, binary and text.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("map_sdf", bytes));
