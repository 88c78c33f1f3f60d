//! Which bins count in statistics.

use crate::instrument::{Grid, Region};

/// Of two bins that mirror each other about the plane of incidence, the one on the left of it.
pub(crate) fn counted_bins(grid: &Grid, incidence: usize, folded: bool) -> Vec<bool> {
    let phi_i = grid.incidence_deg(incidence).1.to_radians();
    let half_turn = |region: &Region| match *region {
        Region::Rectangle { phi: [low, high], .. } => {
            // The light's frame is turned with it where phi_r is relative; regions are in the stage's frame.
            let middle = (0.5 * (low + high) - phi_i).rem_euclid(std::f64::consts::TAU);
            middle <= std::f64::consts::PI + 1e-9 || middle >= std::f64::consts::TAU - 1e-9
        }
        Region::Cap { axis, .. } => {
            let across = axis.y * phi_i.cos() - axis.x * phi_i.sin();
            across >= -1e-9
        }
    };
    grid.regions(incidence).iter().map(|region| !folded || half_turn(region)).collect()
}
