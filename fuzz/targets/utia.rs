#![no_main]
//! UTIA files and their image form: as they are, and filled to the one size of a `.bin`.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("utia", bytes));
