//! What two grids' bins have in common, at common incidences.

use std::sync::Arc;

use super::incidences::{SharedIncidence, some_of};
use super::totals::Sources;
use crate::instrument::Grid;

/// A grid whose bins are means of both tables' bins.
pub struct CommonBins {
    /// The grid, at the common incidences.
    pub grid: Grid,
    /// For A and B, at each incidence, the bins of each bin.
    pub bins: [Vec<Arc<Vec<Sources>>>; 2],
    /// What was done.
    pub steps: Vec<String>,
}

/// The sensor of one grid at the shared incidences; these have the azimuths of the grid where they differ.
pub fn at_incidences(sensor: &Grid, grids: [&Grid; 2], shared: &[SharedIncidence]) -> Grid {
    let own = if grids[1].is_isotropic() && !grids[0].is_isotropic() { 0 } else { 1 };
    let incidences: Vec<usize> = shared.iter().map(|shared| shared.incidences[own]).collect();
    let Grid { theta_i_deg, phi_i_deg, incidences_deg, .. } = some_of(grids[own], &incidences);
    Grid { theta_i_deg, phi_i_deg, incidences_deg, ..sensor.clone() }
}
