#![no_main]
//! UTIA files and their image form: as they are, and filled to the one size of a `.bin`.

use gonio::interchange::utia::read;
use libfuzzer_sys::fuzz_target;

const SIZE: usize = 3 * 8 * 288 * 288;

fuzz_target!(|bytes: &[u8]| {
    gonio_fuzz::reason(read(bytes));
    if bytes.len() > 8 && bytes.len() % 8 == 3 {
        gonio_fuzz::reason(read(&gonio_fuzz::filled(bytes, SIZE)));
    }
});
