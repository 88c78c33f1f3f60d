//! The means of a model over the bins of a table, those of an incidence that are alike worked out once.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::{IncidenceMeans, Means, Model};
use crate::campaign::{Azimuth, Campaign};
use crate::instrument::{AlikeBins, Grid, Region, SurfaceSymmetry};
use crate::measure::optics::reflectances_of;
use crate::optics::reflectance::Reflectance;
use crate::theory::empirical::LAMBERT;
use crate::theory::v_cavity::v_groove_lobes;
use crate::theory::{Masking, Microfacet};
use crate::validate::prediction::bin_mean::{MASKINGS, source_nodes};
use crate::validate::prediction::by_colour::{
    albedo_of, diffuse_means_by_colour, formula_means_by_colour, microfacet_means,
};
use crate::validate::prediction::layered;
use crate::validate::prediction::lobes::{bare_flux, lobe_means, mirrored, reflected, refracted};

/// Azimuths over which a model that is not isotropic is averaged (its period is half a turn): a trapezoid rule on a
/// smooth periodic function.
const AZIMUTHS: usize = 36;
/// Nodes along the radius of the light's aperture.
const APERTURE_ORDER: usize = 6;
/// The same for matt facets, whose values vary with the cosines alone.
const SMOOTH_APERTURE_ORDER: usize = 2;

impl Model {
    /// The means over the bins of every incidence, over the same bins and light aperture as the measurement.
    // Tested by `alike_bins_have_the_means_of_each_by_itself` (tests/it/validate/bin_means.rs).
    pub fn means(&self, campaign: &Campaign, grid: &Grid) -> Vec<IncidenceMeans> {
        let colours = reflectances_of(&campaign.optics);
        let averaged = campaign.light.azimuth == Azimuth::Relative && !campaign.is_isotropic();
        let light = IncidentLight { half_angle: campaign.light.aperture_deg.to_radians(), colours: &colours };
        let turns = if averaged { AZIMUTHS } else { 1 };
        let turned = |means: &dyn Fn(f64) -> Option<Means>| {
            let parts = (0..turns).filter_map(|k| means(PI * k as f64 / turns as f64));
            let mut values = parts.reduce(added)?;
            values.iter_mut().flatten().flatten().for_each(|value| *value /= turns as f64);
            Some(values)
        };
        let symmetry = self.symmetry(averaged);
        let of_incidence = |incidence: usize| {
            let smooth = symmetry.and_then(|symmetry| {
                let AlikeBins { regions, places } = AlikeBins::of(grid, incidence, symmetry);
                let means = turned(&|turn| self.smooth_means(turn, grid.wi(incidence), &regions, &light))?;
                Some(taken(&means, &places))
            });
            let sharp = turned(&|turn| self.sharp_means(turn, grid, incidence, &light));
            IncidenceMeans { values: smooth.into_iter().chain(sharp).reduce(added).unwrap_or_default() }
        };
        (0..grid.incidences()).into_par_iter().map(of_incidence).collect()
    }

    /// What the smooth means do not change under; `None` where there are none.
    fn symmetry(&self, averaged: bool) -> Option<SurfaceSymmetry> {
        let (Model::Microfacet { surface, .. } | Model::Diffuse { surface, .. }) = self else { return None };
        let turns = averaged || surface.is_isotropic();
        Some(if turns { SurfaceSymmetry::Isotropic } else { SurfaceSymmetry::Axes(surface.rotation) })
    }

