#![no_main]
//! The table's own file. What is read is written again and read as the same.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("table", bytes));
