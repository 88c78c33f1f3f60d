//! Mirror symmetry about the plane of incidence.

use super::grid::Grid;
use crate::campaign::{Azimuth, Campaign};
use crate::sphere;

/// For each incidence, whether the surface's law is its own mirror image about the plane of incidence, so that light
/// that arrives is counted on both sides.
pub fn folded_incidences(campaign: &Campaign, grid: &Grid) -> Vec<bool> {
    let symmetric = campaign.surface.kind.alphas().is_some();
    let along_an_axis = |incidence: usize| {
        let phi = sphere::reduced_deg(grid.incidence_deg(incidence).1 - campaign.surface.rotation_deg);
        campaign.light.azimuth != Azimuth::Relative && phi % 90.0 == 0.0
    };
    let folds = |incidence: usize| campaign.is_isotropic() || along_an_axis(incidence);
    (0..grid.incidences()).map(|incidence| campaign.trace.fold && symmetric && folds(incidence)).collect()
}
