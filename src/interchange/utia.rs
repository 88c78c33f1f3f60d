//! UTIA `.bin`: 288 x 288 directions, three colours, anisotropic; f64 without a header.
//!
//! theta 0, 15, .. 75 and phi 0, 7.5, .. 352.5 degrees for light and sensor; index = colour x 288^2 + light x 288 +
//! sensor, of each (theta, phi) with phi fastest. Azimuths are absolute. Readers differ in how they take the values:
//! here they are linear BRDF values. Layout: Filip and Vavra's data description.

use rayon::prelude::*;

use super::lookup::{bin_axes, stop_axes};
use super::{Brdf, Lookup, Reason, foreign_table};
use crate::instrument::{Grid, GridKind};
use crate::sphere;
use crate::table::BrdfTable;

/// How the values are meant.
pub const CONVENTION: &str = "linear BRDF in 1/sr, no cosine (no sRGB curve, no factor: some readers expect one); f64, \
    [R, G, B][light][sensor], theta 0 to 75 by 15, phi 0 to 352.5 by 7.5 degrees, absolute azimuths, phi fastest; \
    values at directions, no aperture";

const DIRECTIONS: usize = 6 * 48;
/// Bytes of a file: 1,990,656.
pub const BYTES: usize = 3 * DIRECTIONS * DIRECTIONS * 8;

fn axes() -> (Vec<f64>, Vec<f64>) {
    ((0..6).map(|k| 15.0 * f64::from(k)).collect(), (0..48).map(|k| 7.5 * f64::from(k)).collect())
}

fn directions() -> Vec<[f64; 2]> {
    let (theta, phi) = axes();
    theta.iter().flat_map(|&t| phi.iter().map(move |&p| [t, p])).collect()
}

/// Whether the table has the very directions of the format.
fn is_native(grid: &Grid) -> bool {
    let same = |found: Reason<(Vec<f64>, Vec<f64>)>| found.is_ok_and(|found| found == axes());
    let kinds = [GridKind::Points, GridKind::Arm];
    kinds.contains(&grid.kind) && !grid.phi_r_relative && same(stop_axes(grid)) && same(bin_axes(grid))
}

/// The bytes of a file; a table of one colour has it in all three. Values of a table with the format's own directions
/// are kept exactly.
pub fn write(table: &BrdfTable) -> Reason<Vec<u8>> {
    let colours = table.colours.len();
    let planes: Vec<Vec<f64>> = if is_native(&table.grid) {
        table.colours.iter().map(|colour| colour.total.iter().map(|&v| f64::from(v)).collect()).collect()
    } else {
        let lookup = Lookup::new(table)?;
        let list: Vec<_> = directions().iter().map(|&[t, p]| sphere::direction_deg(t, p)).collect();
        let pair = |k: usize| lookup.brdf(list[k / DIRECTIONS], list[k % DIRECTIONS]);
        let values: Vec<_> = (0..DIRECTIONS * DIRECTIONS).into_par_iter().map(pair).collect();
        (0..colours).map(|c| values.iter().map(|value| value[c]).collect()).collect()
    };
    let all = (0..3).flat_map(|c| planes[c.min(colours - 1)].iter());
    Ok(all.flat_map(|value| value.to_le_bytes()).collect())
}

/// The table of points of a file. Negative values, which the database has where the light was too weak, become 0.
///
/// Held by: `utia_comes_back_exactly`, `damaged_utia_files_are_refused` (tests/interchange_points.rs).
pub fn read(bytes: &[u8]) -> Reason<BrdfTable> {
    if bytes.len() != BYTES {
        return Err(format!("{} bytes, a UTIA file of 288 x 288 directions has {BYTES}", bytes.len()));
    }
    let value = |chunk: &[u8; 8]| {
        let value = f64::from_le_bytes(*chunk) as f32;
        // NaN stays, to be refused with its place.
        if value < 0.0 { 0.0 } else { value }
    };
    let values: Vec<f32> = bytes.as_chunks::<8>().0.iter().map(value).collect();
    let total = values.chunks(DIRECTIONS * DIRECTIONS).map(<[f32]>::to_vec).collect();
    let (theta_i_deg, phi_i_deg) = axes();
    let grid =
        Grid { kind: GridKind::Points, theta_i_deg, phi_i_deg, points_deg: directions(), ..Grid::default() };
    foreign_table(grid, total)
}
