#![no_main]
//! pab-opto texts.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("pabopto", bytes));
