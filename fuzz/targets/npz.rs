#![no_main]
//! NPZ archives, and the NPY arrays in them.

use gonio::interchange::numpy::npz;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(npz::read(bytes)));
