#![no_main]
//! SSDD texts.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("ssdd", bytes));
