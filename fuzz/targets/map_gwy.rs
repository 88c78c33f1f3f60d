#![no_main]
//! Containers of Gwyddion.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::scan("map_gwy", bytes));
