#![no_main]
//! ASTM E2387 texts.

use gonio::interchange::text::astm;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(astm::read(bytes)));
