//! Slope lengths, ranked by counting within classes.
//!
//! They spread over many octaves: a histogram has 32 bins for every doubling of their square, read off the bits of the float.

use super::facets::Facets;
use crate::lanes::vector::Lanes;

/// Bits of a float below its bin number: 5 bits of mantissa remain.
const SHIFT: u32 = 18;
/// First squared length with a bin of its own, 2^-32, and its bits.
const SHORTEST: f32 = 1.0 / (1u64 << 32) as f32;
const FIRST: u32 = SHORTEST.to_bits() >> SHIFT;
/// To 2^32.
pub(super) const LENGTH_BINS: usize = 64 << (23 - SHIFT);

/// Squared slope lengths by class: how many lie in each bin.
pub(super) struct LengthRanks {
    /// A class after the other.
    counts: Vec<u32>,
    /// `place_in_step` of each class.
    places: Vec<f64>,
}

/// Values of one class in one bin.
pub(super) struct RankedBin {
    /// Its place among the bins of all classes.
    pub index: usize,
    /// How many.
    pub count: u32,
    /// Shares of the class below the shortest and the longest of them, in (0, 1).
    pub shares: [f64; 2],
}

impl RankedBin {
    /// The share of the class below its middle one.
    pub fn middle(&self) -> f32 {
        (0.5 * (self.shares[0] + self.shares[1])) as f32
    }
}

/// Step of an additive sequence that fills (0, 1) evenly: the golden ratio's.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Where in the step of its rank a value of a class stands, (0, 1): another place for each class, evenly spread. With the
/// middle for all, the longest slopes of 64 classes would be equal, and those that should be longer missing: on patches
/// of 512 x 512 the discrepancy at alpha 0.5 was 5 % larger than on 1024 x 1024, and 10 % larger than it is so.
fn place_in_step(class: usize) -> f64 {
    ((class as f64 + 0.5) * GOLDEN).fract()
}

impl LengthRanks {
    /// Nothing counted yet.
    pub fn new(classes: usize) -> Self {
        LengthRanks {
            counts: vec![0; classes * LENGTH_BINS],
            places: (0..classes).map(place_in_step).collect(),
        }
    }

    /// Squared lengths as they are looked up: of shorter ones than the first bin's none is told apart.
    #[inline(always)]
    pub fn told_apart<L: Lanes>(l: L, facets: &Facets<L>) -> L::F {
        l.max(facets.squared(l), l.splat(SHORTEST))
    }

    /// The bins of `told_apart` lengths within their class.
    #[inline(always)]
    pub fn bin<L: Lanes>(l: L, squared: L::F) -> L::I {
        let bin = l.shr(l.to_bits(squared), l.splat_i(SHIFT as i32));
        l.min_i(l.sub_i(bin, l.splat_i(FIRST as i32)), l.splat_i(LENGTH_BINS as i32 - 1))
    }

    /// The places of `told_apart` lengths in their bins, [0, 1).
    #[inline(always)]
    pub fn part<L: Lanes>(l: L, squared: L::F) -> L::F {
        let low_bits = l.and_i(l.to_bits(squared), l.splat_i((1 << SHIFT) - 1));
        l.mul(l.to_f(low_bits), l.splat(1.0 / (1 << SHIFT) as f32))
    }

    /// Counts one value of a bin among those of all classes.
    #[inline(always)]
    pub fn count(&mut self, index: usize) {
        self.counts[index] += 1;
    }

    /// All bins that hold some: a single value stands at `place_in_step` of its rank's step.
    pub fn bins(&self) -> impl Iterator<Item = RankedBin> {
        self.counts.chunks_exact(LENGTH_BINS).zip(&self.places).enumerate().flat_map(
            |(class, (counts, place))| {
                let all: u32 = counts.iter().sum();
                let mut below = 0;
                counts.iter().enumerate().filter(|(_, count)| **count > 0).map(move |(bin, &count)| {
                    let first = f64::from(below) + place;
                    below += count;
                    let last = first + f64::from(count - 1);
                    let shares = [first, last].map(|rank| rank / f64::from(all));
                    RankedBin { index: class * LENGTH_BINS + bin, count, shares }
                })
            },
        )
    }

    /// Bins of all classes.
    pub fn number_of_bins(&self) -> usize {
        self.counts.len()
    }

