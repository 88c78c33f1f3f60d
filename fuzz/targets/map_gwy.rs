#![no_main]
//! Containers of Gwyddion.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("map_gwy", bytes));
