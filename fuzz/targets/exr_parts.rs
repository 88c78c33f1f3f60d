#![no_main]
//! EXR with one part a stop.

use gonio::interchange::exr_parts;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(exr_parts::read(bytes)));
