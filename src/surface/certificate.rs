//! The properties of a patch, computed from its facets before any ray: the slope law, the azimuths, and whether
//! slope and height are independent.
//!
//! All statistics are over both facet families. No variance of slopes is used: GGX has none.

use std::f64::consts::TAU;

use glam::DVec2;
use serde::Serialize;

use super::heightfield::Heightfield;
use super::synthesis::slope_law::SlopeLaw;

/// Bins of the azimuth histogram.
pub const AZIMUTH_BINS: usize = 36;
/// Bins of the pooled slope law.
const SLOPE_BINS: usize = 10_000;

/// The certificate of one patch: in canonical slopes, or of a map in slopes that are ratios of lengths.
#[derive(Debug, Clone, Serialize)]
pub struct Certificate {
    /// Kolmogorov-Smirnov distance of the slope lengths from the wanted law; `null` where no law is wanted.
    pub ks: Option<f64>,
    /// Facets per azimuth bin over their mean: 1 is even.
    pub azimuth_histogram: Vec<f64>,
    /// Means of cos and sin of 1x and 2x the slope azimuth: 0 is even.
    pub azimuth_harmonics: [[f64; 2]; 2],
    /// Rank correlation of slope length and facet height.
    pub rank_correlation_height: f64,
    /// Rank correlation of slope length and squared facet height (about the mean).
    pub rank_correlation_height_squared: f64,
    /// Skewness of the heights.
    pub height_skewness: f64,
    /// Kurtosis of the heights (3: normal).
    pub height_kurtosis: f64,
    /// Lowest to highest height, canonical cells; of a map in its own unit.
    pub height_range: f64,
    /// Mean slope along x and y: 0 on a periodic patch.
    pub mean_slope: [f64; 2],
    /// Median slope length: 1 for GGX, sqrt(ln 2) for Beckmann.
    pub median_slope: f64,
}

impl Certificate {
    /// Examines a patch; `law` is what its slopes should follow, if anything.
    pub fn of(field: &Heightfield, law: Option<SlopeLaw>) -> Self {
        Self::scaled(field, law, DVec2::ONE)
    }

    /// Examines a measured map, whose slopes are ratios of lengths; `alpha`: slope of one unit of height a cell.
    pub fn of_map(field: &Heightfield, alpha: DVec2) -> Self {
        Self::scaled(field, None, alpha)
    }

    fn scaled(field: &Heightfield, law: Option<SlopeLaw>, alpha: DVec2) -> Self {
        // Made anew for each question: a patch of many cells has room for few numbers a facet.
        let slopes = || facets(field).map(|(slope, _)| slope * alpha);
        let heights = || facets(field).map(|(_, height)| height);
        let by_length = in_order(slopes().map(|slope| slope.length()));
        let ks = law.map(|law| ks_distance(&by_length, |length| law.length_cdf(length)));
        let median_slope = f64::from(by_length[by_length.len() / 2].0);
        let length_ranks = ranks(&by_length);
        drop(by_length);
        let mean_height = mean(heights());
        // Their squares have the same ranks.
        let distances = heights().map(|height| (height - mean_height).abs());
        let centre = mean(field.heights().iter().copied());
        let moment = |k: i32| mean(field.heights().iter().map(|h| (h - centre).powi(k)));
        let variance = moment(2);
        let (low, high) = field.range();
        Certificate {
            ks,
            azimuth_histogram: azimuth_histogram(slopes()),
            azimuth_harmonics: azimuth_harmonics(slopes()),
            rank_correlation_height: correlation(&length_ranks, &ranks(&in_order(heights()))),
            rank_correlation_height_squared: correlation(&length_ranks, &ranks(&in_order(distances))),
            height_skewness: ratio(moment(3), variance.powf(1.5)),
            height_kurtosis: ratio(moment(4), variance * variance),
            height_range: high - low,
            mean_slope: mean_slope(slopes()),
            median_slope,
        }
    }

    /// Smallest and largest entry of the azimuth histogram.
    pub fn azimuth_extremes(&self) -> (f64, f64) {
        self.azimuth_histogram.iter().fold((f64::INFINITY, 0.0f64), |(lo, hi), &v| (lo.min(v), hi.max(v)))
    }
}

