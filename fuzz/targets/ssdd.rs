#![no_main]
//! SSDD texts.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::ssdd;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(ssdd::read_with_notes(bytes)));
