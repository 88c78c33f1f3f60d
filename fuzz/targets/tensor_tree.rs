#![no_main]
//! Tensor trees, Radiance XML.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("tensor_tree", bytes));
