#![no_main]
//! Zygo MetroPro.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("map_zygo", bytes));
