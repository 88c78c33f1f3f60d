//! Surfaces of layered facets: what their interfaces mirror, and flat ones.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::bin_mean::MAX_RECTANGLES;
use super::by_colour::{albedo_of, microfacet_means};
use super::chart::{DirectionChart, FluxDensity, integrate_region};
use super::lobes::{lobe_means, mirrored, reflected};
use super::quadrature::{COMPONENTS, Components, Precision};
use crate::instrument::{Grid, Region};
use crate::optics::Fresnel;
use crate::optics::layered::Interface;
use crate::optics::reflectance::Reflectance;
use crate::theory::{Masking, Microfacet, Ndf};

fn mirror_of(interface: Interface) -> Reflectance {
    Reflectance::unpolarised(Fresnel::Dielectric { eta: interface.eta })
}

/// Adds what the facets' interfaces mirror, the same in every colour, to `means`: \[masking\]\[colour\]\[bin\].
pub(super) fn add_mirrored(
    means: &mut [Vec<Vec<f64>>],
    (surface, maskings): (&Microfacet, &[Masking]),
    source: &[(DVec3, f64)],
    regions: &[Region],
    interface: Interface,
) {
    let mirror = microfacet_means(surface, maskings, source, regions, &[mirror_of(interface)]);
    for (by_colour, mirror) in means.iter_mut().zip(mirror) {
        for values in by_colour {
            values.iter_mut().zip(&mirror[0]).for_each(|(value, mirror)| *value += mirror);
        }
    }
}

/// The means of a flat surface over the bins of one incidence: \[colour\]\[bin\].
// Tested by `a_flat_layered_surface_meets_its_closed_form` (tests/it/facets/layered.rs).
pub(super) fn flat_means(
    grid: &Grid,
    incidence: usize,
    source: &[(DVec3, f64)],
    colours: &[Reflectance],
    interface: Interface,
) -> Vec<Vec<f64>> {
    let lobe = |wi| reflected(wi, [(mirrored(wi), 1.0)], mirror_of(interface));
    let mirror = lobe_means(lobe, grid, incidence, source);
    let base: Vec<f64> =
        grid.regions(incidence).iter().map(|region| base_mean(region, source, interface)).collect();
    let of = |colour: &Reflectance| {
        mirror.iter().zip(&base).map(|(mirror, base)| mirror + albedo_of(colour) * base).collect()
    };
    colours.iter().map(of).collect()
}

/// The mean over a region of what the base of a flat surface sends there, for a base that loses nothing, 1/sr.
fn base_mean(region: &Region, source: &[(DVec3, f64)], interface: Interface) -> f64 {
    let precision = Precision { relative: [1e-8; COMPONENTS], absolute: 0.0, max_rectangles: MAX_RECTANGLES };
    // Every azimuth is alike: any surface without a turn will do.
    let flat = Microfacet::isotropic(Ndf::Ggx, 1.0);
    let of = |&(wi, weight): &(DVec3, f64)| {
        let density = FlatBase { cos_i: wi.z, interface };
        let (flux, size) = match *region {
            Region::Cap { axis, half_angle: 0.0 } => (density.densities(axis), axis.z),
            _ => {
                let chart = DirectionChart::of_region(&flat, wi, region, None);
                (integrate_region(&density, &chart, &precision).value, region.projected_solid_angle())
            }
        };
        weight * flux[0] / size
    };
    source.iter().map(of).sum()
}

struct FlatBase {
    cos_i: f64,
    interface: Interface,
}

impl FluxDensity for FlatBase {
    fn densities(&self, wo: DVec3) -> Components {
        [FRAC_1_PI * self.interface.weight(self.cos_i, wo.z) * wo.z; COMPONENTS]
    }

    /// Nothing is narrow.
    fn feature(&self, _: DVec3) -> [f64; 2] {
        [0.0, 0.0]
    }
}
