#![no_main]
//! The campaign parser. What is accepted is written as TOML and read as the same campaign.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| gonio_fuzz::read("campaign", bytes));
