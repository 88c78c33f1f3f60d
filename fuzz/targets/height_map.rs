#![no_main]
//! Height maps, told apart by their first bytes: EXR, NPY, GSF, XYZ.

use libfuzzer_sys::fuzz_target;
use gonio::surface::map_file;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(map_file::read(bytes)));
