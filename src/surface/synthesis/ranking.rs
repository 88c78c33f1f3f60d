//! The facets of a field, ranked: by slope length within classes of mean height.

use super::facets::{Facets, GROUP, each_row};
use super::height_ranks::HeightRanks;
use super::length_ranks::{LENGTH_BINS, LengthRanks};
use crate::lanes::vector::{Gathered, Lanes};
use crate::lanes::{Kernel, LaneWork};

/// Classes of equal size by mean height, for each of the two facet families.
const CLASSES: usize = 32;
/// The ranks of one field's facets.
pub(super) struct Ranking {
    heights: HeightRanks,
    /// For each bin of heights, the first bin of its class's slope lengths, of lower facets; a whole number.
    first_bins: Gathered,
    pub lengths: LengthRanks,
}

impl Ranking {
    /// Ranks the facets of a `side` x `side` field.
    pub fn of(heights: &[f32], side: usize, kernel: Kernel) -> Self {
        let ranks = HeightRanks::of(heights, kernel);
        let first_bin =
            |share: f32| (((share * CLASSES as f32) as usize).min(CLASSES - 1) * LENGTH_BINS) as f32;
        let first_bins = ranks.by_bin(first_bin);
        let mut ranking = Ranking { heights: ranks, first_bins, lengths: LengthRanks::new(2 * CLASSES) };
        kernel.run(CountLengths { side, heights, ranking: &mut ranking });
        ranking
    }

    /// The bins of facets of a family (0 lower, 1 upper) among those of all classes; `squared` are their lengths, told apart.
    ///
    /// The class goes by the share of *grid points* below the facet's mean height, which parts facets nearly evenly.
    #[inline(always)]
    pub fn bins<L: Lanes>(&self, l: L, family: usize, facets: &Facets<L>, squared: L::F) -> L::I {
        let place = self.heights.place(l, facets.mean);
        let class = l.trunc(l.gather(&self.first_bins, self.heights.bin(l, place)));
        let first = l.add_i(class, l.splat_i((family * CLASSES * LENGTH_BINS) as i32));
        l.add_i(first, LengthRanks::bin(l, squared))
    }
}

struct CountLengths<'a> {
    side: usize,
    heights: &'a [f32],
    ranking: &'a mut Ranking,
}

impl LaneWork for CountLengths<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let CountLengths { side, heights, ranking } = self;
        let mut bins = [[0i32; GROUP]; 2];
        each_row(heights, side, |rows| {
            for first in (0..side).step_by(GROUP) {
                for x in (0..GROUP).step_by(L::WIDTH) {
                    for (family, facets) in rows.facets(l, first + x).into_iter().enumerate() {
                        let squared = LengthRanks::told_apart(l, &facets);
                        l.store_i(&mut bins[family][x..], ranking.bins(l, family, &facets, squared));
                    }
                }
                let cells = GROUP.min(side - first);
                for bin in bins.iter().flat_map(|bins| &bins[..cells]) {
                    ranking.lengths.count(*bin as usize);
                }
            }
        });
    }
}
