//! Where geometric optics holds for what a campaign measures: the figures of `optics::wave_limits`, incidence by incidence.

use serde::{Deserialize, Serialize};

use crate::campaign::{Campaign, Dielectric, LightSide, Medium, Optics};
use crate::instrument::Grid;
use crate::measure::Patches;
use crate::optics::wave_limits::{
    FRAUNHOFER, KIRCHHOFF, RAYLEIGH, coherent_part, kirchhoff, phase, rayleigh,
};
use crate::surface::SurfaceLengths;

/// What is known of the limits of rays at the longest wavelength of a table. Lengths are null where they are not known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GeometricOptics {
    /// Why nothing is known, and what to add; null where something is.
    pub not_known: Option<String>,
    /// The longest wavelength, nm, in the medium that the light comes from.
    pub wavelength_nm: Option<f64>,
    /// Root mean square height of the surface, um.
    pub rms_height_um: Option<f64>,
    /// Width of a cell, um, and over the wavelength.
    pub pitch_um: Option<f64>,
    /// Width of a cell over the wavelength.
    pub pitch_over_wavelength: Option<f64>,
    /// Correlation length over the wavelength.
    pub correlation_over_wavelength: Option<f64>,
    /// Mean radius of curvature, um.
    pub curvature_radius_um: Option<f64>,
    /// Each polar angle of the light.
    pub incidences: Vec<GeometricIncidence>,
    /// How many of them have a figure below its limit.
    pub doubtful_incidences: usize,
    /// Of the pairs of incidence and bin on the light's side, the share whose phase is below Rayleigh's limit.
    pub doubtful_bins: Option<f64>,
}

/// The figures at one polar angle of the light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GeometricIncidence {
    /// The angle.
    pub theta_i_deg: f64,
    /// 4 pi sigma cos(theta_i)/lambda, rad; smooth below pi/2.
    pub rayleigh: f64,
    /// Part of the reflected light that stays in step, exp(-rayleigh^2).
    pub coherent: f64,
    /// 4 pi r cos(theta_i)/lambda, which must be large: 10. Null where nothing is curved.
    pub kirchhoff: Option<f64>,
    /// Share of the bins whose 2 pi sigma (cos(theta_i) + cos(theta_r))/lambda is below pi/2.
    pub doubtful_bins: f64,
}

impl GeometricIncidence {
    /// Whether one of the figures is below its limit.
    pub fn is_doubtful(&self) -> bool {
        self.is_smooth() || self.is_curved()
    }

    fn is_smooth(&self) -> bool {
        self.rayleigh < RAYLEIGH
    }

    fn is_curved(&self) -> bool {
        self.kirchhoff.is_some_and(|figure| figure < KIRCHHOFF)
    }
}

impl GeometricOptics {
    /// Of a campaign for its first roughness and material, and the grid of its table.
    // Tested by `the_figures_of_a_campaign_are_closed_forms` (tests/it/validate/wave_limits.rs).
    pub fn of(campaign: &Campaign, grid: &Grid) -> Self {
        Self::known(campaign, grid).unwrap_or_else(|why| GeometricOptics {
            not_known: Some(why),
            wavelength_nm: None,
            rms_height_um: None,
            pitch_um: None,
            pitch_over_wavelength: None,
            correlation_over_wavelength: None,
            curvature_radius_um: None,
            incidences: vec![],
            doubtful_incidences: 0,
            doubtful_bins: None,
        })
    }

