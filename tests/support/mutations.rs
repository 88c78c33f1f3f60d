//! Damage to files: bytes changed, cut off, doubled. The same from every run.

use std::env;
use std::path::Path;

use gonio::error::{ContentError, Error};

/// A small repeatable source of bits (splitmix64).
pub struct Bits(pub u64);

impl Bits {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    /// In [0, 1), 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u32 << 24) as f32
    }
}

/// Damaged copies that a reader of files is tried with: ten thousand, or as many as GONIO_DAMAGED says (`.ci/nightly`: a
/// hundred thousand, of which these are the first).
pub fn rounds() -> usize {
    env::var("GONIO_DAMAGED").map_or(10_000, |count| count.parse().expect("a number"))
}

/// The share of damaged copies of `good` that `read` refuses, as [`survives`] has it.
pub fn refused<T, E: Into<ContentError>>(good: &[u8], read: impl Fn(&[u8]) -> Result<T, E>) -> f64 {
    survives(good, rounds(), read) as f64 / rounds() as f64
}

/// Feeds `rounds` damaged copies of `good` to `read`, which must return (not panic) and whose reasons must be one line
/// where the program shows them.
/// Returns how many were refused.
pub fn survives<T, E: Into<ContentError>>(
    good: &[u8],
    rounds: usize,
    read: impl Fn(&[u8]) -> Result<T, E>,
) -> usize {
    let mut bits = Bits(good.len() as u64);
    let interesting = [0u8, 1, 0x7f, 0x80, 0xff, b'-', b'9', b'<', b'n', b'\n', b','];
    let mut refused = 0;
    for _ in 0..rounds {
        let mut bytes = good.to_vec();
        for _ in 0..=bits.below(3) {
            let at = bits.below(bytes.len());
            match bits.below(6) {
                0 => bytes.truncate(at),
                1 => bytes.insert(at, bits.next() as u8),
                2 => bytes.extend_from_slice(&good[..at.min(64)]),
                3 if !bytes.is_empty() => bytes[at] = interesting[bits.below(interesting.len())],
                _ if !bytes.is_empty() => bytes[at] ^= 1 << bits.below(8),
                _ => {}
            }
        }
        if let Err(reason) = read(&bytes) {
            let reason = reason.into();
            let is_empty = reason.to_string().is_empty();
            let shown = Error::format(Path::new("damaged"), reason).to_string();
            assert!(!is_empty && !shown.contains('\n') && shown.chars().count() <= 500, "{shown}");
            refused += 1;
        }
    }
    refused
}
