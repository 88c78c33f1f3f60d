#![no_main]
//! Lines of x y z.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("map_xyz", bytes));
