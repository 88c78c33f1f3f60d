#![no_main]
//! Rays over heights of any size.

use gonio_fuzz::traced;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| traced::trace(bytes));
