//! A BRDF averaged over the bins of a grid: how a foreign file becomes a table, and how a file is compared with its
//! table.

pub(crate) mod angles;
mod axis;
mod folds;
pub(crate) mod gaps;
mod guide;
mod guided;
pub(crate) mod incidence_values;
pub(crate) mod interval;
mod levels;
pub(crate) mod lobe;
pub mod lookup;
mod means;
pub(crate) mod sampling;

use glam::DVec3;
use rayon::prelude::*;

use super::{Brdf, COMES_BACK, Checked, Colour, GONE_THROUGH, needed, spectral_table};
use crate::error::wrong;
use crate::files::memory;
use crate::instrument::{Grid, Region};
use crate::sphere;
use crate::table::{BrdfTable, ColourChannels};

/// Gauss-Legendre nodes and weights on [0, 1], four points.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
/// Azimuths round an aperture.
const AROUND: usize = 8;
/// Values of a table that is made unasked; more are refused.
const MOST_VALUES: usize = 1 << 28;

/// Directions in a bin with weights that add up to 1, even in projected solid angle.
///
/// A rectangle has 4 x 4 Gauss points in (sin^2 theta, phi), a cone 4 x 8 in (sin^2 psi, eta) with the cosine as
/// weight, a single direction itself.
pub fn nodes(region: &Region) -> Vec<(DVec3, f64)> {
    match *region {
        Region::Rectangle { theta: [t1, t2], phi: [p1, p2] } => {
            let (s1, s2) = (t1.sin().powi(2), t2.sin().powi(2));
            let side = if region.is_below() { -1.0 } else { 1.0 };
            let row = |&(x, w): &(f64, f64)| {
                let s = s1 + x * (s2 - s1);
                GAUSS.map(|(y, v)| {
                    let (sin_phi, cos_phi) = (p1 + y * (p2 - p1)).sin_cos();
                    (DVec3::new(s.sqrt() * cos_phi, s.sqrt() * sin_phi, side * (1.0 - s).sqrt()), w * v)
                })
            };
            GAUSS.iter().flat_map(row).collect()
        }
        Region::Cap { axis, half_angle: 0.0 } => vec![(axis, 1.0)],
        Region::Cap { axis, half_angle } => cone(axis, half_angle),
    }
}

fn cone(axis: DVec3, half_angle: f64) -> Vec<(DVec3, f64)> {
    let (tangent, bitangent) = sphere::frame(axis);
    let mut nodes = Vec::with_capacity(GAUSS.len() * AROUND);
    for (x, w) in GAUSS {
        let sin_psi = half_angle.sin() * x.sqrt();
        let cos_psi = (1.0 - sin_psi * sin_psi).sqrt();
        for k in 0..AROUND {
            let (sin, cos) = (std::f64::consts::TAU * (k as f64 + 0.5) / AROUND as f64).sin_cos();
            let wo = cos_psi * axis + sin_psi * (cos * tangent + sin * bitangent);
            // d omega = sin psi d psi d eta = d(sin^2 psi) d eta/(2 cos psi).
            nodes.push((wo, w * (wo.z * axis.z.signum()).max(0.0) / cos_psi));
        }
    }
    let sum: f64 = nodes.iter().map(|node| node.1).sum();
    nodes.iter_mut().for_each(|node| node.1 /= sum);
    nodes
}

/// Mean of `brdf` over a bin, by projected solid angle.
pub fn mean(brdf: &dyn Brdf, wi: DVec3, region: &Region) -> Colour {
    let mut sum = [0.0; 3];
    for (wo, weight) in nodes(region) {
        let value = brdf.brdf(wi, wo);
        sum.iter_mut().zip(value).for_each(|(s, v)| *s += weight * v);
    }
    sum
}

/// The table of a BRDF on a grid, without error bars.
pub fn resample(brdf: &dyn Brdf, grid: &Grid) -> Checked<BrdfTable> {
    resample_spectrum([brdf].into_iter(), &[], grid)
}

/// The same of functions that have the colours of a table by threes, with the wavelengths of all.
// Tested by `a_spectrum_is_resampled_like_its_colours` (tests/it/interchange/interchange_ssdd.rs).
pub fn resample_spectrum<'a>(
    parts: impl Iterator<Item = &'a dyn Brdf>,
    wavelengths_nm: &[f64],
    grid: &Grid,
) -> Checked<BrdfTable> {
    let parts: Vec<&dyn Brdf> = parts.collect();
    let (incidences, bins) = (grid.incidences(), grid.bins());
    for (looks, side, what) in [(grid.looks_above(), 0, COMES_BACK), (grid.looks_below(), 1, GONE_THROUGH)] {
        if looks && parts.iter().any(|part| !part.sides()[side]) {
            return Err(wrong!(
                "the file says nothing of light that {what}, which the wanted bins collect; take a table of the other side for --like"
            ));
        }
    }
    let pairs = incidences.checked_mul(bins).filter(|&pairs| pairs <= MOST_VALUES);
    let pairs = pairs.ok_or_else(|| format!("{incidences} incidences of {bins} bins are too many"))?;
    // A small file may be a function of many lights, each of which becomes thousands of bins.
    memory::check(needed::table(pairs, parts.iter().map(|part| part.colours()).sum()))?;
    let total = parts.into_iter().flat_map(|part| totals(part, grid)).collect();
    spectral_table(grid.clone(), total, wavelengths_nm)
}

/// A table in tables of three colours at most, which is what a function has.
pub fn thirds(table: &BrdfTable) -> Vec<BrdfTable> {
    let part = |colours: &[ColourChannels]| BrdfTable {
        colours: colours.to_vec(),
        hits: table.hits.clone(),
        ..table.header(&table.grid)
    };
    table.colours.chunks(3).map(part).collect()
}

fn totals(brdf: &dyn Brdf, grid: &Grid) -> Vec<Vec<f32>> {
    let (incidences, bins) = (grid.incidences(), grid.bins());
    let mut total = vec![Vec::with_capacity(incidences * bins); brdf.colours()];
    for incidence in 0..incidences {
        let wi = grid.wi(incidence);
        let means: Vec<Colour> =
            grid.regions(incidence).par_iter().map(|region| mean(brdf, wi, region)).collect();
        for (colour, total) in total.iter_mut().enumerate() {
            total.extend(means.iter().map(|mean| mean[colour] as f32));
        }
    }
    total
}

/// The geometry of an imported table where the file has none of its own and no other is asked for: centred bins of
/// 2.5 x 5 degrees under the given incidences; with no azimuths of the light every azimuth is alike.
pub fn default_grid(theta_i_deg: Vec<f64>, phi_i_deg: Vec<f64>) -> Grid {
    let isotropic = phi_i_deg.is_empty();
    let inner = (0..36).map(|k| 2.5 * (f64::from(k) + 0.5));
    Grid {
        theta_i_deg,
        phi_i_deg: if isotropic { vec![0.0] } else { phi_i_deg },
        phi_r_relative: isotropic,
        theta_r_edges_deg: std::iter::once(0.0).chain(inner).chain([90.0]).collect(),
        phi_r_edges_deg: (0..=72).map(|k| 5.0 * f64::from(k) - 2.5).collect(),
        ..Grid::default()
    }
}
