#![no_main]
//! NPZ archives, and the NPY arrays in them.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("npz", bytes));
