#![no_main]
//! Zemax tabular files.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("zemax", bytes));
