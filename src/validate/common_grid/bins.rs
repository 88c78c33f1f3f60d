//! The bins that two grids have in common: unions of both grids' bins, or the same directions.

use std::sync::Arc;

use super::common_bins::{CommonBins, at_incidences};
use super::incidences::SharedIncidence;
use super::nesting::{Rings, nested};
use super::totals::Sources;
use super::{positions, words};
use crate::instrument::{Grid, GridKind};

/// Common bins at the shared incidences; `None` where neither grid's bins are unions of the other's.
pub fn in_common(grids: [&Grid; 2], shared: &[SharedIncidence]) -> Option<CommonBins> {
    if grids.iter().any(|grid| matches!(grid.kind, GridKind::Arm | GridKind::Points)) {
        return positions::in_common(grids, shared);
    }
    let with_incidences = |grid: &Grid| at_incidences(grid, grids, shared);
    candidates(grids).iter().find_map(|target| {
        let grid = with_incidences(target);
        let of = |source: &Grid| by_incidence(source, &grid, shared);
        let bins = [of(grids[0])?, of(grids[1])?];
        let steps =
            [0, 1].into_iter().filter_map(|k| words::averaged(k, grids[k], &grid, &bins[k])).collect();
        Some(CommonBins { grid, bins, steps })
    })
}

/// Sensors that may be unions of both, the likeliest first: of two hemispheres the fewer rows with the fewer columns, and
/// then each grid as it is, that of fewer bins first.
fn candidates(grids: [&Grid; 2]) -> Vec<Grid> {
    let [a, b] = grids;
    let mut found = Vec::new();
    if a.kind == GridKind::Hemisphere && b.kind == GridKind::Hemisphere {
        let fewer = |pick: fn(&Grid) -> &Vec<f64>| if pick(a).len() < pick(b).len() { a } else { b };
        let (rows, columns) = (fewer(|grid| &grid.theta_r_edges_deg), fewer(|grid| &grid.phi_r_edges_deg));
        let theta_r_edges_deg = rows.theta_r_edges_deg.clone();
        found.push(Grid { theta_r_edges_deg, ..columns.clone() });
    }
    let (few, many) = if a.bins() < b.bins() { (a, b) } else { (b, a) };
    found.extend([few, many].map(Grid::clone));
    found
}

/// For every shared incidence, the bins of `source` in each of the target's; `None` where they do not nest, or nowhere meet.
fn by_incidence(source: &Grid, target: &Grid, shared: &[SharedIncidence]) -> Option<Vec<Arc<Vec<Sources>>>> {
    let mut last: Option<(f64, Arc<Vec<Sources>>)> = None;
    let mut found = Vec::with_capacity(shared.len());
    for incidence in shared {
        // What the azimuths of each count from, on the stage.
        let origin = |grid: &Grid| if grid.phi_r_relative { incidence.phi_i_deg } else { 0.0 };
        let turn = origin(source) - origin(target);
        let bins = match &last {
            Some((known, bins)) if *known == turn => bins.clone(),
            _ => Arc::new(nested(&Rings::of(source, turn), &Rings::of(target, 0.0))?),
        };
        last = Some((turn, bins.clone()));
        found.push(bins);
    }
    Some(found)
}
