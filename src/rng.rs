//! Random streams: one per (seed, purpose, realisation, incidence, block), hashed.
//!
//! Input: the five numbers. Output: a `Pcg64Dxsm` whose state *and* increment are hashes of all five, so that
//! the work item, not the thread, decides what is drawn, and no two items have neighbouring streams
//! (neighbouring PCG streams are correlated).

use rand::Rng;
use rand_pcg::Pcg64Dxsm;

/// What a stream is drawn for. A new draw for one purpose leaves the others as they were.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub enum Purpose {
    /// The heights of a patch.
    Surface = 1,
    /// The surface samples.
    Starts = 2,
    /// The azimuth, the direction inside the light's aperture and the mirror image of a block.
    Arms = 3,
    /// Draws of tests.
    Test = 4,
    /// The seeds of the runs of a ladder.
    Bench = 5,
    /// The trials of a budget.
    Budget = 8,
    /// Which way paths go at facets that leave it to chance.
    Facets = 7,
    /// The realisations into which a value and its error are split.
    Split = 6,
}

/// The address of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StreamId {
    /// The campaign's seed.
    pub seed: u64,
    /// What is drawn.
    pub purpose: Purpose,
    /// Realisation, from 0.
    pub realisation: u64,
    /// The incidence by its angles (`incidence_key`), 0 where incidences share the draw.
    pub incidence: u64,
    /// Block, from 0; 0 where blocks share the draw.
    pub block: u64,
}

/// The generator of a stream.
pub fn stream(id: StreamId) -> Pcg64Dxsm {
    let wide = |a: u64, b: u64| (u128::from(word(id, a)) << 64) | u128::from(word(id, b));
    Pcg64Dxsm::new(wide(1, 2), wide(3, 4))
}

/// The generator of one path of a stream, by its number: paths that draw more or fewer numbers leave the others as they
/// were.
pub fn stream_of_path(id: StreamId, path: u64) -> Pcg64Dxsm {
    let own = mix(key(id) ^ mix(path.wrapping_add(SPLIT_STEP)));
    stream(StreamId { incidence: own, ..id })
}

fn word(id: StreamId, salt: u64) -> u64 {
    [id.seed, id.purpose as u64, id.realisation, id.incidence, id.block]
        .iter()
        .fold(mix(salt), |hash, &part| mix(hash ^ mix(part.wrapping_add(SPLIT_STEP))))
}

/// A hash of a stream's address, for draws by number.
pub fn key(id: StreamId) -> u64 {
    word(id, 5)
}

/// Uniform numbers of one path by its number in a block: paths may be followed in any order.
#[derive(Debug, Clone, Copy)]
pub struct PathDraws {
    block_key: u64,
    path: u64,
    /// Numbers that were drawn.
    drawn: u64,
}

impl PathDraws {
    /// Those of a path; `block_key` is the [`key`] of its block.
    pub fn new(block_key: u64, path: u64) -> Self {
        PathDraws { block_key, path, drawn: 0 }
    }

    /// The next number in [0, 1), of 53 bits: SplitMix64 (Steele, Lea, Flood 2014).
    // Tested by `draws_of_paths_are_uniform_and_independent`.
    pub fn uniform(&mut self) -> f64 {
        self.drawn += 1;
        // Only here: the facets of most paths draw nothing.
        let first = mix(self.block_key ^ mix(self.path.wrapping_add(SPLIT_STEP)));
        (mix(first.wrapping_add(self.drawn.wrapping_mul(SPLIT_STEP))) >> 11) as f64
            * (1.0 / (1u64 << 53) as f64)
    }
}

/// The odd step of SplitMix64: 2^64 over the golden ratio.
const SPLIT_STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// A hash of an incidence's angles (degrees, in the sample's frame): adding an incidence leaves the others as they were.
pub fn incidence_key(theta_i_deg: f64, phi_i_deg: f64) -> u64 {
    // `+ 0.0` makes -0 and 0 one angle.
    mix(mix((theta_i_deg + 0.0).to_bits()) ^ (phi_i_deg + 0.0).to_bits().rotate_left(1))
}

