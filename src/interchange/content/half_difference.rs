//! Tables over Rusinkiewicz' half and difference angles, as MERL files hold them: as a function of two directions, and
//! as a table of incidences and bins for callers that need one.
//!
//! Linear between the angles; cells without a value (no arrivals: an arm below the horizon) are left out. phi_d and
//! phi_d + 180 are one pair with its arms exchanged, so such a table is reciprocal by construction.

use glam::DVec3;

use crate::instrument::{Grid, GridKind};
use crate::interchange::resample::interval::{around, interval};
use crate::interchange::resample::{default_grid, resample_spectrum, thirds};
use crate::interchange::{Brdf, Checked, Colour};
use crate::sphere;
use crate::table::BrdfTable;

/// Increasing nodes in degrees; `turn` where they wrap.
#[derive(Debug, Clone)]
struct AngleAxis {
    nodes: Vec<f64>,
    turn: Option<f64>,
}

impl AngleAxis {
    /// The nodes on both sides of x, with their weights.
    fn around(&self, x: f64) -> [(usize, f64); 2] {
        let ([low, high], place) = match self.turn {
            Some(turn) => around(&self.nodes, x % turn, turn),
            None => interval(&self.nodes, x),
        };
        [(low, 1.0 - place), (high, place)]
    }
}

/// A table as a function.
#[derive(Debug, Clone)]
pub struct HalfDifference {
    /// theta_h, phi_h, theta_d, phi_d.
    axes: [AngleAxis; 4],
    /// Per colour, row-major as in the table.
    values: Vec<Vec<f32>>,
    seen: Vec<bool>,
}

impl HalfDifference {
    /// The totals of a table.
    pub fn new(table: &BrdfTable) -> Checked<Self> {
        let grid = &table.grid;
        if grid.kind != GridKind::HalfDifference {
            return Err("the table has no half/difference angles".into());
        }
        let values = table.colours.iter().map(|colour| colour.total.clone()).collect();
        Ok(Self::of(grid, values, &table.hits, 180.0))
    }

    /// Values over azimuths of a whole turn: a pair and its exchange are distinguished.
    pub fn directed(grid: &Grid, values: Vec<Vec<f32>>, hits: &[u32]) -> Self {
        Self::of(grid, values, hits, 360.0)
    }

    fn of(grid: &Grid, values: Vec<Vec<f32>>, hits: &[u32], turn_d: f64) -> Self {
        let open = |nodes: &[f64]| AngleAxis { nodes: nodes.to_vec(), turn: None };
        let round = |nodes: &[f64], turn| AngleAxis { nodes: nodes.to_vec(), turn: Some(turn) };
        let axes = [
            open(&grid.theta_h_deg),
            round(&grid.phi_h_deg, 360.0),
            open(&grid.theta_d_deg),
            round(&grid.phi_d_deg, turn_d),
        ];
        HalfDifference { axes, values, seen: hits.iter().map(|&hits| hits > 0).collect() }
    }
}

/// theta_h, phi_h, theta_d, phi_d of a pair in degrees, phi_d in [0, 180).
// Tested by `arms_and_half_difference_angles_agree` (tests/it/interchange/interchange_merl.rs).
pub fn angles_deg(wi: DVec3, wo: DVec3) -> [f64; 4] {
    let [theta_h, phi_h, theta_d, phi_d] = directed_angles_deg(wi, wo);
    [theta_h, phi_h, theta_d, phi_d % 180.0]
}

/// The same with phi_d in [0, 360), which distinguishes the arms.
fn directed_angles_deg(wi: DVec3, wo: DVec3) -> [f64; 4] {
    let h = (wi + wo).normalize();
    let (theta_h, phi_h) = (sphere::theta(h), sphere::phi(h));
    let turned = sphere::turned(wi, (-phi_h.sin(), phi_h.cos()));
    let (sin, cos) = theta_h.sin_cos();
    let d = DVec3::new(cos * turned.x - sin * turned.z, turned.y, sin * turned.x + cos * turned.z);
    [theta_h, phi_h, sphere::theta(d), sphere::phi(d)].map(f64::to_degrees)
}

impl Brdf for HalfDifference {
    fn colours(&self) -> usize {
        self.values.len()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let at = directed_angles_deg(wi, wo);
        let taps: [_; 4] = std::array::from_fn(|k| self.axes[k].around(at[k]));
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for corner in 0..16 {
            let tap = |axis: usize| taps[axis][corner >> axis & 1];
            let weight: f64 = (0..4).map(|axis| tap(axis).1).product();
            let cell = (0..4).fold(0, |cell, axis| cell * self.axes[axis].nodes.len() + tap(axis).0);
            if weight > 0.0 && self.seen[cell] {
                weights += weight;
                let values = self.values.iter().map(|values| f64::from(values[cell]));
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        if weights > 0.0 { sum.map(|s| s / weights) } else { sum }
    }
}

/// Such a table as one of incidences and bins: means over the bins of `grid`, or over centred bins of 2.5 x 5 degrees
/// under incidences of 5 (anisotropic: 15) degrees. `None` where it is one already.
pub fn as_arms(table: &BrdfTable, grid: Option<&Grid>) -> Checked<Option<BrdfTable>> {
    if table.grid.kind != GridKind::HalfDifference {
        return Ok(None);
    }
    let own = default_arms(table.grid.is_isotropic());
    let parts = thirds(table).iter().map(HalfDifference::new).collect::<Checked<Vec<_>>>()?;
    let parts = parts.iter().map(|part| part as &dyn Brdf);
    resample_spectrum(parts, &table.wavelengths_nm(), grid.unwrap_or(&own)).map(Some)
}

/// Incidences of 5 (anisotropic: 15) degrees over the default bins.
pub fn default_arms(isotropic: bool) -> Grid {
    let even = |step: f64, count: usize| (0..count).map(|k| step * k as f64).collect::<Vec<f64>>();
    if isotropic { default_grid(even(5.0, 18), vec![]) } else { default_grid(even(15.0, 6), even(15.0, 24)) }
}
