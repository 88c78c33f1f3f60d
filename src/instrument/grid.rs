//! The geometry of a table: which incidences and which sensor bins it has.
//!
//! Axes in degrees, and the directions of the incidences. Written into tables as JSON.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::sphere;

/// The kinds of sensor geometry that a table may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GridKind {
    /// Bins between edges of theta_r and phi_r.
    #[default]
    Hemisphere,
    /// Circular apertures about single directions.
    Arm,
    /// A list of patches, each between two polar angles and two azimuths (Klems).
    Patches,
    /// A list of directions; the values are those at the directions, not means.
    Points,
    /// Rusinkiewicz angles: row = half vector (theta_h major), column = difference (theta_d major); values at the
    /// angles. Both arms of a pair move from column to column.
    HalfDifference,
}

/// The axes of a table: row = incidence (theta_i major, phi_i minor), column = bin (theta_r major, phi_r minor).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Grid {
    /// What the columns are.
    pub kind: GridKind,
    /// Polar angles of the incidences.
    pub theta_i_deg: Vec<f64>,
    /// Azimuths of the incidences; a single 0 when the azimuth is relative.
    pub phi_i_deg: Vec<f64>,
    /// Whether phi_r counts from the light's azimuth.
    pub phi_r_relative: bool,
    /// Hemisphere: edges of the rows, increasing, the last 90; on both sides of the surface 90 is among them and the last
    /// 180. Beyond 90: light that has gone through.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub theta_r_edges_deg: Vec<f64>,
    /// Hemisphere: edges of the columns, increasing, last - first = 360.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub phi_r_edges_deg: Vec<f64>,
    /// Arm: polar angles, negative ones on the far side.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub theta_r_deg: Vec<f64>,
    /// Arm: azimuths.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub phi_r_deg: Vec<f64>,
    /// Arm: half-angle of the aperture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aperture_deg: Option<f64>,
    /// The incidences as a list of (theta_i, phi_i), where they are no product of the two axes, which are then empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[serde(rename = "stops_deg")]
    pub incidences_deg: Vec<[f64; 2]>,
    /// Patches: `[theta_lo, theta_hi, phi_lo, phi_hi]` each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub patches_deg: Vec<[f64; 4]>,
    /// Points: `[theta_r, phi_r]` each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points_deg: Vec<[f64; 2]>,
    /// Half/difference: polar angles of the half vector; `theta_i_deg` and `phi_i_deg` are then empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub theta_h_deg: Vec<f64>,
    /// Half/difference: azimuths of the half vector; a single 0 where every azimuth is alike.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub phi_h_deg: Vec<f64>,
    /// Half/difference: polar angles of the difference vector.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub theta_d_deg: Vec<f64>,
    /// Half/difference: azimuths of the difference vector, [0, 180): half a turn exchanges the arms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub phi_d_deg: Vec<f64>,
}

impl Grid {
    /// Whether some bins lie above the horizon.
    pub fn looks_above(&self) -> bool {
        match self.kind {
            GridKind::Hemisphere => self.theta_r_edges_deg.first().is_some_and(|&first| first < 90.0),
            GridKind::Arm => self.theta_r_deg.iter().any(|theta| theta.abs() <= 90.0),
            GridKind::Patches => self.patches_deg.iter().any(|patch| patch[0] < 90.0),
            GridKind::Points => self.points_deg.iter().any(|point| point[0] <= 90.0),
            GridKind::HalfDifference => true,
        }
    }

    /// Whether some bins lie below the horizon.
    pub fn looks_below(&self) -> bool {
        match self.kind {
            GridKind::Hemisphere => self.theta_r_edges_deg.last().is_some_and(|&last| last > 90.0),
            GridKind::Arm => self.theta_r_deg.iter().any(|theta| theta.abs() > 90.0),
            GridKind::Patches => self.patches_deg.iter().any(|patch| patch[0] >= 90.0),
            GridKind::Points => self.points_deg.iter().any(|point| point[0] > 90.0),
            GridKind::HalfDifference => false,
        }
    }

