#![no_main]
//! Parameter maps: two EXR images, and the campaigns of their texels. The first two bytes say where the second begins.

use gonio::interchange::maps;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let [a, b, rest @ ..] = bytes else { return };
    let (alpha, f0) = rest.split_at(usize::from(u16::from_le_bytes([*a, *b])).min(rest.len()));
    let found = maps::read(alpha, f0);
    if let Ok(maps) = &found {
        gonio_fuzz::reason(maps.campaign(0, 0));
    }
    gonio_fuzz::reason(found);
});