    fn known(campaign: &Campaign, grid: &Grid) -> Result<Self, String> {
        let nm = wavelength_nm(campaign);
        if nm.is_none() && campaign.surface.kind.has_own_correlation() && campaign.scale.pitch_um.is_none() {
            return Err(
                "neither cells nor light have a length: add [scale] with pitch_um and wavelength_nm".into()
            );
        }
        if matches!(campaign.optics.each()[0], Optics::Diffuse { .. }) {
            return Err("matt facets scatter by themselves: heights decide nothing".into());
        }
        let nm = nm.ok_or("the light has no wavelength: add [scale] with wavelength_nm")?;
        let (law, alpha) = (Patches::law(campaign), campaign.alphas()[0]);
        let lengths = SurfaceLengths::of(&campaign.surface, law, alpha, campaign.scale.pitch_um)?;
        let um = 1e-3 * nm;
        let bins: Vec<f64> =
            grid.regions(0).iter().map(|region| region.middle().z).filter(|z| *z > 0.0).collect();
        let of_angle = |&theta_i_deg: &f64| {
            let cos_i = theta_i_deg.to_radians().cos();
            let smooth =
                bins.iter().filter(|cos_r| phase(lengths.rms_height_um, cos_i, **cos_r, um) < RAYLEIGH);
            let g = rayleigh(lengths.rms_height_um, cos_i, um);
            let radius = Some(lengths.curvature_radius_um).filter(|radius| radius.is_finite());
            GeometricIncidence {
                theta_i_deg,
                rayleigh: g,
                coherent: coherent_part(g),
                kirchhoff: radius.map(|radius| kirchhoff(radius, cos_i, um)),
                doubtful_bins: if bins.is_empty() { 0.0 } else { smooth.count() as f64 / bins.len() as f64 },
            }
        };
        let incidences: Vec<GeometricIncidence> = campaign.light.theta_i_deg.iter().map(of_angle).collect();
        let shares: Vec<f64> = incidences.iter().map(|incidence| incidence.doubtful_bins).collect();
        Ok(GeometricOptics {
            not_known: None,
            wavelength_nm: Some(nm),
            rms_height_um: Some(lengths.rms_height_um),
            pitch_um: Some(lengths.pitch_um),
            pitch_over_wavelength: Some(lengths.pitch_um / um),
            correlation_over_wavelength: lengths.correlation_um.map(|length| length / um),
            curvature_radius_um: Some(lengths.curvature_radius_um).filter(|radius| radius.is_finite()),
            doubtful_incidences: incidences.iter().filter(|incidence| incidence.is_doubtful()).count(),
            doubtful_bins: (!bins.is_empty()).then(|| crate::stats::mean(&shares)),
            incidences,
        })
    }

    /// Whether something is below its limit.
    pub fn is_doubtful(&self) -> bool {
        self.doubtful_incidences > 0 || self.doubtful_bins.is_some_and(|share| share > 0.0)
    }

    /// In a sentence without its full stop, where something is known: whether it holds, and where it does not.
    pub fn words(&self) -> Option<String> {
        let (nm, rms) = (self.wavelength_nm?, self.rms_height_um?);
        let of = format!("rms height {} um at {} nm", digits(rms), digits(nm));
        if !self.is_doubtful() {
            return Some(format!("geometric optics holds here ({of})"));
        }
        let all = self.incidences.len();
        let mut why = Vec::new();
        let count =
            |below: &dyn Fn(&GeometricIncidence) -> bool| self.incidences.iter().filter(|i| below(i)).count();
        let (smooth, curved) = (count(&GeometricIncidence::is_smooth), count(&GeometricIncidence::is_curved));
        if smooth > 0 {
            let mirror = match count(&|incidence| incidence.rayleigh < FRAUNHOFER) {
                0 => String::new(),
                mirrors => format!(", at {mirrors} it is as good as a mirror (below pi/8)"),
            };
            why.push(format!(
                "at {smooth} of {all} theta_i the surface is smooth by Rayleigh (4 pi sigma cos/lambda below pi/2){mirror}"
            ));
        }
        if let Some(share) = self.doubtful_bins.filter(|share| *share > 0.0) {
            why.push(format!("in {} of the bins both arms see it smooth", percent(share)));
        }
        if curved > 0 {
            why.push(format!(
                "at {curved} of {all} theta_i 4 pi r cos/lambda is below 10 (r: radius of curvature)"
            ));
        }
        Some(format!("geometric optics is doubtful here: {} ({of})", why.join("; ")))
    }
}

/// The longest wavelength in nm, in the medium that the light comes from.
fn wavelength_nm(campaign: &Campaign) -> Option<f64> {
    let optics = campaign.optics.each()[0];
    let back = matches!(optics, Optics::Dielectric(Dielectric { light: LightSide::Back, .. }));
    let index = |medium: &Medium| if back { medium.eta } else { 1.0 };
    let media = optics.media();
    let own = media.iter().filter_map(|medium| Some(medium.wavelength_nm? / index(medium))).reduce(f64::max);
    own.or_else(|| Some(campaign.scale.wavelength_nm? / media.first().map_or(1.0, index)))
}

/// Three digits that count.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

/// A share, as small as it may be.
fn percent(share: f64) -> String {
    if share < 0.001 { "less than 0.1 %".into() } else { format!("{:.1} %", 100.0 * share) }
}
