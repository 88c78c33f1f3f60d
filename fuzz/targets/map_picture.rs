#![no_main]
//! TIFF and PNG.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("map_picture", bytes));
