#![no_main]
//! Gwyddion simple fields.

use gonio::surface::io::map_file;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(map_file::read(
    &[b"Gwyddion Simple Field 1.0\n", bytes].concat()
)));
