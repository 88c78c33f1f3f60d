#![no_main]
//! Files of (n, k) over wavelengths, which a campaign names.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("index_file", bytes));
