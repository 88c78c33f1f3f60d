//! What is measured for a table of albedos: the campaign with the axes in place of its own light, roughness and material.

use super::table::Axes;
use crate::campaign::{
    Alpha, Azimuth, BinLayout, Campaign, Dielectric, LightArm, LightSide, Medium, Optics, Polarisation,
    SensorArm, SensorSide, SurfaceKind,
};
use crate::error::{Error, Result};
use crate::sphere;

/// What is measured for a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// The campaign that is measured: the coarsest sensor, every light and material of the table.
    pub campaign: Campaign,
    /// Where the cells are.
    pub axes: Axes,
    /// Sides of clear facets; none of mirrors.
    pub sides: Vec<LightSide>,
    /// The campaign as it was given.
    pub(super) base: Campaign,
    /// What is not as the user may think.
    pub notes: Vec<String>,
}

/// What takes the place of the campaign's own lights and roughnesses, where it is given.
#[derive(Debug, Clone, Default)]
pub struct Chosen {
    /// Cosines of the light's polar angle.
    pub mu: Option<Vec<f64>>,
    /// Roughnesses.
    pub alpha: Option<Vec<f64>>,
    /// Indices of the inside over the outside.
    pub eta: Option<Vec<f64>>,
}

/// The campaign whose light, roughnesses and indices are those of the table, with F = 1 and with F0 = 0 on mirror facets.
///
/// Errors: `Usage` where the surface has no such axis.
pub fn campaign_of(base: &Campaign, chosen: Chosen) -> Result<Setup> {
    let mut notes = Vec::new();
    let mut campaign = base.clone();
    let alpha = roughnesses(&mut campaign, chosen.alpha)?;
    if let Some(brushed) = campaign.alphas()[0].filter(|alpha| alpha.x != alpha.y) {
        notes.push(format!(
            "alpha is that along x, {} along y; a table is of light from every azimuth",
            brushed.y
        ));
    }
    let (sides, eta) = match base.optics.each()[0] {
        Optics::Dielectric(_) => {
            (base.optics.light_sides(), chosen.eta.unwrap_or_else(|| etas(&base.optics)))
        }
        facet @ (Optics::Diffuse { .. } | Optics::Layered { .. }) => {
            let word = if matches!(facet, Optics::Diffuse { .. }) { "diffuse" } else { "layered" };
            return Err(Error::Usage(format!(
                "{}: optics.facet = \"{word}\": albedo tables are of mirror and of clear facets",
                base.name
            )));
        }
        _ if chosen.eta.is_some() => {
            return Err(Error::Usage(format!(
                "--eta: facets of {} are mirrors; it belongs to facet = \"dielectric\" under [optics]",
                base.name
            )));
        }
        mirror => {
            if *mirror != Optics::PerfectMirror {
                notes.push(
                    "the material is left out: the table holds F = 1 and, at order 1, the parts of F0 and F90".into(),
                );
            }
            (vec![], vec![])
        }
    };
    campaign.optics = if sides.is_empty() { white_and_edge() } else { glasses(&eta, &sides) };
    let own = || base.light.theta_i_deg.iter().rev().map(|&theta| sphere::sin_cos_deg(theta).1).collect();
    let mut mu: Vec<f64> = chosen.mu.unwrap_or_else(own);
    // Two angles next to 0 may have one cosine.
    mu.dedup();
    if base.light.aperture_deg > 0.0 {
        notes.push("light.aperture_deg is left out: a table is of light from single directions".into());
    }
    campaign.light = LightArm {
        theta_i_deg: mu.iter().rev().map(|mu| mu.acos().to_degrees()).collect(),
        azimuth: Azimuth::Relative,
        average_azimuth: true,
        aperture_deg: 0.0,
    };
    let side = if sides.is_empty() { SensorSide::Reflection } else { SensorSide::Both };
    campaign.sensor =
        SensorArm::Hemisphere { side, theta_r_bins: 1, phi_r_bins: 1, bins: BinLayout::Aligned };
    campaign.trace.by_order = false;
    Ok(Setup { campaign, axes: Axes { mu, alpha, eta }, sides, base: base.clone(), notes })
}

/// The roughnesses of the table, which become the campaign's.
fn roughnesses(campaign: &mut Campaign, chosen: Option<Vec<f64>>) -> Result<Vec<f64>> {
    let name = campaign.name.clone();
    let kind = campaign.surface.kind.name();
    let of_one_number =
        !matches!(campaign.surface.kind, SurfaceKind::BlinnPhong { .. } | SurfaceKind::Psd(_));
    let Some(alphas) = campaign.surface.kind.alphas_mut().filter(|_| of_one_number || chosen.is_none())
    else {
        return match chosen {
            None => Ok(vec![0.0]),
            Some(_) => Err(Error::Usage(format!(
                "--alpha: [surface.{kind}] of {name} has no roughness to be chosen; leave it out"
            ))),
        };
    };
    let coverage = alphas[0].coverage;
    if alphas.iter().any(|alpha| alpha.coverage != coverage) {
        return Err(Error::Usage(format!(
            "{name}: surface.grains.coverage: a table has one coverage; make one of each"
        )));
    }
    if let Some(chosen) = chosen {
        *alphas = chosen.into_iter().map(|alpha| Alpha { coverage, ..Alpha::isotropic(alpha) }).collect();
    }
    Ok(alphas.iter().map(|alpha| alpha.x).collect())
}

/// The indices of a campaign's clear materials, increasing.
fn etas(optics: &Optics) -> Vec<f64> {
    let media = |one: &Optics| if let Optics::Dielectric(clear) = one { clear.media.clone() } else { vec![] };
    let mut etas: Vec<f64> = optics.each().into_iter().flat_map(media).map(|medium| medium.eta).collect();
    etas.sort_by(f64::total_cmp);
    etas.dedup();
    etas
}

/// Schlick's formula with F0 = 1 and with F0 = 0, from the same paths.
fn white_and_edge() -> Optics {
    Optics::Several([1.0, 0.0].map(|f0| Optics::Schlick { material: None, f0: [f0; 3] }).to_vec())
}

/// Every index from every side.
fn glasses(etas: &[f64], sides: &[LightSide]) -> Optics {
    let glass = |eta: f64, light: LightSide| {
        Optics::Dielectric(Dielectric {
            material: None,
            media: vec![Medium { wavelength_nm: None, eta, k: 0.0 }],
            light,
            polarisation: Polarisation::None,
        })
    };
    Optics::Several(etas.iter().flat_map(|&eta| sides.iter().map(move |&side| glass(eta, side))).collect())
}
