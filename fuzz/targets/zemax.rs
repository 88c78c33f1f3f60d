#![no_main]
//! Zemax tabular files.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::zemax;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(zemax::read(bytes)));
