#![no_main]
//! OpenMATERIAL texts.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("openmaterial", bytes));