/// Facets by the share of the wanted law below their slope length, of one patch or of many: even where the law is
/// met.
#[derive(Debug, Clone)]
pub struct SlopeCounts {
    law: SlopeLaw,
    counts: Vec<u64>,
}

impl SlopeCounts {
    /// No facets yet.
    pub fn new(law: SlopeLaw) -> Self {
        SlopeCounts { law, counts: vec![0; SLOPE_BINS] }
    }

    /// Counts the facets of a patch.
    pub fn add(&mut self, field: &Heightfield) {
        for slope in field.all_corners().flat_map(|corners| corners.slopes()) {
            let below = self.law.length_cdf(slope.length());
            self.counts[((below * SLOPE_BINS as f64) as usize).min(SLOPE_BINS - 1)] += 1;
        }
    }

    /// Counts the facets of another count, which must be of the same law.
    pub fn merge(&mut self, other: &Self) {
        debug_assert_eq!(self.law, other.law);
        for (mine, theirs) in self.counts.iter_mut().zip(&other.counts) {
            *mine += theirs;
        }
    }

    /// Kolmogorov-Smirnov distance of all facets together from the law, `None` without facets.
    ///
    /// Looked at between bins only: too small by at most 1/10,000.
    // Tested by `pooled_counts_give_the_distance_of_all_facets`.
    pub fn ks(&self) -> Option<f64> {
        let all: u64 = self.counts.iter().sum();
        let (mut below, mut largest) = (0, 0.0f64);
        for (bin, count) in self.counts.iter().enumerate() {
            below += count;
            let wanted = (bin + 1) as f64 / SLOPE_BINS as f64;
            largest = largest.max((below as f64 / all as f64 - wanted).abs());
        }
        (all > 0).then_some(largest)
    }
}

/// Slopes and mean heights of all facets.
fn facets(field: &Heightfield) -> impl Iterator<Item = (DVec2, f64)> {
    field.all_corners().flat_map(|c| {
        [(c.lower_slope(), (c.h00 + c.h10 + c.h01) / 3.0), (c.upper_slope(), (c.h11 + c.h10 + c.h01) / 3.0)]
    })
}

/// Their mean; there is one at least.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0u32), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count)
}

fn mean_slope(slopes: impl Iterator<Item = DVec2>) -> [f64; 2] {
    let (sum, count) = slopes.fold((DVec2::ZERO, 0u32), |(sum, count), slope| (sum + slope, count + 1));
    (sum / f64::from(count)).to_array()
}

/// `a / b`, 0 where a flat patch makes both 0.
fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

/// Values in f32, each with its place, the smallest first: a part in 1e7 of a value is no matter of its law or rank.
fn in_order(values: impl Iterator<Item = f64>) -> Vec<(f32, u32)> {
    let mut order: Vec<(f32, u32)> = (0..).zip(values).map(|(place, value)| (value as f32, place)).collect();
    radsort::sort_by_key(&mut order, |&(value, _)| value);
    order
}

/// Largest distance between the empirical law of values `in_order` and `cdf`.
fn ks_distance(order: &[(f32, u32)], cdf: impl Fn(f64) -> f64) -> f64 {
    let n = order.len() as f64;
    let distance = |(i, &(x, _)): (usize, &(f32, u32))| {
        let wanted = cdf(f64::from(x));
        (wanted - i as f64 / n).abs().max((wanted - (i as f64 + 1.0) / n).abs())
    };
    order.iter().enumerate().map(distance).fold(0.0, f64::max)
}

/// Twice the rank of each value, 0 for the smallest; equal values share the mean of their ranks.
fn ranks(order: &[(f32, u32)]) -> Vec<u32> {
    let mut ranks = vec![0; order.len()];
    let mut first = 0;
    for equal in order.chunk_by(|a, b| a.0 == b.0) {
        let twice = 2 * first + equal.len() as u32 - 1;
        for (_, index) in equal {
            ranks[*index as usize] = twice;
        }
        first += equal.len() as u32;
    }
    ranks
}

/// Spearman's correlation, from ranks or equal multiples of them.
fn correlation(a: &[u32], b: &[u32]) -> f64 {
    // The same numbers in another order.
    let middle = mean(a.iter().map(|&rank| f64::from(rank)));
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (&x, &y) in a.iter().zip(b) {
        let (dx, dy) = (f64::from(x) - middle, f64::from(y) - middle);
        aa += dx * dx;
        bb += dy * dy;
        ab += dx * dy;
    }
    ratio(ab, (aa * bb).sqrt())
}

