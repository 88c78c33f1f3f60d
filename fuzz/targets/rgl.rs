#![no_main]
//! RGL tensor files.

use gonio::interchange::mitsuba::rgl;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(rgl::read(bytes)));
