//! Ranks by counting: which share of many values lies below a given one, in one pass and without a sort.
//!
//! A histogram answers to the bin exactly and between its edges linearly. Heights have bins of equal width between
//! the lowest and the highest; slope lengths spread over many octaves and have 64 bins for every doubling of their
//! square, read off the bits of the float.

/// Bins of the heights.
const HEIGHT_BINS: usize = 4096;
/// Bits of a float below its bin number: 6 bits of mantissa remain.
const SHIFT: u32 = 17;
/// First and last squared length with a bin of its own: 2^-40 and 2^40.
const FIRST: u32 = (127 - 40) << (23 - SHIFT);
const LENGTH_BINS: usize = 80 << (23 - SHIFT);

/// Heights and the share of them below each.
pub struct HeightRanks {
    lowest: f32,
    bins_per_height: f32,
    /// Heights below each bin's lower edge; one entry more than bins.
    below: Vec<u32>,
    /// The same as shares of all.
    shares: Vec<f32>,
}

impl HeightRanks {
    /// Counts `heights`, of which there must be some, all finite.
    pub fn of(heights: &[f32]) -> Self {
        let (low, high) =
            heights.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), &h| (lo.min(h), hi.max(h)));
        let mut ranks = HeightRanks {
            lowest: low,
            bins_per_height: HEIGHT_BINS as f32 / (high - low).max(f32::MIN_POSITIVE),
            below: vec![0; HEIGHT_BINS + 1],
            shares: Vec::new(),
        };
        for &height in heights {
            let bin = ranks.bin(height).0;
            ranks.below[bin + 1] += 1;
        }
        accumulate(&mut ranks.below);
        ranks.shares = ranks.below.iter().map(|&below| below as f32 / heights.len() as f32).collect();
        ranks
    }

    /// The bin of a height and the place in it, [0, 1].
    #[inline]
    fn bin(&self, height: f32) -> (usize, f32) {
        let place = ((height - self.lowest) * self.bins_per_height).max(0.0);
        let bin = (place as usize).min(HEIGHT_BINS - 1);
        (bin, (place - bin as f32).min(1.0))
    }

    /// Share of the heights below `height`, [0, 1].
    #[inline]
    pub fn share(&self, height: f32) -> f32 {
        self.look_up(&self.shares, height)
    }

    /// A function of the share of heights below, tabulated at the bins' edges; the shares keep half a height's
    /// distance from 0 and 1.
    pub fn table(&self, f: impl Fn(f64) -> f64) -> Vec<f32> {
        let all = f64::from(self.below[HEIGHT_BINS]);
        let share = |&below: &u32| f64::from(below).clamp(0.5, all - 0.5) / all;
        self.below.iter().map(|below| f(share(below)) as f32).collect()
    }

    /// What `table` says at `height`, linear between the edges.
    #[inline]
    pub fn look_up(&self, table: &[f32], height: f32) -> f32 {
        let (bin, part) = self.bin(height);
        table[bin] + part * (table[bin + 1] - table[bin])
    }

    /// The distance from 0 within which `share` of the heights lie, to a bin's width.
    pub fn quantile_of_distance(&self, share: f32) -> f32 {
        let width = 1.0 / self.bins_per_height;
        let furthest = self.lowest.abs().max((self.lowest + HEIGHT_BINS as f32 * width).abs());
        let within = |distance: f32| self.share(distance) - self.share(-distance);
        let steps = (furthest / width) as usize;
        let (mut low, mut high) = (0, steps + 1);
        while low + 1 < high {
            let middle = (low + high) / 2;
            if within(middle as f32 * width) < share { low = middle } else { high = middle }
        }
        high as f32 * width
    }
}

/// Squared slope lengths in classes, and the share of its class below each.
pub struct LengthRanks {
    /// Lengths of the same class below each bin's lower edge: a class after the other, one entry more than bins.
    below: Vec<u32>,
    /// 1 over the number in each class.
    weights: Vec<f32>,
    /// `place_in_step` of each class.
    places: Vec<f32>,
}

