#![no_main]
//! MERL files: as they are, and filled to their one size.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("merl", bytes));
