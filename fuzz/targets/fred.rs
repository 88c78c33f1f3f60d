#![no_main]
//! Tabulated BSDF texts of FRED.

use gonio::interchange::text::fred;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(fred::read(bytes)));
