//! Reflectance of a whole hemisphere, total integrated scatter, and angle-resolved scatter.

use rayon::prelude::*;
use serde::Serialize;

use super::incidence::LightAzimuth;
use super::quantity::Quantity;
use super::reading::Reading;
use super::receptor::Receptor;
use super::samples::TableSamples;
use crate::instrument::{GridKind, Region};
use crate::sphere;
use crate::table::BrdfTable;

/// Half-angle of the cone about the mirror direction whose light is not scattered (ISO 13696), degrees.
const SPECULAR_DEG: f64 = 2.0;
/// Bins may be as large as this part of that cone.
const PART_OF_CONE: f64 = 0.5;

/// How much light of an incidence leaves, and how much of it beside the mirror direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scatter {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Directional-hemispherical reflectance: the integral of f cos over the hemisphere, luminous.
    pub reflectance: Quantity,
    /// The part of the light that leaves farther than 2 degrees from the mirror direction (total integrated scatter).
    pub tis: Quantity,
}

/// Scatter in one direction of the plane of incidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScatterAngle {
    /// From the normal, degrees: positive on the mirror's side, negative on the light's.
    pub theta_r_deg: f64,
    /// BSDF, 1/sr, luminous.
    pub brdf: f64,
    /// Angle-resolved scatter, flux per solid angle over the incident flux: BSDF times the cosine, 1/sr.
    pub ars: f64,
}

/// Reflectance and integrated scatter of every incidence.
///
/// rho = integral of f cos; TIS = 1 - (integral over the cone of 2 degrees)/rho (Bennett's ratio of scattered to all
/// reflected light; ISO 13696 leaves the cone out likewise, and what lies beyond 85 degrees, which is counted here).
// Tested by `a_lambert_table_has_the_closed_forms` (tests/it/appearance/readings.rs).
pub fn scatter(samples: &TableSamples, light: &LightAzimuth) -> Vec<Scatter> {
    let of = |&(theta_i_deg, incidence): &(f64, usize)| {
        let all = match Reading::of_all(samples.table, incidence) {
            Ok(all) => all,
            Err(why) => {
                let missing = || Quantity::missing(why.clone());
                return Scatter { theta_i_deg, reflectance: missing(), tis: missing() };
            }
        };
        let cone = Receptor::cone([theta_i_deg, light.mirror_phi_deg()], SPECULAR_DEG);
        let tis = match Reading::new(samples.table, incidence, &cone, PART_OF_CONE) {
            Ok(cone) => {
                samples.quantity(&[&all, &cone], |v| 1.0 - samples.luminance(v, 1) / samples.luminance(v, 0))
            }
            Err(why) => Quantity::missing(why),
        };
        Scatter { theta_i_deg, reflectance: samples.quantity(&[&all], |v| samples.luminance(v, 0)), tis }
    };
    light.incidences.par_iter().map(of).collect()
}

/// Angle-resolved scatter in the plane of incidence: of bins the mean per solid angle, from the light's horizon to the
/// mirror's.
///
/// ARS = f (integral of cos over the bin)/(its solid angle). Bins that were not measured are left out.
// Tested by `a_lambert_table_has_the_closed_forms` (tests/it/appearance/readings.rs).
pub fn angle_resolved(samples: &TableSamples, light: &LightAzimuth, incidence: usize) -> Vec<ScatterAngle> {
    let table = samples.table;
    let mut found: Vec<ScatterAngle> = (0..table.grid.bins())
        .zip(table.grid.regions(incidence))
        .filter(|(bin, region)| !region.is_below() && !table.is_gap(incidence * table.grid.bins() + bin))
        .filter_map(|(bin, region)| {
            let theta_r_deg = signed_polar_deg(table, &region, light)?;
            let entry = incidence * table.grid.bins() + bin;
            let values: Vec<f64> = table.colours.iter().map(|c| f64::from(c.total[entry])).collect();
            let brdf = samples.luminance(&values, 0);
            Some(ScatterAngle { theta_r_deg, brdf, ars: brdf * mean_cosine(&region) })
        })
        .collect();
    found.sort_by(|a, b| a.theta_r_deg.total_cmp(&b.theta_r_deg));
    found
}

/// The signed polar angle of a region that the plane of incidence cuts, on the side where most of it lies.
fn signed_polar_deg(table: &BrdfTable, region: &Region, light: &LightAzimuth) -> Option<f64> {
    let (sin, cos) = sphere::sin_cos_deg(light.mirror_phi_deg());
    let middle = region.middle();
    let (along, across) = (middle.x * cos + middle.y * sin, middle.y * cos - middle.x * sin);
    let theta_deg = sphere::theta(middle).to_degrees();
    let signed = if along < 0.0 { -theta_deg } else { theta_deg };
    let cut = match *region {
        // Half-open, so that a plane along an edge cuts one of two columns.
        Region::Rectangle { phi, .. } => {
            let half = 0.5 * (phi[1] - phi[0]);
            let off = across.atan2(along.abs());
            let off = if along < 0.0 { -off } else { off };
            -half - 1e-9 < off && off < half - 1e-9
        }
        Region::Cap { half_angle, .. } => across.abs() <= half_angle.sin().max(1e-9),
    };
    (cut || table.grid.kind == GridKind::Points && across.abs() < 1e-9).then_some(signed)
}

/// The mean of the cosine over a region, by solid angle.
fn mean_cosine(region: &Region) -> f64 {
    match *region {
        Region::Rectangle { theta: [t1, t2], phi: [p1, p2] } => {
            let solid_angle = 2.0 * (p2 - p1) * (0.5 * (t1 + t2)).sin() * (0.5 * (t2 - t1)).sin();
            region.projected_solid_angle() / solid_angle
        }
        // Of a cone: its axis's times (1 + cos a)/2.
        Region::Cap { axis, half_angle } => axis.z * 0.5 * (1.0 + half_angle.cos()),
    }
}
