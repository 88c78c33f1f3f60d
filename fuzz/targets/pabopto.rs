#![no_main]
//! pab-opto texts.

use gonio::interchange::text::pabopto;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(pabopto::read(bytes)));
