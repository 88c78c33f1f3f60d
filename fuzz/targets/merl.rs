#![no_main]
//! MERL files: as they are, and filled to their one size.

use gonio::interchange::merl::{Sampling, read};
use libfuzzer_sys::fuzz_target;

const SIZE: usize = 12 + 3 * 8 * 90 * 90 * 180;

fuzz_target!(|bytes: &[u8]| {
    gonio_fuzz::reason(read(bytes, Sampling::Node));
    // A whole file takes a thousand times as long: one input in 128.
    if bytes.len() > 12 && bytes.len() % 128 == 20 {
        let head = [90u32, 90, 180].map(u32::to_le_bytes).concat();
        let whole = [head, gonio_fuzz::filled(bytes, SIZE - 12)].concat();
        gonio_fuzz::reason(read(&whole, Sampling::Centre));
    }
});