const STRIDE: usize = LENGTH_BINS + 1;
/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - 0.5 * f32::EPSILON;
/// Step of an additive sequence that fills (0, 1) evenly: the golden ratio's.
const GOLDEN: f32 = 0.618_034;

/// Where in the step of its rank a value of a class stands, (0, 1): another place for each class, evenly spread. With the
/// middle for all, the longest slopes of 64 classes would be equal, and those that should be longer missing: on patches
/// of 512 x 512 the discrepancy at alpha 0.5 was 5 % larger than on 1024 x 1024, and 10 % larger than it is so.
fn place_in_step(class: usize) -> f32 {
    ((class as f32 + 0.5) * GOLDEN).fract()
}

impl LengthRanks {
    /// Nothing counted yet.
    pub fn new(classes: usize) -> Self {
        let places = (0..classes).map(place_in_step).collect();
        LengthRanks { below: vec![0; classes * STRIDE], weights: Vec::new(), places }
    }

    /// Counts one squared length >= 0.
    #[inline]
    pub fn count(&mut self, class: usize, squared: f32) {
        self.below[class * STRIDE + length_bin(squared) + 1] += 1;
    }

    /// Turns counts into ranks: call once, when all are counted.
    pub fn finish(&mut self) {
        self.below.chunks_exact_mut(STRIDE).for_each(accumulate);
        self.weights = self.below.chunks_exact(STRIDE).map(|below| 1.0 / below[LENGTH_BINS] as f32).collect();
    }

    /// Share of the class below a squared length, in (0, 1): a single value stands at `place_in_step` of its rank's step.
    #[inline]
    pub fn share(&self, class: usize, squared: f32) -> f32 {
        let bin = length_bin(squared);
        let below = &self.below[class * STRIDE..(class + 1) * STRIDE];
        let (first, end) = (below[bin], below[bin + 1]);
        // The bits below the bin number are the place in the bin.
        let part = (squared.to_bits() & ((1 << SHIFT) - 1)) as f32 / (1 << SHIFT) as f32;
        let rank = first as f32 + self.places[class] + part * (end - first).saturating_sub(1) as f32;
        // In classes of more than 2^22 the last rank may be rounded to 1.
        (rank * self.weights[class]).min(BELOW_ONE)
    }

    /// Squared lengths below which lie the ascending `shares` of all classes together.
    pub fn quantiles(&self, shares: &[f64]) -> Vec<f64> {
        let together =
            |bin: usize| -> f64 { self.below.chunks_exact(STRIDE).map(|below| f64::from(below[bin])).sum() };
        let all = together(LENGTH_BINS);
        let (mut bin, mut first, mut end) = (0, 0.0, together(1));
        let quantile = |share: &f64| {
            while end < share * all && bin + 1 < LENGTH_BINS {
                bin += 1;
                (first, end) = (end, together(bin + 1));
            }
            let low = f64::from(f32::from_bits((bin as u32 + FIRST) << SHIFT));
            let high = f64::from(f32::from_bits((bin as u32 + 1 + FIRST) << SHIFT));
            let part = if end > first { (share * all - first) / (end - first) } else { 0.5 };
            low + part * (high - low)
        };
        shares.iter().map(quantile).collect()
    }
}

#[inline]
fn length_bin(squared: f32) -> usize {
    ((squared.to_bits() >> SHIFT).saturating_sub(FIRST) as usize).min(LENGTH_BINS - 1)
}

