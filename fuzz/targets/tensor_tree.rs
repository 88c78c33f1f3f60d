#![no_main]
//! Tensor trees, Radiance XML.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::tensor_tree;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(tensor_tree::read(bytes)));
