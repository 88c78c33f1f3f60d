#![no_main]
//! ASTM E2387 texts.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::astm;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(astm::read(bytes)));
