//! Tables over Rusinkiewicz' half and difference angles, as MERL files hold them: as a function of two directions, and
//! as a table of stops and bins for whoever needs one.
//!
//! Linear between the angles; cells without a value (no arrivals: an arm below the horizon) are left out. phi_d and
//! phi_d + 180 are one pair with its arms exchanged, so such a table is reciprocal by construction.

use glam::DVec3;

use super::resample::{default_grid, resample};
use super::{Brdf, Colour, Reason};
use crate::instrument::{Grid, GridKind};
use crate::sphere;
use crate::table::BrdfTable;

/// Increasing nodes in degrees; `turn` where they wrap.
#[derive(Debug, Clone)]
struct Axis {
    nodes: Vec<f64>,
    turn: Option<f64>,
}

impl Axis {
    /// The nodes on both sides of x and the share of the second; beyond the ends of an open axis the end.
    fn around(&self, x: f64) -> [(usize, f64); 2] {
        let count = self.nodes.len();
        let above = self.nodes.partition_point(|&node| node <= x);
        let (low, high) = match self.turn {
            Some(_) => ((above + count - 1) % count, above % count),
            None => (above.saturating_sub(1), above.min(count - 1)),
        };
        let width = |step: f64| self.turn.map_or(step, |turn| step.rem_euclid(turn));
        let gap = width(self.nodes[high] - self.nodes[low]);
        let share = if low == high || gap == 0.0 { 0.0 } else { width(x - self.nodes[low]) / gap };
        [(low, 1.0 - share), (high, share)]
    }
}

/// A table as a function.
#[derive(Debug, Clone)]
pub struct HalfDifference {
    /// theta_h, phi_h, theta_d, phi_d.
    axes: [Axis; 4],
    /// Per colour, row-major as in the table.
    values: Vec<Vec<f32>>,
    seen: Vec<bool>,
}

impl HalfDifference {
    /// The totals of a table.
    pub fn new(table: &BrdfTable) -> Reason<Self> {
        let grid = &table.grid;
        if grid.kind != GridKind::HalfDifference {
            return Err("the table has no half/difference angles".into());
        }
        let open = |nodes: &[f64]| Axis { nodes: nodes.to_vec(), turn: None };
        let round = |nodes: &[f64], turn| Axis { nodes: nodes.to_vec(), turn: Some(turn) };
        let axes = [
            open(&grid.theta_h_deg),
            round(&grid.phi_h_deg, 360.0),
            open(&grid.theta_d_deg),
            round(&grid.phi_d_deg, 180.0),
        ];
        let values = table.colours.iter().map(|colour| colour.total.clone()).collect();
        Ok(HalfDifference { axes, values, seen: table.hits.iter().map(|&hits| hits > 0).collect() })
    }

    /// Whether every azimuth of the half vector is alike.
    fn is_isotropic(&self) -> bool {
        self.axes[1].nodes.len() == 1
    }
}

/// theta_h, phi_h, theta_d, phi_d of a pair in degrees, phi_d in [0, 180).
///
/// Held by: `arms_and_half_difference_angles_agree` (tests/interchange_merl.rs).
pub fn angles_deg(wi: DVec3, wo: DVec3) -> [f64; 4] {
    let h = (wi + wo).normalize();
    let (theta_h, phi_h) = (sphere::theta(h), sphere::phi(h));
    let turned = sphere::turned(wi, (-phi_h.sin(), phi_h.cos()));
    let (sin, cos) = theta_h.sin_cos();
    let d = DVec3::new(cos * turned.x - sin * turned.z, turned.y, sin * turned.x + cos * turned.z);
    let phi_d = sphere::phi(d).to_degrees() % 180.0;
    [theta_h.to_degrees(), phi_h.to_degrees(), sphere::theta(d).to_degrees(), phi_d]
}

impl Brdf for HalfDifference {
    fn colours(&self) -> usize {
        self.values.len()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let at = angles_deg(wi, wo);
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

/// Such a table as one of stops and bins: means over the bins of `grid`, or over centred bins of 2.5 x 5 degrees under
/// stops of 5 (anisotropic: 15) degrees. `None` where it is one already.
pub fn as_arms(table: &BrdfTable, grid: Option<&Grid>) -> Reason<Option<BrdfTable>> {
    if table.grid.kind != GridKind::HalfDifference {
        return Ok(None);
    }
    let brdf = HalfDifference::new(table)?;
    let even = |step: f64, count: usize| (0..count).map(|k| step * k as f64).collect::<Vec<f64>>();
    let own = if brdf.is_isotropic() {
        default_grid(even(5.0, 18), vec![])
    } else {
        default_grid(even(15.0, 6), even(15.0, 24))
    };
    resample(&brdf, grid.unwrap_or(&own)).map(Some)
}
