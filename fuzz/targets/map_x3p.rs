#![no_main]
//! X3P: `main.xml` and the member of its heights.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::scan("map_x3p", bytes));