    /// Number of incidences; of half/difference angles, of half vectors.
    pub fn incidences(&self) -> usize {
        if self.kind == GridKind::HalfDifference {
            self.theta_h_deg.len() * self.phi_h_deg.len()
        } else if self.incidences_deg.is_empty() {
            self.theta_i_deg.len() * self.phi_i_deg.len()
        } else {
            self.incidences_deg.len()
        }
    }

    /// Number of different azimuths among the incidences.
    pub fn azimuths(&self) -> usize {
        let mut azimuths: Vec<u64> =
            (0..self.incidences()).map(|incidence| self.incidence_deg(incidence).1.to_bits()).collect();
        azimuths.sort_unstable();
        azimuths.dedup();
        azimuths.len()
    }

    /// Whether every azimuth of the light is taken to be alike: the sensor's azimuths count from the light, which has one.
    /// A single azimuth alone says nothing of the others.
    pub fn is_isotropic(&self) -> bool {
        match self.kind {
            GridKind::HalfDifference => self.phi_h_deg.len() == 1,
            _ => self.phi_r_relative && self.azimuths() == 1,
        }
    }

    /// Number of sensor bins.
    pub fn bins(&self) -> usize {
        match self.kind {
            GridKind::Hemisphere => (self.theta_r_edges_deg.len() - 1) * (self.phi_r_edges_deg.len() - 1),
            GridKind::Arm => self.theta_r_deg.len() * self.phi_r_deg.len(),
            GridKind::Patches => self.patches_deg.len(),
            GridKind::Points => self.points_deg.len(),
            GridKind::HalfDifference => self.theta_d_deg.len() * self.phi_d_deg.len(),
        }
    }

    /// (theta_i, phi_i) of an incidence in degrees; of half/difference angles, (theta_h, phi_h).
    pub fn incidence_deg(&self, incidence: usize) -> (f64, f64) {
        if let Some(&[theta_i, phi_i]) = self.incidences_deg.get(incidence) {
            return (theta_i, phi_i);
        }
        let half = self.kind == GridKind::HalfDifference;
        let (theta, phi) =
            if half { (&self.theta_h_deg, &self.phi_h_deg) } else { (&self.theta_i_deg, &self.phi_i_deg) };
        (theta[incidence / phi.len()], phi[incidence % phi.len()])
    }

    /// The same sensor at some of the incidences, as a list; their regions and directions do not change. `None` for half
    /// vectors, which are no incidences.
    // Tested by `bands_of_a_table_are_its_rows` (tests/it/table/large_tables.rs).
    pub fn of_incidences(&self, incidences: impl IntoIterator<Item = usize>) -> Option<Grid> {
        let listed = |incidence: usize| <[f64; 2]>::from(self.incidence_deg(incidence));
        let (theta_i_deg, phi_i_deg) = (Vec::new(), Vec::new());
        (self.kind != GridKind::HalfDifference).then(|| Grid {
            incidences_deg: incidences.into_iter().map(listed).collect(),
            theta_i_deg,
            phi_i_deg,
            ..self.clone()
        })
    }

    /// The arms (wi, wo) of a half vector and a difference: unit vectors, either of which may lie below the horizon.
    ///
    /// wi = R_z(phi_h) R_y(theta_h) d, wo = 2 (wi.h) h - wi. Source: Rusinkiewicz 1998.
    // Tested by `arms_and_half_difference_angles_agree` (tests/it/interchange/interchange_merl.rs).
    pub fn arms_of_half(&self, row: usize, column: usize) -> (DVec3, DVec3) {
        let (theta_h, phi_h) = self.incidence_deg(row);
        let count = self.phi_d_deg.len();
        let d = sphere::direction_deg(self.theta_d_deg[column / count], self.phi_d_deg[column % count]);
        let (sin, cos) = sphere::sin_cos_deg(theta_h);
        let (h, turn) = (sphere::direction_deg(theta_h, phi_h), sphere::sin_cos_deg(phi_h));
        let wi = sphere::turned(DVec3::new(cos * d.x + sin * d.z, d.y, cos * d.z - sin * d.x), turn);
        (wi, 2.0 * wi.dot(h) * h - wi)
    }

    /// Direction to the light at an incidence; of half/difference angles the half vector.
    pub fn wi(&self, incidence: usize) -> DVec3 {
        let (theta_i, phi_i) = self.incidence_deg(incidence);
        sphere::direction_deg(theta_i, phi_i)
    }
}
