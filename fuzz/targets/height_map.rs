#![no_main]
//! Height maps, told apart by their first bytes: EXR, NPY, GSF, XYZ.

use gonio::surface::io::map_file;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(map_file::read(bytes)));
