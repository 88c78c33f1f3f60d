#![no_main]
//! Surface data files, binary and text.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::scan("map_sdf", bytes));
