//! The analytic answer to a campaign: which models speak of its surface, and their means over the table's bins.

use std::f64::consts::PI;

use glam::DVec3;

use super::bin_mean::{BinMean, BinMeans, MASKINGS, source_nodes};
use crate::campaign::{Azimuth, Campaign, SmithNdf, SurfaceKind};
use crate::instrument::{Grid, Region, Sensor};
use crate::measure::optics::reflectances_of;
use crate::optics::reflectance::Reflectance;
use crate::optics::{FacetAngle, Fresnel};
use crate::sphere;
use crate::theory::grains::bare_mirror_flux;
use crate::theory::smith::visibility;
use crate::theory::v_cavity::v_groove_lobes;
use crate::theory::{Masking, Microfacet, Ndf};

/// Azimuths over which a model that is not isotropic is averaged (its period is half a turn): a trapezoid rule on a
/// smooth periodic function.
const AZIMUTHS: usize = 36;
/// Nodes along the radius of the light's aperture.
const APERTURE_ORDER: usize = 6;

/// What theory says about a surface.
#[derive(Clone)]
pub enum Model {
    /// D G2 F/(4 cos cos) with each of the maskings.
    Microfacet {
        /// The surface.
        surface: Microfacet,
        /// In the order of the comparisons.
        maskings: Vec<Masking>,
        /// Whether a plane between grains reflects as well.
        mirror_base: bool,
    },
    /// Mirror directions that carry all the flux.
    Lobes {
        /// The model's name.
        name: &'static str,
        /// The masking's name.
        masking: &'static str,
        /// V-groove slope; `None` for a flat mirror.
        slope: Option<f64>,
        /// The sample's turn.
        rotation: f64,
    },
}

/// The law of a surface's normals; `None` of a mirror, of grooves, and of a measured map.
pub fn ndf_of(kind: &SurfaceKind) -> Option<Ndf> {
    match kind {
        SurfaceKind::Ggx(_) => Some(Ndf::Ggx),
        SurfaceKind::Beckmann { .. } => Some(Ndf::Beckmann),
        SurfaceKind::StudentT { gamma, .. } => Some(Ndf::StudentT { gamma: *gamma }),
        SurfaceKind::BlinnPhong { .. } => Some(Ndf::BlinnPhong),
        SurfaceKind::Smith(smith) if smith.ndf == SmithNdf::Ggx => Some(Ndf::Ggx),
        SurfaceKind::Smith(_) => Some(Ndf::Beckmann),
        SurfaceKind::Grains(grains) => Some(Ndf::Grains { coverage: grains.alphas[0].coverage? }),
        SurfaceKind::Mirror | SurfaceKind::VGroove { .. } | SurfaceKind::File(_) => None,
    }
}

/// One model's means over the bins of one stop.
pub struct StopMeans {
    /// \[masking\]\[colour\]\[bin\], 1/sr.
    pub values: Vec<Vec<Vec<f64>>>,
}

impl Model {
    /// The models of a campaign; `None` where theory has nothing to say (a measured map).
    pub fn of(campaign: &Campaign) -> Option<Self> {
        let rotation = campaign.surface.rotation_deg.to_radians();
        let lobes = |name, masking, slope| Some(Model::Lobes { name, masking, slope, rotation });
        match &campaign.surface.kind {
            SurfaceKind::Mirror => lobes("mirror", "none", None),
            SurfaceKind::VGroove { slope } => lobes("torrance_sparrow", "v_cavity", Some(*slope)),
            kind => {
                let (ndf, alpha) = (ndf_of(kind)?, campaign.alphas()[0]?);
                let surface = Microfacet { ndf, alpha_x: alpha.x, alpha_y: alpha.y, rotation };
                let mut maskings =
                    if campaign.trace.visibility { &Masking::ALL[1..] } else { &Masking::ALL[..1] }.to_vec();
                let grains = matches!(kind, SurfaceKind::Grains(_));
                if grains && campaign.trace.visibility {
                    maskings.splice(0..0, [Masking::Grains, Masking::GrainsProduct]);
                }
                // Among the slopes of heights is the plane's as well.
                let mirror_base = grains && !kind.has_absorbing_base();
                Some(Model::Microfacet { surface, maskings, mirror_base })
            }
        }
    }

