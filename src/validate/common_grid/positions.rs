//! The directions that two arms, or two scans, have in common.

use std::sync::Arc;

use super::common_bins::{CommonBins, at_incidences};
use super::incidences::{SAME_DEG, SharedIncidence, same_azimuth};
use super::totals::Sources;
use super::words;
use crate::instrument::{Grid, GridKind};

/// The common positions of two arms of one aperture, or the common points of two scans; `None` where there are none, where
/// apertures differ, or where azimuths count from different directions.
pub fn in_common(grids: [&Grid; 2], shared: &[SharedIncidence]) -> Option<CommonBins> {
    let [a, b] = grids;
    let from_one = a.phi_r_relative == b.phi_r_relative || shared.iter().all(|at| at.phi_i_deg == 0.0);
    if a.kind != b.kind || !from_one || a.aperture_deg != b.aperture_deg {
        return None;
    }
    let lists = grids.map(directions);
    let same = |x: &[f64; 2], y: &[f64; 2]| (x[0] - y[0]).abs() <= SAME_DEG && same_azimuth(x[1], y[1]);
    let pairs: Vec<[usize; 2]> = lists[1]
        .iter()
        .enumerate()
        .filter_map(|(k, wanted)| Some([lists[0].iter().position(|one| same(one, wanted))?, k]))
        .collect();
    if pairs.is_empty() {
        return None;
    }
    // A list of caps keeps the arm's aperture.
    let points_deg = pairs.iter().map(|pair| lists[1][pair[1]]).collect();
    let sensor = Grid {
        kind: GridKind::Points,
        points_deg,
        theta_r_deg: Vec::new(),
        phi_r_deg: Vec::new(),
        ..b.clone()
    };
    let grid = at_incidences(&sensor, grids, shared);
    let chosen = |k: usize| {
        let bins: Vec<Sources> = pairs.iter().map(|pair| vec![(pair[k], 1.0)]).collect();
        let bins = Arc::new(bins);
        shared.iter().map(|_| bins.clone()).collect()
    };
    Some(CommonBins { grid, bins: [chosen(0), chosen(1)], steps: words::positions(grids, pairs.len()) })
}

fn directions(grid: &Grid) -> Vec<[f64; 2]> {
    if grid.kind == GridKind::Points {
        return grid.points_deg.clone();
    }
    grid.theta_r_deg.iter().flat_map(|&theta| grid.phi_r_deg.iter().map(move |&phi| [theta, phi])).collect()
}
