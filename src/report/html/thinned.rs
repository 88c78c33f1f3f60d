//! A table for the page that does not fit the memory: fewer incidences, evenly spread.
//!
//! Input: the geometry of a stored table. Output: the incidences that are kept.

use crate::error::Result;
use crate::instrument::Grid;
use crate::report::plot::plots::spread;
use crate::table::{BrdfTable, TableRows};

/// Bytes of values that a page takes at most: what it shows is reduced further in any case.
const LARGEST: u64 = 1 << 28;

/// The incidences that a page shows of a table in which an incidence takes `row_bytes`, and their geometry: all of them, or some
/// of the angles of each axis.
// Tested by `a_page_of_a_large_table_shows_incidences_of_every_part_of_it` (tests/it/table/large_tables.rs).
pub fn kept_incidences(grid: &Grid, row_bytes: u64, bytes: u64) -> Option<(Grid, Vec<usize>)> {
    let fit = usize::try_from(bytes / row_bytes.max(1)).unwrap_or(usize::MAX).max(1);
    let all = grid.incidences();
    if all <= fit {
        return Some((grid.clone(), (0..all).collect()));
    }
    if !grid.incidences_deg.is_empty() {
        let incidences = some_of(all, fit);
        return Some((grid.of_incidences(incidences.iter().copied())?, incidences));
    }
    let (mut polar, mut azimuths) = (grid.theta_i_deg.len(), grid.phi_i_deg.len());
    while polar * azimuths > fit {
        if polar >= azimuths { polar = polar.div_ceil(2) } else { azimuths = azimuths.div_ceil(2) }
    }
    let (rows, columns) = (some_of(grid.theta_i_deg.len(), polar), some_of(grid.phi_i_deg.len(), azimuths));
    let incidences =
        rows.iter().flat_map(|row| columns.iter().map(move |column| row * grid.phi_i_deg.len() + column));
    let kept = Grid {
        theta_i_deg: rows.iter().map(|&k| grid.theta_i_deg[k]).collect(),
        phi_i_deg: columns.iter().map(|&k| grid.phi_i_deg[k]).collect(),
        ..grid.clone()
    };
    Some((kept, incidences.collect()))
}

fn some_of(count: usize, most: usize) -> Vec<usize> {
    if most < 2 { vec![0] } else { spread(count, most) }
}

/// The table for the page, and which incidences it has; `bytes` hold it, its prediction and its pictures.
pub fn thinned(rows: &mut TableRows, bytes: u64) -> Result<(BrdfTable, Vec<usize>)> {
    let (grid, incidences) = match kept_incidences(rows.grid(), rows.row_bytes(), LARGEST.min(bytes / 4)) {
        Some((grid, incidences)) => (Some(grid), incidences),
        None => (None, (0..rows.grid().incidences()).collect()),
    };
    let table = rows.take(&incidences)?;
    Ok((BrdfTable { grid: grid.unwrap_or_else(|| table.grid.clone()), ..table }, incidences))
}
