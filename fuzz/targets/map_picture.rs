#![no_main]
//! TIFF and PNG.

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::scan("map_picture", bytes));
