#![no_main]
//! Zygo MetroPro.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::scan("map_zygo", bytes));
