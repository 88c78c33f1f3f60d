//! What the tables of a Zemax file integrate to, next to the TIS that they name.

use rayon::prelude::*;

use super::tables::{Zemax, about, frame};
use crate::instrument::GridKind;
use crate::sphere;
use crate::table::BrdfTable;

/// Steps of the integral over a table, degrees of azimuth and radial; its own angles cut them.
const FINE: [f64; 2] = [6.0, 2.0];
/// TIS and the integral of the values agree where they are no further apart, as a share of the larger: coarse files are
/// integrated by everyone's own rule.
const TIS_TOLERANCE: f64 = 0.02;

/// Values that are scaled by more than this are said to be.
const SAID_ABOVE: f64 = 0.01;

/// Sum of a table over its bins by projected solid angle at the incidence of these angles; `None` where bins have no
/// size.
pub fn albedo(table: &BrdfTable, theta: f64, phi: f64) -> Option<f64> {
    if !matches!(table.grid.kind, GridKind::Hemisphere | GridKind::Patches) {
        return None;
    }
    let wi = sphere::direction(theta, phi);
    let off = |&incidence: &usize| table.grid.wi(incidence).distance_squared(wi);
    let incidence = (0..table.grid.incidences()).min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let regions = table.grid.regions(incidence);
    let values = &table.colours[0].total[incidence * regions.len()..];
    Some(regions.iter().zip(values).map(|(region, &f)| region.projected_solid_angle() * f64::from(f)).sum())
}

impl Zemax {
    /// Integral of a channel times the cosine over the hemisphere at each incidence of each rotation: two Gauss
    /// points in each interval of the file's angles and of `FINE` steps.
    pub fn integrals(&self, channel: usize) -> Vec<f64> {
        let (half, times) = if self.symmetric { (180.0, 2.0) } else { (360.0, 1.0) };
        let (azimuths, radials) =
            (pieces(&self.azimuths, half, FINE[0]), pieces(&self.radials, 180.0, FINE[1]));
        let channels = std::slice::from_ref(&self.values[channel]);
        let integral = |incidence: usize| {
            let (turn, light) = (incidence / self.light.len(), incidence % self.light.len());
            let frame = frame(self.light[light].to_radians());
            let point = |&(radial, w): &(f64, f64), &(azimuth, v): &(f64, f64)| {
                let cos = about(frame, azimuth, radial).z;
                if cos <= 0.0 {
                    return 0.0;
                }
                let [value, ..] = self.value(channels, ([light; 2], 0.0), ([turn; 2], 0.0), azimuth, radial);
                w * v * cos * radial.to_radians().sin() * value
            };
            times * radials.iter().map(|r| azimuths.iter().map(|a| point(r, a)).sum::<f64>()).sum::<f64>()
        };
        (0..self.rotations.len() * self.light.len()).into_par_iter().map(integral).collect()
    }

    /// Scales the values of each incidence such that they integrate to its albedo: bins that are wide next to the
    /// lobe leave the interpolant between them, not its integral, open. Says by how much at most, where that is much.
    // Tested by `the_values_of_a_file_integrate_to_its_tis` (tests/it/interchange/interchange_zemax.rs).
    pub fn hold_energy(&mut self, albedos: &[f64], integrals: &[f64]) -> Option<String> {
        let size = self.azimuths.len() * self.radials.len();
        let (mut count, mut most) = (0, 0.0f64);
        for (block, (albedo, sum)) in self.values[0].chunks_mut(size).zip(albedos.iter().zip(integrals)) {
            let factor = albedo / sum;
            if !factor.is_finite() || factor == 1.0 {
                continue;
            }
            block.iter_mut().for_each(|value| *value = (f64::from(*value) * factor) as f32);
            if (factor - 1.0).abs() > SAID_ABOVE {
                (count, most) = (count + 1, most.max((factor - 1.0).abs()));
            }
        }
        (count > 0).then(|| {
            format!(
                "the bins are wide beside the lobe: values of {count} of {} incidences are scaled, by up to {:.1} %, to \
                 integrate to the table's albedo",
                integrals.len(),
                100.0 * most
            )
        })
    }

    /// The note where TIS and integrals are apart, or light is made.
    pub fn disagreement(&self, channel: usize, integrals: &[f64]) -> Option<String> {
        let share = |&(tis, sum): &(f64, f64)| (tis - sum).abs() / tis.max(sum).max(f64::MIN_POSITIVE);
        let pairs: Vec<(f64, f64)> =
            self.tis[channel].iter().copied().zip(integrals.iter().copied()).collect();
        let apart = pairs.iter().filter(|pair| share(pair) > TIS_TOLERANCE).count();
        let (worst, pair) = pairs.iter().enumerate().max_by(|a, b| share(a.1).total_cmp(&share(b.1)))?;
        let (turn, light) = (self.rotations[worst / self.light.len()], self.light[worst % self.light.len()]);
        let above = integrals.iter().filter(|&&sum| sum > 1.0 + TIS_TOLERANCE).count();
        let gain = if above > 0 {
            format!("; {above} integrals are above 1: more light than comes in")
        } else {
            String::new()
        };
        (apart + above > 0).then(|| {
            format!(
                "TIS and the integral of the values are more than {:.0} % apart at {apart} of {} incidences, the worst at \
                 {light} (rotation {turn}): TIS {:.4}, integral {:.4}; the values are taken{gain}",
                100.0 * TIS_TOLERANCE,
                pairs.len(),
                pair.0,
                pair.1
            )
        })
    }
}

/// Two Gauss points, in degrees, and their weights in radians, in each piece of [0, end] between nodes and at most
/// `step`.
fn pieces(nodes: &[f64], end: f64, step: f64) -> Vec<(f64, f64)> {
    let inner = nodes.iter().copied().filter(|&node| node > 0.0 && node < end);
    let cuts: Vec<f64> = std::iter::once(0.0).chain(inner).chain([end]).collect();
    let mut points = vec![];
    for pair in cuts.windows(2) {
        let count = ((pair[1] - pair[0]) / step).ceil();
        let width = (pair[1] - pair[0]) / count;
        for k in 0..count as usize {
            let middle = pair[0] + width * (k as f64 + 0.5);
            let off = 0.5 * width / 3f64.sqrt();
            points.extend([middle - off, middle + off].map(|x| (x, 0.5 * width.to_radians())));
        }
    }
    points
}
