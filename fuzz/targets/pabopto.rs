#![no_main]
//! pab-opto texts.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::pabopto;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(pabopto::read(bytes)));
