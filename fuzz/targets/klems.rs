#![no_main]
//! Klems matrices, Radiance XML.

use gonio::interchange::radiance::klems;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(klems::read(bytes)));
