#![no_main]
//! CSV tables.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("csv", bytes));