/// Steps of an additive sequence that fills the unit square evenly: the plastic number's (Roberts 2018, "The unreasonable
/// effectiveness of quasirandom sequences").
pub const PLASTIC: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];

/// A uniform number in [0, 1) of 53 bits. Own conversion: those of `rand` may change between versions.
pub fn uniform(rng: &mut Pcg64Dxsm) -> f64 {
    (rng.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// A normal number of mean 0 and variance 1 (Box and Muller 1958, one of their two).
pub fn normal(rng: &mut Pcg64Dxsm) -> f64 {
    let radius = (-2.0 * (1.0 - uniform(rng)).ln()).sqrt();
    radius * (std::f64::consts::TAU * uniform(rng)).cos()
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection of the 64-bit words that mixes every bit.
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(realisation: u64, block: u64) -> StreamId {
        StreamId { seed: 1, purpose: Purpose::Test, realisation, incidence: 0, block }
    }

    /// z = (chi2 - dof)/sqrt(2 dof) of 2^20 first draws in 16,384 bins; |z| < 4.5 has probability 7e-6 of failing
    /// by chance. Consecutive `Pcg64Mcg` seeds reach z > 80 here.
    #[test]
    fn first_draws_of_consecutive_blocks_are_uniform() {
        let mut counts = vec![0u32; 16_384];
        for block in 0..1u64 << 20 {
            counts[(uniform(&mut stream(id(0, block))) * 16_384.0) as usize] += 1;
        }
        let expected = 64.0;
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - expected).powi(2) / expected).sum();
        let dof = 16_383.0f64;
        let z = (chi2 - dof) / (2.0 * dof).sqrt();
        assert!(z.abs() < 4.5, "z = {z}");
    }

    /// As above, on pairs (draw n of path k, the same of path k + 1) and (draw n, draw n + 1 of one path).
    #[test]
    fn draws_of_paths_are_uniform_and_independent() {
        let mut counts = [vec![0u32; 16_384], vec![0u32; 16_384]];
        let block = key(id(0, 0));
        let cell = |a: f64, b: f64| (a * 128.0) as usize * 128 + (b * 128.0) as usize;
        for path in 0..1u64 << 20 {
            let (mut own, mut next) = (PathDraws::new(block, path), PathDraws::new(block, path + 1));
            let (first, second) = (own.uniform(), own.uniform());
            counts[0][cell(first, next.uniform())] += 1;
            counts[1][cell(first, second)] += 1;
        }
        for counts in counts {
            let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - 64.0).powi(2) / 64.0).sum();
            let z = (chi2 - 16_383.0) / (2.0 * 16_383.0f64).sqrt();
            assert!(z.abs() < 4.5, "z = {z}");
        }
    }

    #[test]
    fn neighbouring_streams_are_not_correlated() {
        // Pairs (block b, block b + 1) in a 128 x 128 table, same statistic as above.
        let mut counts = vec![0u32; 16_384];
        let draws: Vec<f64> = (0..=1u64 << 20).map(|b| uniform(&mut stream(id(b >> 10, b)))).collect();
        for pair in draws.windows(2) {
            counts[(pair[0] * 128.0) as usize * 128 + (pair[1] * 128.0) as usize] += 1;
        }
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - 64.0).powi(2) / 64.0).sum();
        let z = (chi2 - 16_383.0) / (2.0 * 16_383.0f64).sqrt();
        assert!(z.abs() < 4.5, "z = {z}");
    }

    #[test]
    fn seeds_that_differ_in_the_top_bit_give_other_streams() {
        let draw = |seed| uniform(&mut stream(StreamId { seed, ..id(0, 0) }));
        assert_ne!(draw(0), draw(1 << 63));
    }
}
