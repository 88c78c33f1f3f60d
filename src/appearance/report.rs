//! All figures of a table's look.

use serde::Serialize;

use super::gloss::{Gloss, gloss};
use super::haze::{Haze, haze};
use super::incidence::LightAzimuth;
use super::reflectance::{Reflected, reflectance};
use super::samples::TableSamples;
use super::scatter::{Scatter, ScatterAngle, angle_resolved, scatter};
use crate::error::{Checked, wrong};
use crate::instrument::GridKind;
use crate::table::{BrdfTable, Realisations};

/// Version of the figures' names.
const SCHEMA: u32 = 1;

/// The figures of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Appearance {
    /// Version of the names here.
    pub schema: u32,
    /// What the table's colours were taken for.
    pub colours: String,
    /// Realisations, or groups of them, behind the standard errors; 0: none.
    pub realisations: usize,
    /// By azimuth of the light; one where every azimuth is alike.
    pub azimuths: Vec<AppearanceAtAzimuth>,
}

/// The figures under light from one azimuth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AppearanceAtAzimuth {
    /// The azimuth.
    pub phi_i_deg: f64,
    /// At 20, 60, 85 degrees.
    pub gloss: Vec<Gloss>,
    /// At 20 and 30 degrees.
    pub haze: Haze,
    /// By incidence.
    pub scatter: Vec<Scatter>,
    /// By geometry.
    pub reflectance: Vec<Reflected>,
    /// Angle-resolved scatter in the plane of incidence, by incidence.
    pub ars: Vec<AngleResolved>,
}

/// Angle-resolved scatter of one incidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AngleResolved {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// By direction.
    pub angles: Vec<ScatterAngle>,
}

/// The figures of a table of light that comes back. Errors: of half/difference angles, and of a sensor that only looks below the
/// surface.
pub fn appearance(table: &BrdfTable, parts: Option<&Realisations>) -> Checked<Appearance> {
    first_azimuths(table, parts, usize::MAX)
}

/// The same under light from the first azimuths alone, so many at most.
pub fn first_azimuths(table: &BrdfTable, parts: Option<&Realisations>, most: usize) -> Checked<Appearance> {
    if table.grid.kind == GridKind::HalfDifference {
        return Err(wrong!("half/difference angles: take it as incidences and bins"));
    }
    if !table.grid.looks_above() {
        return Err(wrong!(
            "holds light that has gone through alone, of which no gloss or reflectance is made"
        ));
    }
    let samples = TableSamples::new(table, parts);
    let at = |light: LightAzimuth| AppearanceAtAzimuth {
        phi_i_deg: light.phi_i_deg,
        gloss: gloss(&samples, &light),
        haze: haze(&samples, &light),
        scatter: scatter(&samples, &light),
        reflectance: reflectance(&samples, &light),
        ars: light
            .incidences
            .iter()
            .map(|&(theta_i_deg, incidence)| AngleResolved {
                theta_i_deg,
                angles: angle_resolved(&samples, &light, incidence),
            })
            .collect(),
    };
    Ok(Appearance {
        schema: SCHEMA,
        colours: samples.scale.words.clone(),
        realisations: samples.realisations(),
        azimuths: LightAzimuth::all(&table.grid).into_iter().take(most).map(at).collect(),
    })
}
