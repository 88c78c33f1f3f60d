//! What apertures do to a value: the model's mean over both cones against its value at their axes, predicted before a
//! measurement; and Richardson's extrapolation from two measured tables, one with half the apertures of the other.

use glam::DVec3;
use serde::Serialize;

use super::bin_mean::{BinMeans, source_nodes};
use super::model::Model;
use crate::campaign::{Campaign, SensorArm};
use crate::instrument::{Grid, GridKind, Region, grid_of};
use crate::optics::Fresnel;
use crate::stats;
use crate::theory::{Masking, Microfacet};
use crate::validate::two_tables::{ComparedTable, paired};

/// Nodes along the radius of the light's cone.
const ORDER: usize = 6;
/// Incidences that are looked at, evenly over theta_i.
const MOST_INCIDENCES: usize = 12;

/// Half-angles of both cones, rad; 0: parallel light, a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cones {
    /// Of the light.
    pub light: f64,
    /// Of the sensor.
    pub sensor: f64,
}

impl Cones {
    fn halved(self) -> Self {
        Cones { light: 0.5 * self.light, sensor: 0.5 * self.sensor }
    }
}

/// (4 f(h/2) - f(h))/3: without the term of order h^2 of an even error in the aperture h.
pub fn richardson(half: f64, whole: f64) -> f64 {
    (4.0 * half - whole) / 3.0
}

/// The model's mean over both cones over its value at the axes, minus 1.
///
/// - `wi`, `wo`: axes, unit vectors, stage's frame; both cones above the horizon. F = 1: Fresnel is smooth next to D.
/// - Numerics: the cubature's 1e-6, and for the light's cone 6 x 13 nodes, enough for half-angles up to alpha.
// Tested by `the_aperture_bias_of_ggx_is_the_known_one` (tests/it/measure/instruments.rs).
pub fn bias(model: &Microfacet, masking: Masking, [wi, wo]: [DVec3; 2], cones: Cones) -> f64 {
    let means = BinMeans::new(vec![masking]);
    let mean = |cones: Cones| {
        let source = source_nodes(wi, cones.light, ORDER);
        let region = Region::Cap { axis: wo, half_angle: cones.sensor };
        means.evaluate(model, &source, &[region])[0].unit[0]
    };
    mean(cones) / mean(Cones { light: 0.0, sensor: 0.0 }) - 1.0
}

/// The largest bias at the top of a lobe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ApertureBias {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Polar angle of the sensor.
    pub theta_r_deg: f64,
    /// Azimuth of the sensor from the light's.
    pub phi_r_deg: f64,
    /// The mean over the cones over the value at their axes, minus 1.
    pub bias: f64,
    /// The same with half the apertures.
    pub bias_of_half: f64,
    /// What (4 f(h/2) - f(h))/3 leaves of it.
    pub bias_extrapolated: f64,
    /// Incidences that were looked at.
    #[serde(rename = "stops")]
    pub incidences: usize,
}

/// The largest bias that a campaign's apertures give a lobe's top, by the model at the smallest roughness; `None` where
/// there is no aperture, or no model that has a value at a direction.
///
/// At each incidence (of the first azimuth, twelve at most) the sensor's position is the one with the largest value; for
/// bins over the hemisphere it is the mirror direction under the light's cone alone.
// Tested by `check_says_what_the_apertures_do` (tests/it/measure/instruments.rs).
pub fn worst(campaign: &Campaign) -> Option<ApertureBias> {
    let light = campaign.light.aperture_deg.to_radians();
    let sensor = match &campaign.sensor {
        SensorArm::Arm { aperture_deg, .. } => aperture_deg.to_radians(),
        SensorArm::Hemisphere { .. } | SensorArm::KlemsFull { .. } => 0.0,
    };
    let Some(Model::Microfacet { surface, maskings, .. }) = Model::of(campaign) else { return None };
    if light == 0.0 && sensor == 0.0 {
        return None;
    }
    // Of three maskings the height-correlated one; without shadowing there is one.
    let masking = maskings[maskings.len() / 2];
    let grid = grid_of(campaign);
    let incidences = shown(&grid);
    let at = |&incidence: &usize| {
        let wi = grid.wi(incidence);
        let wo = top(&surface, masking, &grid, incidence)?;
        let cones = Cones { light, sensor };
        let of = |cones| bias(&surface, masking, [wi, wo], cones);
        let (whole, half) = (of(cones), of(cones.halved()));
        let turn = crate::sphere::phi(wo).to_degrees() - grid.incidence_deg(incidence).1;
        Some(ApertureBias {
            theta_i_deg: grid.incidence_deg(incidence).0,
            theta_r_deg: crate::sphere::theta(wo).to_degrees(),
            phi_r_deg: crate::sphere::reduced_deg(turn),
            bias: whole,
            bias_of_half: half,
            bias_extrapolated: richardson(half, whole),
            incidences: incidences.len(),
        })
    };
    incidences.iter().filter_map(at).max_by(|a, b| a.bias.abs().total_cmp(&b.bias.abs()))
}