    /// The means over `regions` of what is spread over all directions.
    fn smooth_means(&self, turn: f64, wi: DVec3, regions: &[Region], light: &IncidentLight) -> Option<Means> {
        let colours = light.colours;
        match self {
            Model::Microfacet { surface, maskings, .. } => {
                let surface = Microfacet { rotation: surface.rotation + turn, ..*surface };
                // As many maskings at a time as the cubature carries.
                let groups = maskings.chunks(MASKINGS);
                let means = |maskings| {
                    microfacet_means(&surface, maskings, &light.sharp_source(wi), regions, colours)
                };
                Some(groups.flat_map(means).collect())
            }
            Model::Diffuse { surface, maskings, formulas, interface } => {
                let surface = Microfacet { rotation: surface.rotation + turn, ..*surface };
                let source = light.smooth_source(wi);
                let by_colour = (colours, *interface);
                let mut means = diffuse_means_by_colour(&surface, maskings, &source, regions, by_colour);
                if let Some(interface) = *interface {
                    let source = light.sharp_source(wi);
                    layered::add_mirrored(&mut means, (&surface, maskings), &source, regions, interface);
                }
                if !formulas.is_empty() {
                    means.extend(formula_means_by_colour(&surface, &source, regions, colours));
                }
                Some(means)
            }
            Model::Lambert | Model::Flat(_) | Model::Lobes { .. } => None,
        }
    }

    /// The means over the bins of an incidence of what goes in single directions, or is flat.
    fn sharp_means(&self, turn: f64, grid: &Grid, incidence: usize, light: &IncidentLight) -> Option<Means> {
        let (source, colours) = (&light.sharp_source(grid.wi(incidence))[..], light.colours);
        let by_colour =
            |of: &dyn Fn(Reflectance) -> Vec<f64>| colours.iter().map(|&colour| of(colour)).collect();
        match self {
            Model::Microfacet { surface, maskings, mirror_base: true } => {
                let surface = Microfacet { rotation: surface.rotation + turn, ..*surface };
                let of_masking = |&masking: &Masking| {
                    by_colour(&|colour| {
                        let bare =
                            |wi| reflected(wi, [(mirrored(wi), bare_flux(&surface, masking, wi))], colour);
                        lobe_means(bare, grid, incidence, source)
                    })
                };
                Some(maskings.iter().map(of_masking).collect())
            }
            Model::Microfacet { .. } | Model::Diffuse { .. } => None,
            Model::Flat(interface) => {
                Some(vec![layered::flat_means(grid, incidence, source, colours, *interface)])
            }
            Model::Lambert => {
                Some(vec![by_colour(&|colour| vec![albedo_of(&colour) * LAMBERT; grid.bins()])])
            }
            Model::Lobes { slope, rotation, .. } => Some(vec![by_colour(&|colour| {
                let lobes = |wi| match slope {
                    None => {
                        let mut both = reflected(wi, [(mirrored(wi), 1.0)], colour);
                        both.extend(refracted(wi, colour).filter(|_| grid.looks_below()));
                        both
                    }
                    Some(slope) => {
                        let lobes = v_groove_lobes(*slope, rotation + turn, wi);
                        reflected(wi, lobes.iter().map(|lobe| (lobe.wo, lobe.flux)), colour)
                    }
                };
                lobe_means(lobes, grid, incidence, source)
            })]),
        }
    }
}

/// What falls on the surface.
struct IncidentLight<'a> {
    /// Of its aperture.
    half_angle: f64,
    colours: &'a [Reflectance],
}

impl IncidentLight<'_> {
    fn sharp_source(&self, wi: DVec3) -> Vec<(DVec3, f64)> {
        source_nodes(wi, self.half_angle, APERTURE_ORDER)
    }

    /// For what varies with cosines alone.
    fn smooth_source(&self, wi: DVec3) -> Vec<(DVec3, f64)> {
        source_nodes(wi, self.half_angle, SMOOTH_APERTURE_ORDER)
    }
}

/// The values at these places of each list.
fn taken(means: &Means, places: &[usize]) -> Means {
    let of = |values: &Vec<f64>| places.iter().map(|&place| values[place]).collect();
    means.iter().map(|colours| colours.iter().map(of).collect()).collect()
}

fn added(mut sum: Means, part: Means) -> Means {
    let values = sum.iter_mut().flatten().flatten().zip(part.iter().flatten().flatten());
    values.for_each(|(sum, part)| *sum += part);
    sum
}
