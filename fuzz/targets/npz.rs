#![no_main]
//! NPZ archives, and the NPY arrays in them.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::npz;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(npz::read(bytes)));
