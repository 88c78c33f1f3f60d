//! What was done to tables, in sentences.

use std::sync::Arc;

use super::incidences::SharedIncidence;
use super::totals::{Sources, Totals};
use crate::instrument::{Grid, GridKind};

/// The tables' names.
pub const NAMES: [&str; 2] = ["A", "B"];

/// Of incidences that only one table has; `None` where both have the same.
pub fn incidences(grids: [&Grid; 2], shared: &[SharedIncidence]) -> Option<String> {
    let [a, b] = grids.map(Grid::incidences);
    let isotropic = grids.map(Grid::is_isotropic);
    let one = |k: usize| format!("{} takes every azimuth of the light to be alike", NAMES[k]);
    let alike = match isotropic {
        [true, false] => Some(one(0)),
        [false, true] => Some(one(1)),
        _ => None,
    };
    let count = shared.len();
    let some =
        (count < a || count < b).then(|| format!("{count} incidences in common, of {a} in A and {b} in B"));
    let said: Vec<String> = [some, alike].into_iter().flatten().collect();
    (!said.is_empty()).then(|| said.join("; "))
}

/// Of bins that were averaged; `None` where a table's are as they were.
pub fn averaged(k: usize, from: &Grid, to: &Grid, bins: &[Arc<Vec<Sources>>]) -> Option<String> {
    let all = || bins.iter().flat_map(|bins| bins.iter());
    let name = NAMES[k];
    let missing = bins.first().map_or(0, |bins| bins.iter().filter(|sources| sources.is_empty()).count());
    let kept = bins.first().map_or(0, |bins| bins.iter().map(Vec::len).sum::<usize>());
    let mut said = Vec::new();
    if all().any(|sources| sources.len() > 1) {
        said.push(format!(
            "{name}'s bins ({}) averaged to {}, by projected solid angle",
            sensor(from),
            sensor(to)
        ));
    }
    if missing > 0 {
        said.push(format!("{name} has none of {missing} bins of the other table; they are left out"));
    }
    if kept < from.bins() {
        said.push(format!(
            "{} bins of {name} lie outside the other table; they are left out",
            from.bins() - kept
        ));
    }
    (!said.is_empty()).then(|| said.join("; "))
}

/// Of directions that only one table has.
pub fn positions(grids: [&Grid; 2], count: usize) -> Vec<String> {
    let [a, b] = grids.map(Grid::bins);
    let some = count < a || count < b;
    some.then(|| format!("{count} directions of the sensor in common, of {a} in A and {b} in B"))
        .into_iter()
        .collect()
}

/// Of errors that are not those of realisations.
pub fn errors(k: usize, side: &Totals<'_>) -> Option<String> {
    let known = side.table.colours.iter().any(|colour| colour.stderr.iter().any(|&se| se >= 0.0));
    (side.errors_are_bounds && known).then(|| {
        format!(
            "{}'s errors are upper bounds: without realisations it is not known how its bins vary together",
            NAMES[k]
        )
    })
}

/// Of incidences between those of a table.
pub fn between_incidences(from: usize, to: &Grid, within: &[usize]) -> String {
    format!(
        "no incidence in common: {} interpolated to the incidences of {}, {} of {} within reach",
        NAMES[from],
        NAMES[1 - from],
        within.len(),
        to.incidences()
    )
}

/// Of bins that were interpolated, since they do not nest or the incidences differ.
pub fn interpolated(from: usize, grids: [&Grid; 2], do_not_nest: bool) -> String {
    let to = 1 - from;
    let why = if do_not_nest { "bins do not nest: " } else { "" };
    let [from_bins, to_bins] = [from, to].map(|k| sensor(grids[k]));
    format!("{why}{} ({from_bins}) interpolated and averaged over {}'s ({to_bins})", NAMES[from], NAMES[to])
}

/// Of what is known of an interpolation's error.
pub fn interpolation_error(from: usize, found: &Totals<'_>) -> String {
    let name = NAMES[from];
    if found.parts.is_some() {
        format!(
            "{name}'s errors are those of its realisations; that of the interpolation is not known and not in them"
        )
    } else {
        format!("{name}'s errors are n/a: it has no realisations, and the interpolation's error is not known")
    }
}

/// A sensor in a few words: the steps of even bins, else their number.
fn sensor(grid: &Grid) -> String {
    match grid.kind {
        GridKind::Hemisphere => {
            let (rows, columns) = (steps(&grid.theta_r_edges_deg), steps(&grid.phi_r_edges_deg));
            match rows.zip(columns) {
                Some((row, column)) => format!("{row} x {column} degrees"),
                None => format!("{} bins", grid.bins()),
            }
        }
        GridKind::Patches => format!("{} patches", grid.bins()),
        GridKind::Arm => format!("{} apertures", grid.bins()),
        GridKind::Points | GridKind::HalfDifference => format!("{} directions", grid.bins()),
    }
}

/// The width of even bins, of which the outermost may be narrower (half as wide where bins are centred).
fn steps(edges: &[f64]) -> Option<f64> {
    let widths: Vec<f64> = edges.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let inner = if widths.len() > 2 { &widths[1..widths.len() - 1] } else { &widths[..] };
    let step = inner.iter().sum::<f64>() / inner.len() as f64;
    let even = widths.iter().all(|width| *width <= step + 1e-9)
        && inner.iter().all(|width| (width - step).abs() < 1e-9);
    even.then_some((step * 1e9).round() / 1e9)
}
