//! Models that send light into single directions: their flux over the bins that hold them.

use glam::DVec3;

use crate::instrument::{Grid, Sensor};
use crate::optics::facet::split;
use crate::optics::reflectance::Reflectance;
use crate::optics::{FacetAngle, Fresnel};
use crate::sphere;
use crate::theory::grains::bare_mirror_flux;
use crate::theory::smith::visibility;
use crate::theory::{Masking, Microfacet, Ndf};

/// A direction and the share of the incident flux that goes there.
pub(super) type Lobe = (DVec3, f64);

/// The mirror direction of a plane.
pub(super) fn mirrored(w: DVec3) -> DVec3 {
    DVec3::new(-w.x, -w.y, w.z)
}

/// What mirrors of a material leave of the flux that perfect ones send above the horizon.
pub(super) fn reflected(wi: DVec3, lobes: impl IntoIterator<Item = Lobe>, colour: Reflectance) -> Vec<Lobe> {
    let above = lobes.into_iter().filter(|&(wo, flux)| flux > 0.0 && wo.z > 0.0);
    above.map(|(wo, flux)| (wo, flux * colour.at(FacetAngle::of_pair(wi, wo)))).collect()
}

/// Where a flat clear surface sends what it does not reflect; nothing in total reflection, or of another material.
// Tested by `a_flat_clear_surface_refracts` (tests/it/validate/transmittance.rs).
pub(super) fn refracted(wi: DVec3, colour: Reflectance) -> Option<Lobe> {
    let Fresnel::Dielectric { eta } = colour.fresnel else { return None };
    let split = split(wi, DVec3::Z, eta);
    split.refracted.map(|wo| (wo, 1.0 - split.reflectance))
}

/// The share of the light from `wi` (stage's frame) that the bare plane between grains sends into the mirror direction,
/// as each masking has it: Smith's take the plane for facets of the whole surface.
pub(super) fn bare_flux(surface: &Microfacet, masking: Masking, wi: DVec3) -> f64 {
    let Ndf::Grains { coverage } = surface.ndf else { return 0.0 };
    let [i, o] = [wi, mirrored(wi)].map(|w| surface.side(surface.to_sample(w)));
    match masking {
        Masking::None => 1.0 - coverage,
        Masking::Grains | Masking::GrainsProduct => bare_mirror_flux(i.canonical(), coverage),
        smith => (1.0 - coverage) * 4.0 * i.cos * o.cos * visibility(smith, &i, &o),
    }
}

/// The flux of each direction that `lobes` gives for the light's, over the bin that holds it.
pub(super) fn lobe_means(
    lobes: impl Fn(DVec3) -> Vec<Lobe>,
    grid: &Grid,
    incidence: usize,
    source: &[(DVec3, f64)],
) -> Vec<f64> {
    let sensor = Sensor::new(grid);
    let regions = grid.regions(incidence);
    let turn_back = if grid.phi_r_relative { -grid.incidence_deg(incidence).1 } else { 0.0 };
    let mut means = vec![0.0; regions.len()];
    for &(wi, weight) in source {
        for (wo, flux) in lobes(wi) {
            sensor.each_bin(sphere::turned(wo, sphere::sin_cos_deg(turn_back)), |bin| {
                means[bin] += weight * flux / regions[bin].projected_solid_angle();
            });
        }
    }
    means
}
