//! Harmonics of the azimuths of a field's facets.

use super::facets::{GROUP, each_row};
use super::feedback::{Feedback, Harmonics, LENGTH_CLASSES, TURNS};
use super::length_ranks::LengthRanks;
use super::ranking::Ranking;
use super::targets::powers;
use crate::lanes::LaneWork;
use crate::lanes::vector::{Gathered, Lanes};

/// Sums over the facets of a field.
pub(super) struct AzimuthSums {
    /// Of the cosine and sine of 2, 3, ... times the azimuth, for each length class.
    sums: [[f64; TURNS]; LENGTH_CLASSES],
    counts: [u32; LENGTH_CLASSES],
    /// The length class of each bin of slopes; a whole number.
    classes: Gathered,
}

impl AzimuthSums {
    /// No facet of a ranked field yet.
    pub fn new(ranking: &Ranking) -> Self {
        let mut counts = [0; LENGTH_CLASSES];
        let mut classes = vec![0.0; ranking.lengths.number_of_bins()];
        for bin in ranking.lengths.bins() {
            let class = Feedback::length_class(bin.middle());
            classes[bin.index] = class as f32;
            counts[class] += bin.count;
        }
        AzimuthSums { sums: Default::default(), counts, classes: Gathered::new(classes) }
    }

    /// The means.
    pub fn means(&self) -> Harmonics {
        let mean = |class: usize, k: usize| self.sums[class][k] / f64::from(self.counts[class].max(1));
        std::array::from_fn(|class| std::array::from_fn(|k| mean(class, k) as f32))
    }
}

/// Adds all facets to the sums.
pub(super) struct SumAzimuths<'a> {
    pub side: usize,
    pub heights: &'a [f32],
    pub ranking: &'a Ranking,
    pub sums: &'a mut AzimuthSums,
}

impl LaneWork for SumAzimuths<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let SumAzimuths { side, heights, ranking, sums: totals } = self;
        let inside: [f32; GROUP] = std::array::from_fn(|x| x as f32);
        each_row(heights, side, |rows| {
            let mut sums = [[[0.0f32; GROUP]; TURNS]; LENGTH_CLASSES];
            for x in (0..side.next_multiple_of(GROUP)).step_by(L::WIDTH) {
                let lane = x % GROUP;
                // Cells behind the last are the first ones once more.
                let cell = l.add(l.load(&inside[lane..]), l.splat((x - lane) as f32));
                let here = l.lt(cell, l.splat(side as f32));
                for (family, facets) in rows.facets(l, x).into_iter().enumerate() {
                    let squared = LengthRanks::told_apart(l, &facets);
                    let bin = ranking.bins(l, family, &facets, squared);
                    let class = l.trunc(l.gather(&totals.classes, bin));
                    let powers = powers(l, &facets, squared);
                    for (k, sums) in sums.iter_mut().enumerate() {
                        let other = l.nonzero(l.xor_i(class, l.splat_i(k as i32)));
                        let own = l.without(here, other);
                        for (power, sum) in powers.as_flattened().iter().zip(sums) {
                            let sum = &mut sum[lane..];
                            l.store(sum, l.add(l.load(sum), l.pick(own, *power, l.splat(0.0))));
                        }
                    }
                }
            }
            for (total, sums) in totals.sums.as_flattened_mut().iter_mut().zip(sums.as_flattened()) {
                *total += sums.iter().map(|&sum| f64::from(sum)).sum::<f64>();
            }
        });
    }
}
