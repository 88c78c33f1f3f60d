#![no_main]
//! BRDF files of BiRD.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("bird", bytes));
