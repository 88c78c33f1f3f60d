#![no_main]
//! Maps of Digital Surf, plain and compressed.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::scan("map_sur", bytes));
