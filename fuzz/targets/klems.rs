#![no_main]
//! Klems matrices, Radiance XML.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("klems", bytes));
