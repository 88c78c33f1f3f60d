#![no_main]
//! Tensor trees, Radiance XML.

use gonio::interchange::radiance::tensor_tree;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(tensor_tree::read(bytes)));