    /// Squared lengths below which lie the ascending `shares` of all classes together.
    pub fn quantiles(&self, shares: &[f64]) -> Vec<f64> {
        let mut together = vec![0u32; LENGTH_BINS];
        for counts in self.counts.chunks_exact(LENGTH_BINS) {
            together.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        }
        let all: f64 = together.iter().map(|&count| f64::from(count)).sum();
        let (mut bin, mut first, mut end) = (0, 0.0, f64::from(together[0]));
        let edge = |bin: usize| f64::from(f32::from_bits((bin as u32 + FIRST) << SHIFT));
        let quantile = |share: &f64| {
            while end < share * all && bin + 1 < LENGTH_BINS {
                bin += 1;
                (first, end) = (end, end + f64::from(together[bin]));
            }
            let part = if end > first { (share * all - first) / (end - first) } else { 0.5 };
            edge(bin) + part * (edge(bin + 1) - edge(bin))
        };
        shares.iter().map(quantile).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::scalar::One;

    /// Values of a law with both tails, in no order.
    fn values(count: usize) -> Vec<f32> {
        let golden = |i: usize| (i as f64 * GOLDEN).fract();
        (0..count).map(|i| (golden(i + 1) / (1.0 - golden(i + 1))).ln() as f32).collect()
    }

    /// The rank of a squared length as `Targets` finds what it becomes: between the shares of its bin.
    fn share(ranks: &LengthRanks, class: usize, squared: f32) -> f64 {
        let index = class * LENGTH_BINS + LengthRanks::bin(One, squared) as usize;
        let [shortest, longest] =
            ranks.bins().find(|bin| bin.index == index).expect("a counted length").shares;
        shortest + f64::from(LengthRanks::part(One, squared)) * (longest - shortest)
    }

    fn counted(classes: usize, class: usize, squared: impl IntoIterator<Item = f32>) -> LengthRanks {
        let mut ranks = LengthRanks::new(classes);
        for squared in squared {
            ranks.count(class * LENGTH_BINS + LengthRanks::bin(One, squared) as usize);
        }
        ranks
    }

    #[test]
    fn lengths_have_the_ranks_that_a_sort_gives() {
        let lengths: Vec<f32> = values(20_000).iter().map(|v| v.exp()).collect();
        let mut sorted = lengths.clone();
        sorted.sort_by(f32::total_cmp);
        let mut ranks = counted(2, 1, lengths);
        ranks.count(LengthRanks::bin(One, 1.0) as usize);
        for (rank, &length) in sorted.iter().enumerate().step_by(101) {
            let exact = (rank as f64 + 0.5) / 20_000.0;
            // A bin is 1/32 of an octave at most 3.2 % wide, and holds at most 0.8 % of the law: its density changes by
            // 3 % in it, which moves a rank by at most an eighth of 3 % of 0.8 %. A value is half a rank off, and its
            // neighbours lie a rank or two from where an even sequence has them: 3/20000.
            assert!((share(&ranks, 1, length) - exact).abs() < 3e-5 + 3.5 / 20_000.0, "{length}");
        }
        // The longest value is alone in its bin: its rank is exact.
        let top = share(&ranks, 1, sorted[19_999]);
        let expected = 1.0 - (1.0 - place_in_step(1)) / 20_000.0;
        assert!((top - expected).abs() < 2.0 * f64::EPSILON, "{top}");
        assert_eq!(share(&ranks, 0, 1.0), place_in_step(0));
        // 20,000 of 20,001 values: their median is 1, the law's own, to the width of a bin.
        let median = ranks.quantiles(&[0.5])[0];
        assert!((median - 1.0).abs() < 0.033, "{median}");
    }

    #[test]
    fn the_longest_of_all_classes_together_are_spread_like_ranks() {
        const CLASSES: usize = 64;
        let mut places: Vec<f64> = (0..CLASSES).map(place_in_step).collect();
        places.sort_by(f64::total_cmp);
        assert!(places[0] > 0.0 && places[CLASSES - 1] < 1.0);
        for (k, place) in (0..).zip(&places) {
            // An additive sequence of the golden ratio leaves no gap above 2/n, so that the k-th of n places is off by
            // a few steps at most: it has discrepancy below (1 + ln n)/n.
            let steps = place * CLASSES as f64 - f64::from(k) - 0.5;
            assert!(steps.abs() < 1.0 + (CLASSES as f64).ln(), "{k}: {place}");
        }
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] < 2.0 / CLASSES as f64));
    }

    #[test]
    fn no_rank_of_a_large_class_is_one() {
        // A class of the largest patches.
        let ranks = counted(3, 2, std::iter::repeat_n(1.0, 1 << 23).chain([4.0]));
        let top = share(&ranks, 2, 4.0);
        assert!(top < 1.0 && (1.0 - top).recip().is_finite(), "{top}");
    }
}
