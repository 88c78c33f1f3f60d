#![no_main]
//! Gwyddion simple fields.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("map_gsf", bytes));