fn azimuth_histogram(slopes: impl Iterator<Item = DVec2>) -> Vec<f64> {
    const QUARTER: usize = AZIMUTH_BINS / 4;
    let edges: [f64; QUARTER - 1] =
        std::array::from_fn(|k| (TAU * (k + 1) as f64 / AZIMUTH_BINS as f64).tan());
    let mut counts = [0u64; AZIMUTH_BINS];
    for slope in slopes {
        // Turned into the first quarter, where the edges are told by their slopes.
        let (quarter, along, across) = match slope {
            DVec2 { x, y } if x <= 0.0 && y > 0.0 => (1, y, -x),
            DVec2 { x, y } if x < 0.0 => (2, -x, -y),
            DVec2 { x, y } if y < 0.0 => (3, -y, x),
            DVec2 { x, y } => (0, x, y),
        };
        let passed: usize = edges.iter().map(|edge| usize::from(across > edge * along)).sum();
        counts[quarter * QUARTER + passed] += 1;
    }
    let all: u64 = counts.iter().sum();
    let mean = all as f64 / AZIMUTH_BINS as f64;
    counts.iter().map(|&count| count as f64 / mean).collect()
}

/// Means of (cos k psi, sin k psi), k = 1, 2, without any trigonometry: powers of the unit slope as a complex number.
fn azimuth_harmonics(slopes: impl Iterator<Item = DVec2>) -> [[f64; 2]; 2] {
    let (mut first, mut second, mut count) = (DVec2::ZERO, DVec2::ZERO, 0u32);
    for slope in slopes {
        let unit = slope.normalize_or_zero();
        first += unit;
        second += DVec2::new(unit.x * unit.x - unit.y * unit.y, 2.0 * unit.x * unit.y);
        count += 1;
    }
    let n = f64::from(count);
    [(first / n).to_array(), (second / n).to_array()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heights without any order: sines of growing arguments.
    fn field(phase: f64) -> Heightfield {
        Heightfield::new(32, 32, true, (0..1024).map(|i| (phase + f64::from(i * i)).sin()).collect())
    }

    #[test]
    fn a_slope_is_counted_where_its_azimuth_is() {
        let counted = |slope: DVec2| {
            let shares = azimuth_histogram(std::iter::once(slope));
            shares.iter().position(|&share| share > 0.0).expect("counted")
        };
        for bin in 0..AZIMUTH_BINS {
            for within in [0.01, 0.5, 0.99] {
                let azimuth = TAU * (bin as f64 + within) / AZIMUTH_BINS as f64;
                assert_eq!(counted(3.0 * DVec2::from_angle(azimuth)), bin);
            }
        }
        // On the axes the next bin begins; what has no azimuth is in the first one.
        let axes = [(1.0, 0.0), (0.0, 2.0), (-1.0, 0.0), (-1.0, -0.0), (0.0, -2.0), (-0.0, -2.0), (0.0, 0.0)];
        let found = axes.map(|(x, y)| counted(DVec2::new(x, y)));
        assert_eq!(found, [0, 9, 18, 18, 27, 27, 0]);
    }

    #[test]
    fn pooled_counts_give_the_distance_of_all_facets() {
        for law in [SlopeLaw::Ggx, SlopeLaw::Beckmann] {
            let one = |phase: f64| {
                let mut counts = SlopeCounts::new(law);
                counts.add(&field(phase));
                counts
            };
            let mut both = one(0.3);
            both.merge(&one(7.0));
            let fields = [field(0.3), field(7.0)];
            let lengths = fields.iter().flat_map(facets).map(|(slope, _)| slope.length());
            let exact = ks_distance(&in_order(lengths), |length| law.length_cdf(length));
            let pooled = both.ks().expect("there are facets");
            // Lengths are rounded to 6e-8 of themselves, where at most 0.6 of the law lies in a unit of their logarithm.
            assert!(pooled <= exact + 1e-7 && pooled >= exact - 1e-4, "{law:?}: {pooled}, exactly {exact}");
        }
        assert_eq!(SlopeCounts::new(SlopeLaw::Ggx).ks(), None);
    }
}
