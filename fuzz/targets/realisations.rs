#![no_main]
//! The realisations' file.

use gonio::table::realisations;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    gonio_fuzz::format(realisations::decode(gonio_fuzz::path(), bytes));
});
