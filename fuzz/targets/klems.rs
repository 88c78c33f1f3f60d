#![no_main]
//! Klems matrices, Radiance XML.

use libfuzzer_sys::fuzz_target;
use gonio::interchange::klems;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(klems::read(bytes)));