/// Running sums.
fn accumulate(counts: &mut [u32]) {
    let mut sum = 0;
    for count in counts {
        sum += *count;
        *count = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of a law with both tails, in no order.
    fn values(count: usize) -> Vec<f32> {
        let golden = |i: usize| (i as f64 * 0.618_033_988_749_894_9).fract();
        (0..count).map(|i| (golden(i + 1) / (1.0 - golden(i + 1))).ln() as f32).collect()
    }

    #[test]
    fn heights_have_the_ranks_that_a_sort_gives() {
        let heights = values(20_000);
        let mut sorted = heights.clone();
        sorted.sort_by(f32::total_cmp);
        let ranks = HeightRanks::of(&heights);
        for (rank, &height) in sorted.iter().enumerate().step_by(97) {
            let exact = (rank as f32 + 0.5) / 20_000.0;
            // A bin is 1/4096 of a range of 20 and the law's density at most 1/4: 0.0012 of all lie in one bin.
            assert!(
                (ranks.share(height) - exact).abs() < 1.3e-3,
                "{height}: {} {exact}",
                ranks.share(height)
            );
        }
        // Half of the heights lie within ln 3 of the middle; a bin is 0.005 wide.
        assert!((ranks.quantile_of_distance(0.5) - 3f32.ln()).abs() < 0.011);
    }

    #[test]
    fn a_table_is_read_at_the_height_of_its_rank() {
        let heights = values(20_000);
        let ranks = HeightRanks::of(&heights);
        let table = ranks.table(|u| (u / (1.0 - u)).ln());
        for &height in heights.iter().filter(|h| h.abs() < 3.0).step_by(31) {
            // The law is its own quantile function: the height comes back, to the 0.005 of a bin and its neighbours.
            assert!((ranks.look_up(&table, height) - height).abs() < 0.02, "{height}");
        }
    }

    #[test]
    fn lengths_have_the_ranks_that_a_sort_gives() {
        let lengths: Vec<f32> = values(20_000).iter().map(|v| v.exp()).collect();
        let mut sorted = lengths.clone();
        sorted.sort_by(f32::total_cmp);
        let mut ranks = LengthRanks::new(2);
        lengths.iter().for_each(|&length| ranks.count(1, length));
        ranks.count(0, 1.0);
        ranks.finish();
        for (rank, &length) in sorted.iter().enumerate().step_by(101) {
            let exact = (rank as f32 + 0.5) / 20_000.0;
            // A bin is 1/64 of an octave at most 2 % wide, and holds at most 0.5 % of the law: curvature inside it
            // moves a rank by less than a tenth of that.
            assert!((ranks.share(1, length) - exact).abs() < 5e-4, "{length}");
        }
        // The longest value is alone in its bin: its rank is exact, to an f32.
        let top = ranks.share(1, sorted[19_999]);
        let expected = 1.0 - (1.0 - place_in_step(1)) / 20_000.0;
        assert!((top - expected).abs() < 2.0 * f32::EPSILON, "{top}");
        assert_eq!(ranks.share(0, 1.0), place_in_step(0));
        let median = ranks.quantiles(&[0.5])[0];
        assert!((median - 1.0).abs() < 0.02, "{median}");
    }

    #[test]
    fn the_longest_of_all_classes_together_are_spread_like_ranks() {
        const CLASSES: usize = 64;
        let mut places: Vec<f32> = (0..CLASSES).map(place_in_step).collect();
        places.sort_by(f32::total_cmp);
        assert!(places[0] > 0.0 && places[CLASSES - 1] < 1.0);
        for (k, place) in (0..).zip(&places) {
            // An additive sequence of the golden ratio leaves no gap above 2/n, so that the k-th of n places is off by
            // a few steps at most: it has discrepancy below (1 + ln n)/n.
            assert!(
                (place * CLASSES as f32 - k as f32 - 0.5).abs() < 1.0 + (CLASSES as f32).ln(),
                "{k}: {place}"
            );
        }
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] < 2.0 / CLASSES as f32));
    }

    #[test]
    fn no_rank_of_a_large_class_is_one() {
        // A class of the largest patches; its last rank lies nearer to 1 than an f32 can say.
        let mut ranks = LengthRanks::new(3);
        (0..1 << 23).for_each(|_| ranks.count(2, 1.0));
        ranks.count(2, 4.0);
        ranks.finish();
        let top = ranks.share(2, 4.0);
        assert!(top < 1.0 && (1.0 - top).recip().is_finite(), "{top}");
    }
}
