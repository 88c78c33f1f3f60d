//! The remappings that turn a Gaussian field into a GGX field, by rank.
//!
//! Slopes: facets are classed by the facet's *mean* height (a corner's height would let the slopes drift to one
//! azimuth); inside each class the slope lengths get the wanted law by rank, so that slope and height become
//! independent. Directions are kept, but for a small turn that evens out their azimuths (`feedback`).
//! Heights: moved half way to z = (1 - exp(-0.3 g))/0.3 of their normal rank.

use glam::Vec2;
use statrs::distribution::{ContinuousCDF, Normal};

use super::feedback::{Feedback, Observed};
use super::ranks::{HeightRanks, LengthRanks};
use super::slope_law::SlopeLaw;

/// Classes of equal size by mean height, for each of the two facet families.
const CLASSES: usize = 32;
/// Skewness parameter of the height law. The fit that follows drives the skewness up by about as much, so that the
/// finished heights are nearly symmetric.
const SKEW: f64 = -0.3;
/// The share of heights whose distance from 0 sets the scale: one standard deviation of a normal law.
const SCALE_SHARE: f64 = 0.68;

/// Remaps fields of one size to one law.
pub struct Remap {
    side: usize,
    law: SlopeLaw,
    normal: Normal,
    /// Distance from 0 within which `SCALE_SHARE` of the height law lies.
    law_scale: f64,
}

/// The remapped slopes of the lower and of the upper facets, cell by cell: room that every round uses again.
pub struct Targets {
    slopes: [Vec<Vec2>; 2],
}

/// One facet: its family (0 lower, 1 upper), its slope and its mean height.
struct FacetSlope {
    family: usize,
    slope: Vec2,
    mean: f32,
}

/// The ranks of one field's facets.
struct Ranking {
    heights: HeightRanks,
    lengths: LengthRanks,
}

impl Remap {
    /// For `side` x `side` fields.
    pub fn new(law: SlopeLaw, side: usize) -> Self {
        let normal = Normal::standard();
        Remap { side, law, normal, law_scale: law_scale(&normal) }
    }

    /// Room for `divergence_of_targets`.
    pub fn targets(&self) -> Targets {
        let slopes = vec![Vec2::ZERO; self.side * self.side];
        Targets { slopes: [slopes.clone(), slopes] }
    }

    /// Divergence, at each grid point, of the remapped slopes averaged over the two facets of each edge.
    pub fn divergence_of_targets(
        &self,
        heights: &[f32],
        feedback: &Feedback,
        room: &mut Targets,
    ) -> Vec<f32> {
        let ranking = self.ranking(heights);
        let [lower, upper] = &mut room.slopes;
        self.each_cell(heights, |cell, facets| {
            let [low, up] = facets.map(|facet| feedback.target(self.law, facet.slope, ranking.share(&facet)));
            (lower[cell], upper[cell]) = (low, up);
        });
        divergence(self.side, lower, upper)
    }

    /// Lets `feedback` learn from what the field has now.
    pub fn observe(&self, heights: &[f32], feedback: &mut Feedback) {
        let ranking = self.ranking(heights);
        let mut observed = Observed::new(|shares| ranking.lengths.quantiles(shares));
        self.each_cell(heights, |_, facets| {
            for facet in facets {
                observed.add(facet.slope, ranking.share(&facet));
            }
        });
        feedback.learn(self.law, &observed);
    }

    /// Moves every height half way to the wanted height of its rank.
    pub fn heights_half_way(&self, heights: &mut [f32]) {
        let ranks = HeightRanks::of(heights);
        let scale = f64::from(ranks.quantile_of_distance(SCALE_SHARE as f32)) / self.law_scale;
        let wanted = ranks.table(|u| scale * wanted_height(&self.normal, u));
        for height in heights {
            *height = 0.5 * (*height + ranks.look_up(&wanted, *height));
        }
    }

    fn ranking(&self, heights: &[f32]) -> Ranking {
        let mut ranking =
            Ranking { heights: HeightRanks::of(heights), lengths: LengthRanks::new(2 * CLASSES) };
        self.each_cell(heights, |_, facets| {
            for facet in facets {
                ranking.lengths.count(ranking.class(&facet), facet.slope.length_squared());
            }
        });
        ranking.lengths.finish();
        ranking
    }

    /// Visits all cells, row by row, with their lower and upper facets.
    #[inline(always)]
    fn each_cell(&self, heights: &[f32], mut visit: impl FnMut(usize, [FacetSlope; 2])) {
        let n = self.side;
        let third = 1.0 / 3.0;
        for y in 0..n {
            let near = &heights[y * n..][..n];
            let far = &heights[self.next(y) * n..][..n];
            for x in 0..n {
                let x1 = self.next(x);
                let (h00, h10, h01, h11) = (near[x], near[x1], far[x], far[x1]);
                let lower = Vec2::new(h10 - h00, h01 - h00);
                let upper = Vec2::new(h11 - h01, h11 - h10);
                let lower = FacetSlope { family: 0, slope: lower, mean: third * (h00 + h10 + h01) };
                let upper = FacetSlope { family: 1, slope: upper, mean: third * (h11 + h10 + h01) };
                visit(y * n + x, [lower, upper]);
            }
        }
    }

    fn next(&self, i: usize) -> usize {
        if i + 1 == self.side { 0 } else { i + 1 }
    }
}

impl Ranking {
    /// The facet's class: by the share of *grid points* below its mean height, which parts facets nearly evenly.
    #[inline(always)]
    fn class(&self, facet: &FacetSlope) -> usize {
        let class = (self.heights.share(facet.mean) * CLASSES as f32) as usize;
        facet.family * CLASSES + class.min(CLASSES - 1)
    }

    /// The share of the facet's class with shorter slopes, in (0, 1).
    #[inline(always)]
    fn share(&self, facet: &FacetSlope) -> f32 {
        self.lengths.share(self.class(facet), facet.slope.length_squared())
    }
}

/// The edge from (x, y) along x belongs to the lower facet of cell (x, y) and to the upper facet of (x, y-1).
fn divergence(n: usize, lower: &[Vec2], upper: &[Vec2]) -> Vec<f32> {
    let previous = |i: usize| if i == 0 { n - 1 } else { i - 1 };
    let row = |y: usize| {
        let (low, up) = (&lower[y * n..][..n], &upper[y * n..][..n]);
        let (low_before, up_before) = (&lower[previous(y) * n..][..n], &upper[previous(y) * n..][..n]);
        (0..n).map(move |x| {
            let before = previous(x);
            let along_x = low[before].x + up_before[before].x - low[x].x - up_before[x].x;
            let along_y = low_before[x].y + up_before[before].y - low[x].y - up[before].y;
            0.5 * (along_x + along_y)
        })
    };
    (0..n).flat_map(row).collect()
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
