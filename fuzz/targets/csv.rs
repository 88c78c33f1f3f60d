#![no_main]
//! CSV tables.

use gonio::interchange::text::csv;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(csv::read(bytes)));
