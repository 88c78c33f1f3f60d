#![no_main]
//! Zemax tabular files.

use gonio::interchange::text::zemax;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(zemax::read(bytes)));
