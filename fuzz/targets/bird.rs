#![no_main]
//! BRDF files of BiRD.

use gonio::interchange::text::bird;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(bird::read_with_notes(bytes)));
