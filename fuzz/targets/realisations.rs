#![no_main]
//! The realisations' file.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("realisations", bytes));