    /// The model's name in the summary.
    pub fn name(&self) -> &'static str {
        match self {
            Model::Microfacet { surface, .. } => surface.ndf.name(),
            Model::Lobes { name, .. } => name,
        }
    }

    /// Names of the maskings, in the order of `StopMeans::values`.
    pub fn maskings(&self) -> Vec<&'static str> {
        match self {
            Model::Microfacet { maskings, .. } => maskings.iter().map(|masking| masking.name()).collect(),
            Model::Lobes { masking, .. } => vec![masking],
        }
    }

    /// The place of the masking of this name, 0 where there is none.
    pub fn masking_index(&self, wanted: Option<&str>) -> usize {
        self.maskings().iter().position(|name| Some(*name) == wanted).unwrap_or(0)
    }

    /// What Smith's model says of the light: its masking G1, the same for every facet that is turned to it, and the
    /// slope along its azimuth from which on facets are turned away, units of alpha (infinite along the normal).
    ///
    /// With s = hypot(alpha_x w.x, alpha_y w.y): w.m >= 0 where the slope is at most w.z/s. `None` for other models, for
    /// a surface without shadows, and (`averaged`) where an anisotropic one is averaged over the azimuth. `wi`: unit
    /// vector, stage's frame.
    // Tested by `smith_masks_all_facets_alike_up_to_a_slope`.
    pub fn smith(&self, wi: DVec3, averaged: bool) -> Option<[f64; 2]> {
        let Model::Microfacet { surface, maskings, .. } = self else { return None };
        let smith = !maskings.contains(&Masking::None) && !matches!(surface.ndf, Ndf::Grains { .. });
        if (averaged && !surface.is_isotropic()) || !smith {
            return None;
        }
        let w = surface.to_sample(wi);
        let along = (surface.alpha_x * w.x).hypot(surface.alpha_y * w.y);
        Some([surface.side(w).g1(), w.z / along])
    }

    /// The means over the bins of one stop, over the same bins and light aperture as the measurement.
    pub fn means(&self, campaign: &Campaign, grid: &Grid, stop: usize) -> StopMeans {
        let half_angle = campaign.light.aperture_deg.to_radians();
        let source = source_nodes(grid.wi(stop), half_angle, APERTURE_ORDER);
        let colours = reflectances_of(&campaign.optics);
        let averaged = campaign.light.azimuth == Azimuth::Relative && !campaign.is_isotropic();
        let turns = if averaged { AZIMUTHS } else { 1 };
        let rotations = (0..turns).map(|k| PI * k as f64 / turns as f64);
        let parts = rotations.map(|rotation| self.turned_means(rotation, grid, stop, &source, &colours));
        let mut values = parts.reduce(added).unwrap_or_default();
        values.iter_mut().flatten().flatten().for_each(|value| *value /= turns as f64);
        StopMeans { values }
    }

    fn turned_means(
        &self,
        turn: f64,
        grid: &Grid,
        stop: usize,
        source: &[(DVec3, f64)],
        colours: &[Reflectance],
    ) -> Vec<Vec<Vec<f64>>> {
        match self {
            Model::Microfacet { surface, maskings, mirror_base } => {
                let surface = Microfacet { rotation: surface.rotation + turn, ..*surface };
                let regions = grid.regions(stop);
                // As many maskings at a time as the cubature carries.
                let groups = maskings.chunks(MASKINGS);
                let mut means: Vec<Vec<Vec<f64>>> = groups
                    .flat_map(|maskings| microfacet_means(&surface, maskings, source, &regions, colours))
                    .collect();
                for (&masking, by_colour) in maskings.iter().zip(&mut means).filter(|_| *mirror_base) {
                    let bare = |wi: DVec3| vec![(mirrored(wi), bare_flux(&surface, masking, wi))];
                    for (values, &colour) in by_colour.iter_mut().zip(colours) {
                        let lobes = lobe_means(bare, grid, stop, source, colour);
                        values.iter_mut().zip(lobes).for_each(|(value, lobe)| *value += lobe);
                    }
                }
                means
            }
            Model::Lobes { slope, rotation, .. } => {
                let lobes = |wi: DVec3| match slope {
                    None => vec![(mirrored(wi), 1.0)],
                    Some(slope) => {
                        let lobes = v_groove_lobes(*slope, rotation + turn, wi);
                        lobes.iter().map(|lobe| (lobe.wo, lobe.flux)).collect()
                    }
                };
                vec![colours.iter().map(|&colour| lobe_means(lobes, grid, stop, source, colour)).collect()]
            }
        }
    }
}

