//! What Schlick's formula costs for a material whose index is known: over the angle at a facet, and in the very bins of
//! a table that was measured with Fresnel's equations.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use crate::campaign::{Campaign, FresnelLaw, Optics, Polarisation, RefractiveIndex, materials};
use crate::instrument::GridKind;
use crate::measure::optics::{fresnel_of, reflectances_of};
use crate::optics::fresnel::f_schlick;
use crate::optics::{FacetAngle, Fresnel};
use crate::sphere;
use crate::table::BrdfTable;

/// Steps from normal to grazing incidence.
const STEPS: u32 = 360;

/// The difference of Schlick's formula and Fresnel's equations, unpolarised.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SchlickError {
    /// Each colour by itself.
    pub colours: Vec<ColourError>,
    /// Each incidence of a table of order 1 that was measured with Fresnel's equations; empty for others.
    #[serde(rename = "stops")]
    pub incidences: Vec<IncidenceError>,
}

/// One colour over the angle at a facet.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ColourError {
    /// Its channel's name.
    pub colour: String,
    /// Reflectance at normal incidence.
    pub f0: f64,
    /// Schlick minus exact where they differ most.
    pub largest: f64,
    /// That angle, degrees.
    pub theta_d_deg: f64,
    /// Schlick minus exact under light from the whole hemisphere: weighed by 2 sin cos.
    pub hemispherical: f64,
}

/// One incidence, means of the colours.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct IncidenceError {
    /// The incidence.
    pub theta_i_deg: f64,
    /// The incidence.
    pub phi_i_deg: f64,
    /// Whether the bins fill the hemisphere, so that their flux is the albedo; an arm's apertures gather a part of it.
    pub whole: bool,
    /// Flux of order 1 into the bins as measured: with `whole` the albedo.
    pub albedo_exact: f64,
    /// The same paths with Schlick's formula.
    pub albedo_schlick: f64,
    /// Flux-weighted difference of the bins: sum |schlick - exact| w / sum exact w.
    pub l1: f64,
}

impl SchlickError {
    /// What is known for a table's material; `None` where its index is not.
    // Tested by `schlick_is_exact_at_normal_and_grazing_incidence_alone` (tests/it/measure/materials.rs).
    pub fn of(campaign: &Campaign, table: &BrdfTable) -> Option<Self> {
        let media = index_of(&campaign.optics)?;
        let names = table.colour_names();
        let colours = media.iter().zip(names).map(|(&exact, name)| of_colour(exact, name)).collect();
        Some(SchlickError { colours, incidences: of_incidences(campaign, table, &media) })
    }
}

impl SchlickError {
    /// Takes the incidences of the next band of a table.
    pub fn join(&mut self, next: SchlickError) {
        self.incidences.extend(next.incidences);
    }
}

/// Fresnel's equations for the colours of a material, in their order.
fn index_of(optics: &Optics) -> Option<Vec<Fresnel>> {
    match optics {
        Optics::Index(index) if matches!(index.polarisation, Polarisation::None | Polarisation::Mueller) => {
            Some(index.by_colour().into_iter().map(fresnel_of).collect())
        }
        Optics::Schlick { material: Some(name), .. } => {
            Some(materials::rgb_of(name)?.into_iter().map(fresnel_of).collect())
        }
        _ => None,
    }
}

fn of_colour(exact: Fresnel, colour: String) -> ColourError {
    let f0 = exact.f0();
    let (mut largest, mut theta_d_deg, mut mean) = (0.0f64, 0.0, 0.0);
    for step in 0..STEPS {
        let at = |place: f64| {
            let theta_deg = 90.0 * (f64::from(step) + place) / f64::from(STEPS);
            let (sin, cos) = sphere::sin_cos_deg(theta_deg);
            let angle = FacetAngle { cos, sin2: sin * sin };
            (theta_deg, sin * cos, f_schlick(angle, f0) - exact.reflectance(angle))
        };
        // The rule of midpoints: its error is far below what is printed.
        let (theta_deg, weight, difference) = at(0.5);
        mean += 2.0 * weight * difference * FRAC_PI_2 / f64::from(STEPS);
        if difference.abs() > largest.abs() {
            (largest, theta_d_deg) = (difference, theta_deg);
        }
    }
    ColourError { colour, f0, largest, theta_d_deg, hemispherical: mean }
}

/// The same paths with both, where the table holds both.
fn of_incidences(campaign: &Campaign, table: &BrdfTable, media: &[Fresnel]) -> Vec<IncidenceError> {
    let exact = matches!(&campaign.optics, Optics::Index(RefractiveIndex { law: FresnelLaw::Exact, .. }));
    let Some(sums) = table.schlick.as_ref().filter(|_| exact) else { return vec![] };
    debug_assert_eq!(reflectances_of(&campaign.optics).len(), media.len());
    let bins = table.grid.bins();
    let incidence = |incidence: usize| {
        let (theta_i_deg, phi_i_deg) = table.grid.incidence_deg(incidence);
        let regions = table.grid.regions(incidence);
        let count = media.len() as f64;
        let (mut albedo_exact, mut albedo_schlick, mut l1) = (0.0, 0.0, 0.0);
        for (medium, colour) in media.iter().zip(&table.colours) {
            let f0 = medium.f0();
            let (mut of_exact, mut of_schlick, mut distance) = (0.0, 0.0, 0.0);
            for (bin, region) in regions.iter().enumerate() {
                let (at, size) = (incidence * bins + bin, region.projected_solid_angle());
                let exact = f64::from(colour.single[at]);
                let schlick = f0 * f64::from(sums.unit[at]) + (1.0 - f0) * f64::from(sums.first[at]);
                of_exact += exact * size;
                of_schlick += schlick * size;
                distance += (schlick - exact).abs() * size;
            }
            albedo_exact += of_exact / count;
            albedo_schlick += of_schlick / count;
            l1 += if of_exact > 0.0 { distance / of_exact / count } else { 0.0 };
        }
        let whole = table.grid.kind != GridKind::Arm;
        IncidenceError { theta_i_deg, phi_i_deg, whole, albedo_exact, albedo_schlick, l1 }
    };
    (0..table.grid.incidences()).map(incidence).collect()
}
