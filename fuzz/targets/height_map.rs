#![no_main]
//! Height maps, told apart by their first bytes: EXR, NPY, GSF, XYZ.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("height_map", bytes));