/// Some incidences of the first azimuth.
fn shown(grid: &Grid) -> Vec<usize> {
    let first: Vec<usize> = (0..grid.incidences()).step_by(grid.phi_i_deg.len().max(1)).collect();
    let step = first.len().div_ceil(MOST_INCIDENCES).max(1);
    first.into_iter().step_by(step).collect()
}

/// The sensor's position above the horizon with the largest value, or the mirror direction.
fn top(model: &Microfacet, masking: Masking, grid: &Grid, incidence: usize) -> Option<DVec3> {
    let wi = grid.wi(incidence);
    if grid.kind != GridKind::Arm {
        return Some(DVec3::new(-wi.x, -wi.y, wi.z));
    }
    let value = |wo: &DVec3| model.brdf(wi, *wo, masking, &Fresnel::Perfect);
    let axes = grid.regions(incidence).into_iter().filter_map(|region| match region {
        Region::Cap { axis, .. } if axis.z > 0.0 => Some(axis),
        Region::Cap { .. } | Region::Rectangle { .. } => None,
    });
    axes.max_by(|a, b| value(a).total_cmp(&value(b)))
}

/// One position of two tables, extrapolated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extrapolated {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Azimuth of the light.
    pub phi_i_deg: f64,
    /// Polar angle of the sensor.
    pub theta_r_deg: f64,
    /// Its azimuth.
    pub phi_r_deg: f64,
    /// Colour, from 0.
    pub colour: usize,
    /// BRDF of the table with the wider apertures, 1/sr.
    pub wide: f64,
    /// BRDF of the other one.
    pub narrow: f64,
    /// (4 narrow - wide)/3.
    pub extrapolated: f64,
    /// Its standard error; null where the tables have none.
    pub extrapolated_se: Option<f64>,
}

/// Extrapolates two tables of an arm to apertures of 0; `Err` says in one line what does not fit.
///
/// - `narrow` has half of every aperture of `wide`, and is the same else. The error is that of the combination,
///   realisation by realisation where both were measured on the same patches, else sqrt(16 se^2 + se^2)/3.
// Tested by `two_apertures_give_the_value_without_one` (tests/it/measure/instruments.rs).
pub fn extrapolate(wide: ComparedTable, narrow: ComparedTable) -> Result<Vec<Extrapolated>, String> {
    fits(&wide, &narrow)?;
    let (grid, both) = (&wide.table.grid, paired(&wide, &narrow));
    let (bins, columns) = (grid.bins(), grid.phi_r_deg.len());
    let mut rows = Vec::new();
    for at in 0..grid.incidences() * bins {
        let (theta_i_deg, phi_i_deg) = grid.incidence_deg(at / bins);
        for colour in 0..wide.table.colours.len() {
            let value = |side: &ComparedTable| f64::from(side.table.colours[colour].total[at]);
            let error = |side: &ComparedTable| f64::from(side.table.colours[colour].stderr[at]);
            let (a, b) = (error(&wide), error(&narrow));
            let apart = (a >= 0.0 && b >= 0.0).then(|| (16.0 * b * b + a * a).sqrt() / 3.0);
            let together = both.and_then(|(w, n)| {
                let part = |k: usize| {
                    let of = |parts: &crate::table::Realisations| f64::from(parts.parts[k].total[colour][at]);
                    richardson(of(n), of(w))
                };
                stats::mean_and_se((0..w.parts.len()).map(part)).1
            });
            rows.push(Extrapolated {
                theta_i_deg,
                phi_i_deg,
                theta_r_deg: grid.theta_r_deg[at % bins / columns],
                phi_r_deg: grid.phi_r_deg[at % bins % columns],
                colour,
                wide: value(&wide),
                narrow: value(&narrow),
                extrapolated: richardson(value(&narrow), value(&wide)),
                extrapolated_se: together.or(apart),
            });
        }
    }
    Ok(rows)
}

/// Whether every aperture of `narrow` is half of that of `wide`, and nothing else differs.
fn fits(wide: &ComparedTable, narrow: &ComparedTable) -> Result<(), String> {
    let (w, n) = (&wide.table.grid, &narrow.table.grid);
    let (Some(aperture_w), Some(aperture_n)) = (w.aperture_deg, n.aperture_deg) else {
        return Err("gonio.grid: only tables of an arm have apertures to extrapolate".into());
    };
    if wide.table.colours.len() != narrow.table.colours.len() {
        return Err("its colours are not those of the other table".into());
    }
    if (Grid { aperture_deg: w.aperture_deg, ..n.clone() }) != *w {
        return Err("gonio.grid: incidences or positions differ from the other table's".into());
    }
    let light = |side: &ComparedTable| side.campaign.map_or(0.0, |campaign| campaign.light.aperture_deg);
    for (what, wide, narrow) in
        [("sensor.arm", aperture_w, aperture_n), ("light", light(wide), light(narrow))]
    {
        // Half-angles as they are written: 0.1 and 0.05 are doubles that differ by a rounding.
        if (narrow - 0.5 * wide).abs() > 1e-9 * wide {
            return Err(format!("{what}.aperture_deg = {narrow}: must be half of the other table's {wide}"));
        }
    }
    Ok(())
}
