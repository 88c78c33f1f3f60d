#![no_main]
//! Parameter maps: two EXR images, and the campaigns of their texels. The first two bytes say where the second begins.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("maps", bytes));