/// The means of at most `MASKINGS` maskings: \[masking\]\[colour\]\[bin\].
fn microfacet_means(
    surface: &Microfacet,
    maskings: &[Masking],
    source: &[(DVec3, f64)],
    regions: &[Region],
    colours: &[Reflectance],
) -> Vec<Vec<Vec<f64>>> {
    let means = BinMeans::new(maskings.to_vec());
    let schlick = means.evaluate(surface, source, regions);
    let of_colour = |colour: &Reflectance| -> Vec<Vec<f64>> {
        let of = |value: &dyn Fn(usize, &BinMean) -> f64, bins: &[BinMean]| {
            (0..maskings.len()).map(|k| bins.iter().map(|bin| value(k, bin)).collect()).collect()
        };
        match *colour {
            Reflectance { fresnel: Fresnel::Perfect, .. } => of(&|k, bin| bin.unit[k], &schlick),
            Reflectance { fresnel: Fresnel::Schlick { f0 }, .. } => {
                of(&|k, bin| bin.with_f0(k, f0), &schlick)
            }
            exact => {
                let means = BinMeans { reflectance: Some(exact), ..means.clone() };
                of(&|k, bin| bin.schlick[k], &means.evaluate(surface, source, regions))
            }
        }
    };
    let by_colour: Vec<Vec<Vec<f64>>> = colours.iter().map(of_colour).collect();
    let of_masking = |k: usize| by_colour.iter().map(|maskings| maskings[k].clone()).collect();
    (0..maskings.len()).map(of_masking).collect()
}

/// The share of the light from `wi` (stage's frame) that the bare plane between grains sends into the mirror direction,
/// as each masking has it: Smith's take the plane for facets of the whole surface.
fn bare_flux(surface: &Microfacet, masking: Masking, wi: DVec3) -> f64 {
    let Ndf::Grains { coverage } = surface.ndf else { return 0.0 };
    let [i, o] = [wi, mirrored(wi)].map(|w| surface.side(surface.to_sample(w)));
    match masking {
        Masking::None => 1.0 - coverage,
        Masking::Grains | Masking::GrainsProduct => bare_mirror_flux(i.canonical(), coverage),
        smith => (1.0 - coverage) * 4.0 * i.cos * o.cos * visibility(smith, &i, &o),
    }
}

fn mirrored(w: DVec3) -> DVec3 {
    DVec3::new(-w.x, -w.y, w.z)
}

/// The flux of each direction that `lobes` gives for the light's, over the bin that holds it.
fn lobe_means(
    lobes: impl Fn(DVec3) -> Vec<(DVec3, f64)>,
    grid: &Grid,
    stop: usize,
    source: &[(DVec3, f64)],
    colour: Reflectance,
) -> Vec<f64> {
    let sensor = Sensor::new(grid);
    let regions = grid.regions(stop);
    let turn_back = if grid.phi_r_relative { -grid.stop_deg(stop).1 } else { 0.0 };
    let mut means = vec![0.0; regions.len()];
    for &(wi, weight) in source {
        for (wo, flux) in lobes(wi).into_iter().filter(|&(wo, flux)| flux > 0.0 && wo.z > 0.0) {
            let fresnel = colour.at(FacetAngle::of_pair(wi, wo));
            sensor.each_bin(sphere::turned(wo, sphere::sin_cos_deg(turn_back)), |bin| {
                means[bin] += weight * flux * fresnel / regions[bin].projected_solid_angle();
            });
        }
    }
    means
}

fn added(mut sum: Vec<Vec<Vec<f64>>>, part: Vec<Vec<Vec<f64>>>) -> Vec<Vec<Vec<f64>>> {
    let values = sum.iter_mut().flatten().flatten().zip(part.iter().flatten().flatten());
    values.for_each(|(sum, part)| *sum += part);
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smith_masks_all_facets_alike_up_to_a_slope() {
        let wi = sphere::direction_deg(60.0, 90.0);
        let surface = Microfacet { ndf: Ndf::Ggx, alpha_x: 0.1, alpha_y: 0.5, rotation: 0.0 };
        let model = Model::Microfacet { surface, maskings: vec![Masking::Separable], mirror_base: false };
        // GGX along y: G1 = 2/(1 + sqrt(1 + 0.5^2 tan^2 60)), facets turned away from cot 60/0.5 on; a few ulp.
        let [g1, steepest] = model.smith(wi, false).expect("Smith's");
        assert!((g1 - 2.0 / (1.0 + 1.75f64.sqrt())).abs() < 1e-14, "{g1}");
        assert!((steepest - 2.0 / 3f64.sqrt()).abs() < 1e-14, "{steepest}");
        assert!(model.smith(wi, true).is_none());
    }
}
