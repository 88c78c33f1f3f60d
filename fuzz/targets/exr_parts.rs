#![no_main]
//! EXR with one part a stop.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::exr_parts;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(exr_parts::read(bytes)));
