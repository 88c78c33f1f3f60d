#![no_main]
//! SSDD texts.

use gonio::interchange::text::ssdd;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(ssdd::read_with_notes(bytes)));
