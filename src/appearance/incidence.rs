//! The incidences of a table by azimuth of the light, and readings at an angle between two of them.

use super::reading::Reading;
use crate::instrument::{Grid, GridKind};
use crate::sphere;

/// Incidences farther apart than this say nothing of what is between them, degrees.
const WIDEST_GAP_DEG: f64 = 15.0;
/// Angles nearer than this are one, degrees.
const SAME_DEG: f64 = 1e-6;

/// The incidences at one azimuth of the light.
#[derive(Debug, Clone, PartialEq)]
pub struct LightAzimuth {
    /// Their azimuth, degrees.
    pub phi_i_deg: f64,
    /// Polar angle in degrees and incidence of each, by increasing angle.
    pub incidences: Vec<(f64, usize)>,
}

impl LightAzimuth {
    /// All azimuths of a table's light, in the order of its incidences; light from the pole belongs to each.
    pub fn all(grid: &Grid) -> Vec<Self> {
        if grid.kind == GridKind::HalfDifference {
            return Vec::new();
        }
        let angles: Vec<(f64, f64)> =
            (0..grid.incidences()).map(|incidence| grid.incidence_deg(incidence)).collect();
        let tilted = angles.iter().filter(|angle| angle.0 > 0.0);
        let mut azimuths: Vec<f64> = Vec::new();
        for phi in tilted.chain(&angles).map(|angle| sphere::reduced_deg(angle.1)) {
            let is_new = !azimuths.contains(&phi);
            // The pole alone makes no azimuth where there are others.
            if is_new
                && (azimuths.is_empty()
                    || angles.iter().any(|a| a.0 > 0.0 && sphere::reduced_deg(a.1) == phi))
            {
                azimuths.push(phi);
            }
        }
        azimuths.into_iter().map(|phi| Self::of(&angles, phi)).collect()
    }

    fn of(angles: &[(f64, f64)], phi_i_deg: f64) -> Self {
        let here = |angle: &(f64, f64)| angle.0 == 0.0 || sphere::reduced_deg(angle.1) == phi_i_deg;
        let mut incidences: Vec<(f64, usize)> = angles
            .iter()
            .enumerate()
            .filter(|(_, angle)| here(angle))
            .map(|(incidence, a)| (a.0, incidence))
            .collect();
        incidences.sort_by(|a, b| a.0.total_cmp(&b.0));
        incidences.dedup_by(|a, b| a.0 == b.0);
        LightAzimuth { phi_i_deg, incidences }
    }

    /// The azimuth of the mirror direction, degrees.
    pub fn mirror_phi_deg(&self) -> f64 {
        self.phi_i_deg + 180.0
    }

    /// The reading at an angle of the light, linear in the angle between the two nearest incidences where the table has not
    /// this one; `of` gives the reading at one of them, by its polar angle and incidence.
    // Tested by `between_incidences_readings_are_interpolated_and_said_to_be` (tests/it/appearance/readings.rs).
    pub fn at(
        &self,
        theta_i_deg: f64,
        of: impl Fn(f64, usize) -> Result<Reading, String>,
    ) -> Result<Reading, String> {
        if let Some(&(theta, incidence)) =
            self.incidences.iter().find(|incidence| (incidence.0 - theta_i_deg).abs() <= SAME_DEG)
        {
            return of(theta, incidence);
        }
        let after = self.incidences.partition_point(|incidence| incidence.0 < theta_i_deg);
        let (Some(&low), Some(&high)) =
            (after.checked_sub(1).and_then(|k| self.incidences.get(k)), self.incidences.get(after))
        else {
            return Err(format!("no incidence at theta_i {theta_i_deg}, nor one on either side"));
        };
        let gap = high.0 - low.0;
        if gap > WIDEST_GAP_DEG * (1.0 + 1e-9) {
            return Err(format!("no incidence between theta_i {} and {}", low.0, high.0));
        }
        let t = (theta_i_deg - low.0) / gap;
        let both = of(low.0, low.1)?.scaled(1.0 - t).plus(of(high.0, high.1)?.scaled(t));
        Ok(Reading { note: Some(format!("between theta_i {} and {}", low.0, high.0)), ..both })
    }
}
