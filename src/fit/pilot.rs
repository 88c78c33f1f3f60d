//! A first guess from the table itself: the half vectors' slopes, weighted with the facets that the light shows there.
//!
//! At the steepest incidences each bin holds facets in proportion to f cos_i w/(wo.h). Their shape is Tyler's M-estimator
//! (Tyler 1987), which is the same for every elliptical law, and their scale the weighted median of its radius.

use super::data::FitData;
use crate::campaign::LightSide;
use crate::theory::transmission::half_vector;

const ROUNDS: usize = 30;
/// The index that is taken where nothing says it, and what is believed of mean directions.
const FIRST_INDEX: f64 = 1.5;
const INDICES: [f64; 2] = [1.1, 4.0];
/// Largest anisotropy, ln(alpha_x/alpha_y)/2, that is believed.
const MOST_STRETCH: f64 = 1.5;

/// Scale and stretch: the logarithm of the matrix of roughness is [[scale + b, c], [c, scale - b]].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pilot {
    /// ln of the median slope in units in which the shape has determinant 1.
    pub log_alpha: f64,
    /// b and c.
    pub stretch: [f64; 2],
    /// Index of the inside over the outside, > 1; 1.5 where no light has gone through.
    pub index: f64,
}

impl Pilot {
    /// The index beyond over that here, for light from the table's side.
    pub fn eta(&self, data: &FitData) -> f64 {
        if data.clear == [LightSide::Back] { 1.0 / self.index } else { self.index }
    }
}

/// The first guess.
// Tested by the fits of tests/it/fit.rs, which start there.
pub fn pilot(data: &FitData) -> Pilot {
    let index = index(data);
    let slopes = slopes(data, if data.clear == [LightSide::Back] { 1.0 / index } else { index });
    let mut shape = [1.0, 0.0, 1.0];
    for _ in 0..ROUNDS {
        let [xx, xy, yy] = shape;
        let determinant = xx * yy - xy * xy;
        let mut sum = [0.0; 3];
        for &([p, q], weight) in &slopes {
            let radius2 = (yy * p * p - 2.0 * xy * p * q + xx * q * q) / determinant;
            sum[0] += weight * p * p / radius2;
            sum[1] += weight * p * q / radius2;
            sum[2] += weight * q * q / radius2;
        }
        let scale = (sum[0] * sum[2] - sum[1] * sum[1]).sqrt();
        // Slopes along one line (an arm in the plane of incidence) say nothing about the shape.
        if scale.is_nan() || scale <= 1e-3 * (sum[0] + sum[2]) {
            shape = [1.0, 0.0, 1.0];
            break;
        }
        shape = sum.map(|entry| entry / scale);
    }
    let [xx, xy, yy] = shape;
    let mut radii: Vec<(f64, f64)> =
        slopes.iter().map(|&([p, q], w)| ((yy * p * p - 2.0 * xy * p * q + xx * q * q).sqrt(), w)).collect();
    radii.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The square root of the shape has half the logarithm: eigenvalues exp(+-2 r), r = acosh(trace/2)/2.
    let r = 0.5 * (0.5 * (xx + yy)).max(1.0).acosh();
    let (along, across) = (0.5 * (xx - yy), xy);
    let size = along.hypot(across);
    let part = |component: f64| if size > 0.0 { r.min(MOST_STRETCH) * component / size } else { 0.0 };
    Pilot { log_alpha: median(&radii).ln(), stretch: [part(along), part(across)], index }
}

/// Snell's law of the mean directions: the sum of sin(theta_i) over that of what light that has gone through keeps of it.
fn index(data: &FitData) -> f64 {
    let (grid, bins) = (&data.grid, data.grid.bins());
    let (mut here, mut beyond) = (0.0, 0.0);
    for incidence in 0..grid.incidences() {
        let across = grid.wi(incidence).truncate();
        for (bin, region) in
            grid.regions(incidence).iter().enumerate().filter(|(_, region)| region.is_below())
        {
            let flux = data.value[0][incidence * bins + bin] * data.size[incidence * bins + bin];
            here += flux * across.length_squared();
            beyond -= flux * across.dot(region.middle().truncate());
        }
    }
    let ratio = if here > 0.0 && beyond > 0.0 { here / beyond } else { FIRST_INDEX };
    ratio.max(ratio.recip()).clamp(INDICES[0], INDICES[1])
}

/// (slope, weight) of every bin of the incidences with the smallest theta_i, of light that comes back where there is any; `eta`:
/// index beyond over index here.
fn slopes(data: &FitData, eta: f64) -> Vec<([f64; 2], f64)> {
    let grid = &data.grid;
    let bins = grid.bins();
    let steepest = grid.theta_i_deg.iter().copied().fold(f64::INFINITY, f64::min);
    let above = grid.looks_above();
    let mut found = Vec::new();
    for incidence in (0..grid.incidences()).filter(|&incidence| grid.incidence_deg(incidence).0 == steepest) {
        let wi = grid.wi(incidence);
        for (bin, region) in grid.regions(incidence).iter().enumerate() {
            if region.is_below() == above {
                continue;
            }
            let h = half_vector(wi, region.middle(), eta);
            if h.z <= 0.0 {
                continue;
            }
            let entry = incidence * bins + bin;
            let weight = data.value[0][entry] * data.size[entry] / h.length();
            let slope = [h.x / h.z, h.y / h.z];
            if weight > 0.0 && slope != [0.0, 0.0] {
                found.push((slope, weight));
            }
        }
    }
    found
}

/// The weighted median of sorted (value, weight) pairs; 0.3 where there are none.
fn median(sorted: &[(f64, f64)]) -> f64 {
    let half = 0.5 * sorted.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut sum = 0.0;
    for &(value, weight) in sorted {
        sum += weight;
        if sum >= half {
            return value.clamp(1e-4, 10.0);
        }
    }
    0.3
}
