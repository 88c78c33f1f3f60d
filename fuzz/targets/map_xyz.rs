#![no_main]
//! Lines of x y z.

use gonio::surface::io::map_file;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(map_file::read(&[b"0 0 0\n", bytes].concat())));
