//! The remappings that turn a Gaussian field into one of another slope law, by rank.
//!
//! Slopes: facets are classed by the facet's *mean* height (a corner's height would let the slopes drift to one
//! azimuth); inside each class the slope lengths get the wanted law by rank, so that slope and height become
//! independent. Directions are kept, but for a small turn that evens out their azimuths (`feedback`).
//! Heights: moved half way to z = (1 - exp(-0.3 g))/0.3 of their normal rank.

use statrs::distribution::{ContinuousCDF, Normal};

use super::facets::GROUP;
use super::feedback::{self, Feedback, Observed};
use super::harmonics::{AzimuthSums, SumAzimuths};
use super::height_ranks::HeightRanks;
use super::ranking::Ranking;
use super::slope_law::SlopeLaw;
use super::targets::{Targets, WriteDivergence};
use crate::lanes::vector::{Gathered, Lanes};
use crate::lanes::{Kernel, LaneWork};

/// Skewness parameter of the height law. The fit that follows drives the skewness up by about as much, so that the
/// finished heights are nearly symmetric.
const SKEW: f64 = -0.3;
/// The share of heights whose distance from 0 sets the scale: one standard deviation of a normal law.
const SCALE_SHARE: f64 = 0.68;

/// Remaps fields of one size to one law.
pub(super) struct Remap {
    side: usize,
    law: SlopeLaw,
    kernel: Kernel,
    normal: Normal,
    /// Distance from 0 within which `SCALE_SHARE` of the height law lies.
    law_scale: f64,
}

impl Remap {
    /// For `side` x `side` fields.
    pub fn new(law: SlopeLaw, side: usize, kernel: Kernel) -> Self {
        let normal = Normal::standard();
        Remap { side, law, kernel, normal, law_scale: law_scale(&normal) }
    }

    /// Makes of heights, in place, the divergence at each grid point of the remapped slopes averaged over the two facets of
    /// each edge.
    pub fn divergence_of_targets(&self, heights: &mut [f32], ranking: &Ranking, feedback: &Feedback) {
        let targets = Targets::new(self.law, ranking, feedback);
        self.kernel.run(WriteDivergence { side: self.side, heights, ranking, targets: &targets });
    }

    /// Lets `feedback` learn from what the field has now.
    pub fn observe(&self, heights: &[f32], ranking: &Ranking, feedback: &mut Feedback) {
        let mut sums = AzimuthSums::new(ranking);
        self.kernel.run(SumAzimuths { side: self.side, heights, ranking, sums: &mut sums });
        let squared_lengths = ranking.lengths.quantiles(&feedback::knot_shares());
        feedback.learn(self.law, &Observed { squared_lengths, azimuths: sums.means() });
    }

    /// Ranks the facets of a field.
    pub fn ranking(&self, heights: &[f32]) -> Ranking {
        Ranking::of(heights, self.side, self.kernel)
    }

    /// Moves every height half way to the wanted height of its rank.
    pub fn heights_half_way(&self, heights: &mut [f32]) {
        let ranks = HeightRanks::of(heights, self.kernel);
        let scale = f64::from(ranks.quantile_of_distance(SCALE_SHARE as f32)) / self.law_scale;
        let wanted = ranks.table(|u| scale * wanted_height(&self.normal, u));
        self.kernel.run(HalfWay { heights, ranks: &ranks, wanted: &wanted });
    }
}

struct HalfWay<'a> {
    heights: &'a mut [f32],
    ranks: &'a HeightRanks,
    wanted: &'a Gathered,
}

impl LaneWork for HalfWay<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        for group in self.heights.chunks_mut(GROUP) {
            let mut whole = [self.ranks.lowest; GROUP];
            whole[..group.len()].copy_from_slice(group);
            for x in (0..GROUP).step_by(L::WIDTH) {
                let height = l.load(&whole[x..]);
                let wanted = self.ranks.look_up(l, self.wanted, height);
                l.store(&mut whole[x..], l.mul(l.splat(0.5), l.add(height, wanted)));
            }
            group.copy_from_slice(&whole[..group.len()]);
        }
    }
}

/// The height law at rank `u`, not scaled.
fn wanted_height(normal: &Normal, u: f64) -> f64 {
    (SKEW * normal.inverse_cdf(u)).exp_m1() / SKEW
}

/// The height law's own distance within which `SCALE_SHARE` of it lies: at the middle of many equal steps.
fn law_scale(normal: &Normal) -> f64 {
    let steps = 10_000;
    let mut distances: Vec<f64> =
        (0..steps).map(|i| wanted_height(normal, (f64::from(i) + 0.5) / f64::from(steps)).abs()).collect();
    distances.sort_by(f64::total_cmp);
    distances[(SCALE_SHARE * f64::from(steps)) as usize]
}
