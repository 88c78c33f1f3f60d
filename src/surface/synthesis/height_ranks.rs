//! Heights, ranked by counting: which share lies below a given one, in one pass and without a sort.
//!
//! A histogram of equal bins between the lowest and the highest answers to the bin exactly and between its edges linearly.

use super::facets::GROUP;
use crate::lanes::vector::{Gathered, Lanes};
use crate::lanes::{Kernel, LaneWork};

/// Bins of the heights.
pub(super) const HEIGHT_BINS: usize = 4096;

/// Heights and how many of them lie below each.
pub(super) struct HeightRanks {
    pub lowest: f32,
    pub bins_per_height: f32,
    /// Heights below each bin's lower edge; one entry more than bins.
    below: Vec<u32>,
}

impl HeightRanks {
    /// Counts `heights`, of which there must be some, all finite.
    pub fn of(heights: &[f32], kernel: Kernel) -> Self {
        let mut ranks = HeightRanks { lowest: 0.0, bins_per_height: 0.0, below: vec![0; HEIGHT_BINS + 1] };
        kernel.run(CountHeights { heights, ranks: &mut ranks });
        accumulate(&mut ranks.below);
        ranks
    }

    /// The bins of heights, and the places in bins.
    #[inline(always)]
    pub fn place<L: Lanes>(&self, l: L, heights: L::F) -> L::F {
        l.mul(l.sub(heights, l.splat(self.lowest)), l.splat(self.bins_per_height))
    }

    /// The bins of places; those of rounding below the lowest or at the highest height are the outermost.
    #[inline(always)]
    pub fn bin<L: Lanes>(&self, l: L, place: L::F) -> L::I {
        l.min_i(l.trunc(place), l.splat_i(HEIGHT_BINS as i32 - 1))
    }

    /// Share of the heights below place `place`, in bins above the lowest; [0, 1].
    fn share(&self, place: f32) -> f32 {
        let place = place.clamp(0.0, HEIGHT_BINS as f32);
        let bin = (place as usize).min(HEIGHT_BINS - 1);
        let (first, end) = (self.below[bin] as f32, self.below[bin + 1] as f32);
        (first + (place - bin as f32) * (end - first)) / self.below[HEIGHT_BINS] as f32
    }

    /// What `f` says of the share below the middle of each bin.
    pub fn by_bin(&self, f: impl Fn(f32) -> f32) -> Gathered {
        Gathered::new((0..HEIGHT_BINS).map(|bin| f(self.share(bin as f32 + 0.5))).collect())
    }

    /// A function of the share of heights below, at each bin's lower edge and what it grows by in the bin; the shares keep
    /// half a height's distance from 0 and 1.
    pub fn table(&self, f: impl Fn(f64) -> f64) -> Gathered {
        let all = f64::from(self.below[HEIGHT_BINS]);
        let share = |&below: &u32| f64::from(below).clamp(0.5, all - 0.5) / all;
        let edges: Vec<f32> = self.below.iter().map(|below| f(share(below)) as f32).collect();
        Gathered::new(edges.windows(2).flat_map(|edges| [edges[0], edges[1] - edges[0]]).collect())
    }

    /// What `table` says at heights, linear between the edges.
    #[inline(always)]
    pub fn look_up<L: Lanes>(&self, l: L, table: &Gathered, heights: L::F) -> L::F {
        let place = self.place(l, heights);
        let bin = self.bin(l, place);
        let at = l.add_i(bin, bin);
        let growth = l.gather(table, l.add_i(at, l.splat_i(1)));
        l.add(l.gather(table, at), l.mul(l.sub(place, l.to_f(bin)), growth))
    }

    /// The distance from 0 within which `share` of the heights lie, to a bin's width.
    pub fn quantile_of_distance(&self, share: f32) -> f32 {
        let width = 1.0 / self.bins_per_height;
        let zero = -self.lowest * self.bins_per_height;
        let furthest = zero.abs().max((HEIGHT_BINS as f32 - zero).abs());
        let within = |bins: f32| self.share(zero + bins) - self.share(zero - bins);
        let (mut low, mut high) = (0, furthest as usize + 1);
        while low + 1 < high {
            let middle = (low + high) / 2;
            if within(middle as f32) < share { low = middle } else { high = middle }
        }
        high as f32 * width
    }
}

struct CountHeights<'a> {
    heights: &'a [f32],
    ranks: &'a mut HeightRanks,
}

impl LaneWork for CountHeights<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let CountHeights { heights, ranks } = self;
        let (vectors, rest) = heights.split_at(heights.len() / L::WIDTH * L::WIDTH);
        let start = l.splat(heights[0]);
        let (mut low, mut high) = (start, start);
        for part in vectors.chunks_exact(L::WIDTH) {
            let part = l.load(part);
            (low, high) = (l.min(part, low), l.max(part, high));
        }
        let (mut lows, mut highs) = ([heights[0]; GROUP], [heights[0]; GROUP]);
        l.store(&mut lows, low);
        l.store(&mut highs, high);
        ranks.lowest = rest.iter().chain(&lows).copied().fold(f32::INFINITY, f32::min);
        let highest = rest.iter().chain(&highs).copied().fold(f32::NEG_INFINITY, f32::max);
        ranks.bins_per_height = HEIGHT_BINS as f32 / (highest - ranks.lowest).max(f32::MIN_POSITIVE);
        let mut bins = [0i32; GROUP];
        for group in heights.chunks(GROUP) {
            // The last group may be a short one.
            let mut whole = [ranks.lowest; GROUP];
            whole[..group.len()].copy_from_slice(group);
            for x in (0..GROUP).step_by(L::WIDTH) {
                let bin = ranks.bin(l, ranks.place(l, l.load(&whole[x..])));
                l.store_i(&mut bins[x..], bin);
            }
            for &bin in &bins[..group.len()] {
                ranks.below[bin as usize + 1] += 1;
            }
        }
    }
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
    use crate::lanes::scalar::One;

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
        let ranks = HeightRanks::of(&heights, Kernel::Scalar);
        for (rank, &height) in sorted.iter().enumerate().step_by(97) {
            let exact = (rank as f32 + 0.5) / 20_000.0;
            let share = ranks.share(ranks.place(One, height));
            // A bin is 1/4096 of a range of 20 and the law's density at most 1/4: 0.0012 of all lie in one bin.
            assert!((share - exact).abs() < 1.3e-3, "{height}: {share} {exact}");
        }
        // Half of the heights lie within ln 3 of the middle; a bin is 0.005 wide.
        assert!((ranks.quantile_of_distance(0.5) - 3f32.ln()).abs() < 0.011);
    }

    #[test]
    fn a_table_is_read_at_the_height_of_its_rank() {
        let heights = values(20_000);
        let ranks = HeightRanks::of(&heights, Kernel::Scalar);
        let table = ranks.table(|u| (u / (1.0 - u)).ln());
        for &height in heights.iter().filter(|h| h.abs() < 3.0).step_by(31) {
            // The law is its own quantile function: the height comes back, to the 0.005 of a bin and its neighbours.
            assert!((ranks.look_up(One, &table, height) - height).abs() < 0.02, "{height}");
        }
    }
}
