//! A table's channels as arrays: their shape, and the order of their values.

use crate::instrument::{Grid, GridKind};

/// Lengths along the axes of a table's arrays.
pub fn shape(grid: &Grid, colours: usize) -> Vec<usize> {
    let product = |a: &[f64], b: &[f64]| vec![grid.theta_i_deg.len(), grid.phi_i_deg.len(), a.len(), b.len()];
    let mut shape = match (grid.kind, grid.incidences_deg.is_empty()) {
        (GridKind::Hemisphere, true) => product(&grid.theta_r_edges_deg[1..], &grid.phi_r_edges_deg[1..]),
        (GridKind::Arm, true) => product(&grid.theta_r_deg, &grid.phi_r_deg),
        _ => vec![grid.incidences(), grid.bins()],
    };
    if colours > 1 {
        shape.push(colours);
    }
    shape
}

/// The colours' values side by side.
pub fn interleaved<'a>(colours: &'a [&'a [f32]]) -> impl Iterator<Item = f32> + 'a {
    (0..colours[0].len()).flat_map(move |pixel| colours.iter().map(move |values| values[pixel]))
}

/// The other way round.
pub fn apart(values: &[f32], colours: usize) -> Vec<Vec<f32>> {
    (0..colours).map(|colour| values.iter().skip(colour).step_by(colours).copied().collect()).collect()
}
