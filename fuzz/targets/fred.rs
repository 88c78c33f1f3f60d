#![no_main]
//! Tabulated BSDF texts of FRED.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("fred", bytes));
