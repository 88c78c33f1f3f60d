#![no_main]
//! CSV tables.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::csv;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(csv::read(bytes)));
