#![no_main]
//! RGL tensor files.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::rgl;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(rgl::read(bytes)));
