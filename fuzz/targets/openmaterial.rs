#![no_main]
//! OpenMATERIAL texts.

use gonio::interchange::text::openmaterial;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| gonio_fuzz::reason(openmaterial::read(bytes)));
