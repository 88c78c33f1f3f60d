//! The remappings that turn a Gaussian field into a GGX field, by rank.
//!
//! Slopes: facets are classed by the facet's *mean* height (a corner's height would let the slopes drift to one
//! azimuth); inside each class the slope lengths get the wanted law by rank, so that slope and height become
//! independent. Directions are kept, but for a small turn that evens out their azimuths (`feedback`).
//! Heights: moved half way to z = (1 - exp(-0.3 g))/0.3 of their normal rank.

use glam::DVec2;
use statrs::distribution::{ContinuousCDF, Normal};

use super::feedback::Feedback;
use super::slope_law::SlopeLaw;

/// Classes of equal size by mean height.
const CLASSES: usize = 32;
/// Skewness parameter of the height law. The fit that follows drives the skewness up by about as much, so that the
/// finished heights are nearly symmetric.
const SKEW: f64 = -0.3;

/// One facet in a sort: 12 bytes, so that a family of a million facets sorts inside the cache's reach.
#[derive(Clone, Copy)]
struct Ranked {
    class: u8,
    key: f32,
    index: u32,
}

/// One facet family: its slopes, and its facets ordered by height class, then by slope length.
struct Family {
    slopes: Vec<DVec2>,
    order: Vec<Ranked>,
}

/// Remaps fields of one size to one law.
pub struct Remap {
    side: usize,
    law: SlopeLaw,
    /// Wanted height of each rank, lowest first, scaled to a 68 % quantile of |z| of 1.
    height_law: Vec<f64>,
}

impl Remap {
    /// Tables for `side` x `side` fields; none are needed (nor made) where no remapping happens.
    pub fn new(law: SlopeLaw, side: usize) -> Self {
        let height_law = if law == SlopeLaw::Ggx { height_law(side * side) } else { Vec::new() };
        Remap { side, law, height_law }
    }

    /// Divergence, at each grid point, of the remapped slopes averaged over the two facets of each edge.
    pub fn divergence_of_targets(&self, heights: &[f64], feedback: &Feedback) -> Vec<f64> {
        let [lower, upper] = self.families(heights).map(|mut family| {
            family.change(|slope, u| feedback.target(slope, u, self.law.length_quantile(u)));
            family.slopes
        });
        divergence(self.side, &lower, &upper)
    }

    /// Lets `feedback` learn from what the field has now.
    pub fn observe(&self, heights: &[f64], feedback: &mut Feedback) {
        for family in self.families(heights) {
            family.each(|slope, u| feedback.observe(*slope, u));
        }
        feedback.learn(self.law);
    }

    /// The lower and the upper facets.
    fn families(&self, heights: &[f64]) -> [Family; 2] {
        let n = self.side;
        let next = |i: usize| if i + 1 == n { 0 } else { i + 1 };
        let lower = self.family(|x, y| {
            let (h00, h10, h01) = (heights[y * n + x], heights[y * n + next(x)], heights[next(y) * n + x]);
            (DVec2::new(h10 - h00, h01 - h00), h00 + h10 + h01)
        });
        let upper = self.family(|x, y| {
            let (x1, y1) = (next(x), next(y));
            let (h11, h01, h10) = (heights[y1 * n + x1], heights[y1 * n + x], heights[y * n + x1]);
            (DVec2::new(h11 - h01, h11 - h10), h11 + h01 + h10)
        });
        [lower, upper]
    }

    /// The slopes and the order of one family from `facet(x, y)` = (slope, a measure of the mean height).
    fn family(&self, facet: impl Fn(usize, usize) -> (DVec2, f64)) -> Family {
        let n = self.side;
        let (slopes, means): (Vec<DVec2>, Vec<f32>) = (0..n * n)
            .map(|i| {
                let (slope, height) = facet(i % n, i / n);
                (slope, height as f32)
            })
            .unzip();
        let bounds = class_bounds(&means);
        let mut order: Vec<Ranked> = (0..n * n)
            .map(|i| Ranked {
                class: bounds.partition_point(|&b| b <= means[i]) as u8,
                key: slopes[i].length_squared() as f32,
                index: i as u32,
            })
            .collect();
        radsort::sort_by_key(&mut order, |r| (r.class, r.key));
        Family { slopes, order }
    }

    /// Moves every height half way to the wanted height of its rank.
    pub fn heights_half_way(&self, heights: &mut [f64]) {
        let mut order: Vec<Ranked> = heights
            .iter()
            .enumerate()
            .map(|(i, &h)| Ranked { class: 0, key: h as f32, index: i as u32 })
            .collect();
        radsort::sort_by_key(&mut order, |r| r.key);
        let scale = quantile_68(heights.iter().map(|h| h.abs() as f32).collect());
        for (rank, ranked) in order.iter().enumerate() {
            let height = &mut heights[ranked.index as usize];
            *height = 0.5 * (*height + scale * self.height_law[rank]);
        }
    }
}

impl Family {
    /// Visits every facet with `u`, the place of its slope length in its height class, in (0, 1).
    fn each(&self, mut visit: impl FnMut(&DVec2, f64)) {
        for class in self.order.chunk_by(|a, b| a.class == b.class) {
            let step = 1.0 / class.len() as f64;
            for (rank, ranked) in class.iter().enumerate() {
                visit(&self.slopes[ranked.index as usize], (rank as f64 + 0.5) * step);
            }
        }
    }

    /// Replaces every slope by `target(slope, u)`.
    fn change(&mut self, target: impl Fn(DVec2, f64) -> DVec2) {
        for class in self.order.chunk_by(|a, b| a.class == b.class) {
            let step = 1.0 / class.len() as f64;
            for (rank, ranked) in class.iter().enumerate() {
                let slope = &mut self.slopes[ranked.index as usize];
                *slope = target(*slope, (rank as f64 + 0.5) * step);
            }
        }
    }
}

/// The edge from (x, y) along x belongs to the lower facet of cell (x, y) and to the upper facet of (x, y-1).
fn divergence(n: usize, lower: &[DVec2], upper: &[DVec2]) -> Vec<f64> {
    let previous = |i: usize| if i == 0 { n - 1 } else { i - 1 };
    let along_x = |x: usize, y: usize| 0.5 * (lower[y * n + x].x + upper[previous(y) * n + x].x);
    let along_y = |x: usize, y: usize| 0.5 * (lower[y * n + x].y + upper[y * n + previous(x)].y);
    let at = |i: usize| {
        let (x, y) = (i % n, i / n);
        along_x(previous(x), y) - along_x(x, y) + along_y(x, previous(y)) - along_y(x, y)
    };
    (0..n * n).map(at).collect()
}

/// The CLASSES - 1 heights that part the facets into classes of equal size.
fn class_bounds(means: &[f32]) -> Vec<f32> {
    let mut sorted = means.to_vec();
    radsort::sort(&mut sorted);
    (1..CLASSES).map(|k| sorted[k * sorted.len() / CLASSES]).collect()
}

fn height_law(count: usize) -> Vec<f64> {
    let normal = Normal::standard();
    let quantile = |rank: usize| normal.inverse_cdf((rank as f64 + 0.5) / count as f64);
    let law: Vec<f64> = (0..count).map(|rank| (SKEW * quantile(rank)).exp_m1() / SKEW).collect();
    let scale = quantile_68(law.iter().map(|z| z.abs() as f32).collect());
    law.into_iter().map(|z| z / scale).collect()
}

/// The 68 % quantile of `values`.
fn quantile_68(mut values: Vec<f32>) -> f64 {
    radsort::sort(&mut values);
    f64::from(values[(values.len() - 1) * 68 / 100])
}
