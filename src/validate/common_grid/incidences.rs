//! The incidences that two grids have in common.

use crate::error::{Checked, wrong};
use crate::instrument::Grid;
use crate::sphere;

/// Angles nearer than this are one, degrees.
pub const SAME_DEG: f64 = 1e-9;

/// An incidence of both grids.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedIncidence {
    /// Its place in A and in B.
    pub incidences: [usize; 2],
    /// The light's azimuth, degrees: that of the grid where azimuths differ.
    pub phi_i_deg: f64,
}

/// Whether two azimuths are one.
pub fn same_azimuth(a: f64, b: f64) -> bool {
    let off = sphere::reduced_deg(a - b);
    off <= SAME_DEG || off >= 360.0 - SAME_DEG
}

/// The common incidences, in the order of B, or of A where every azimuth of B is alike. An isotropic grid has every
/// azimuth; at the normal the azimuth still turns the sensor's.
pub fn in_common(grids: [&Grid; 2]) -> Vec<SharedIncidence> {
    let [a, b] = grids;
    let isotropic = grids.map(Grid::is_isotropic);
    let outer = usize::from(!isotropic[1] || isotropic[0]);
    let (over, other) = if outer == 1 { (b, a) } else { (a, b) };
    let alike = isotropic[1 - outer];
    let found = |incidence: usize| {
        let (theta, phi) = over.incidence_deg(incidence);
        let same = |place: &usize| {
            let (there, azimuth) = other.incidence_deg(*place);
            (theta - there).abs() <= SAME_DEG && (alike || same_azimuth(phi, azimuth))
        };
        let place = (0..other.incidences()).find(same)?;
        let incidences = if outer == 1 { [place, incidence] } else { [incidence, place] };
        Some(SharedIncidence { incidences, phi_i_deg: phi })
    };
    (0..over.incidences()).filter_map(found).collect()
}

/// The incidences of `to` between those of `from`.
pub fn within(from: &Grid, to: &Grid) -> Checked<Vec<usize>> {
    let theta = |grid: &Grid| {
        (0..grid.incidences()).map(|incidence| grid.incidence_deg(incidence).0).collect::<Vec<f64>>()
    };
    let (known, wanted) = (theta(from), theta(to));
    let low = known.iter().copied().fold(f64::INFINITY, f64::min) - SAME_DEG;
    let high = known.iter().copied().fold(0.0, f64::max) + SAME_DEG;
    let found: Vec<usize> =
        (0..wanted.len()).filter(|&incidence| (low..=high).contains(&wanted[incidence])).collect();
    if found.is_empty() {
        let ends = |theta: &[f64]| {
            let low = theta.iter().copied().fold(f64::INFINITY, f64::min);
            format!("{low} to {}", theta.iter().copied().fold(0.0, f64::max))
        };
        return Err(wrong!(
            "no incidence in common, and none between the other's: theta_i {} degrees in one table, {} in the other",
            ends(&known),
            ends(&wanted)
        ));
    }
    Ok(found)
}

/// A grid at some of its incidences; as it is at all of them.
pub fn some_of(grid: &Grid, incidences: &[usize]) -> Grid {
    if incidences.iter().copied().eq(0..grid.incidences()) {
        return grid.clone();
    }
    grid.of_incidences(incidences.iter().copied()).unwrap_or_else(|| grid.clone())
}
