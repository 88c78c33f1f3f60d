#![no_main]
//! ASTM E2387 texts.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("astm", bytes));
