//! MERL `.binary`: isotropic, 90 x 90 x 180 half/difference cells, three colours.
//!
//! Three int32 (90, 90, 180), then f64 \[colour\]\[theta_h\]\[theta_d\]\[phi_d\], divided by a scale for each colour.
//! theta_h = 90 (i/90)^2 degrees, theta_d = i, phi_d = i degrees; phi_d and phi_d + 180 are one cell. The format does
//! not say where in its cell a value lies: [`Sampling`]. Layout: the MERL BRDF database's reader (Matusik et al. 2003).

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use rayon::prelude::*;

use super::codec::{Codec, Encoded, FormatTraits, resampling_notes};
use super::content::half_difference::HalfDifference;
use super::foreign_table;
pub use super::options::Sampling;
use super::{Brdf, Checked, Colour, Imported, Lookup, Options};
use crate::error::wrong;
use crate::instrument::{Grid, GridKind};
use crate::sphere;
use crate::table::BrdfTable;

/// Cells along theta_h, theta_d, phi_d.
const SIZE: [usize; 3] = [90, 90, 180];
const CELLS: usize = SIZE[0] * SIZE[1] * SIZE[2];
/// Bytes of a file: 34,992,012.
pub const BYTES: usize = 12 + 3 * 8 * CELLS;
const SCALE: Colour = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
/// What stands in cells that no pair of directions above the horizon has.
const INVALID: f64 = -1.0;

impl Sampling {
    fn offset(self) -> f64 {
        if self == Sampling::Node { 0.0 } else { 0.5 }
    }

    /// How the values are meant.
    fn convention(self) -> String {
        let (word, reader) = match self {
            Sampling::Node => (
                "nodes (index i is the angle of i), such that straight lines between them along theta_h keep the means",
                "interpolating readers",
            ),
            Sampling::Centre => ("centres (index i is the angle of i + 0.5)", "nearest-cell readers"),
        };
        format!(
            "BRDF in 1/sr, no cosine, divided by 1/1500, 1.15/1500, 1.66/1500 for R, G, B; half/difference angles, \
             isotropic; cell values at {word}, for {reader}; -1 where a direction is below the horizon"
        )
    }
}

/// The format.
pub struct MerlFile;

impl Codec for MerlFile {
    fn traits(&self) -> FormatTraits {
        FormatTraits { more_than_totals: true, half_difference: true, ..FormatTraits::resampled("merl") }
    }

    fn decode(&self, bytes: &[u8], options: &Options) -> Checked<(Imported, Vec<String>)> {
        Ok((read(bytes, options.merl_sampling)?.into(), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, options: &Options) -> Checked<Encoded<'a>> {
        let sampling = options.merl_sampling;
        if table.grid == grid(sampling) {
            let notes = vec!["the table's own cells, as they are".into()];
            return Ok(Encoded::bytes(write_cells(table), sampling.convention(), notes));
        }
        let mut notes = vec![
            "the arms of a pair are one cell: a cell is the mean of f(wi, wo) and f(wo, wi)".to_string(),
        ];
        let bytes = if table.grid.kind == GridKind::HalfDifference {
            if table.grid.phi_h_deg.len() > 1 {
                return Err(
                    "the table is anisotropic, and MERL files have no azimuth of the half vector".into()
                );
            }
            notes.push("resampled: linear between the table's half/difference angles".into());
            write(&HalfDifference::new(table)?, sampling)
        } else {
            check(&table.grid)?;
            let lookup = Lookup::new(table)?;
            notes.extend(resampling_notes(&lookup));
            write(&lookup, sampling)
        };
        Ok(Encoded::bytes(bytes, sampling.convention(), notes))
    }
}

/// The directions of fractional indices, azimuth of the half vector 0.
fn directions([ih, id, ip]: [f64; 3]) -> (DVec3, DVec3) {
    let theta_h = FRAC_PI_2 * (ih / SIZE[0] as f64).powi(2);
    let (theta_d, phi_d) = (FRAC_PI_2 * id / SIZE[1] as f64, PI * ip / SIZE[2] as f64);
    let d = sphere::direction(theta_d, phi_d);
    let (sin, cos) = theta_h.sin_cos();
    let h = DVec3::new(sin, 0.0, cos);
    let wi = DVec3::new(cos * d.x + sin * d.z, d.y, cos * d.z - sin * d.x);
    (wi, 2.0 * wi.dot(h) * h - wi)
}

/// The geometry of a file's cells.
pub fn grid(sampling: Sampling) -> Grid {
    let (at, [h, d, p]) = (sampling.offset(), SIZE);
    let even = |count: usize| (0..count).map(|k| k as f64 + at).collect::<Vec<f64>>();
    Grid {
        kind: GridKind::HalfDifference,
        theta_h_deg: even(h).iter().map(|k| k * k / h as f64).collect(),
        phi_h_deg: vec![0.0],
        theta_d_deg: even(d),
        phi_d_deg: even(p),
        ..Grid::default()
    }
}

/// Refuses anisotropic tables.
pub fn check(grid: &Grid) -> Checked<()> {
    if grid.is_isotropic() {
        return Ok(());
    }
    Err("the table is anisotropic, and MERL files have no azimuth of the half vector; measure with azimuth = \
         \"relative\" (average_azimuth = true), or export to a format of four dimensions (rgl, ssdd, tensor_tree)"
        .into())
}

/// The bytes of a file of an isotropic BRDF; one of one colour has it in all three. Both arms of a pair are one cell:
/// their mean.
///
/// Straight lines between values of a lobe lie above it nearly everywhere. Node values are therefore moved by two
/// thirds of the gap in the middles of the neighbouring intervals of theta_h, the mean of a parabola: what is left
/// has no mean, and two fifths of the L1.
// Tested by `of_a_table_that_holds_the_lobe_it_is_within_three_thousandths` (tests/it/interchange/interchange_merl.rs).
pub fn write(brdf: &dyn Brdf, sampling: Sampling) -> Vec<u8> {
    let mut cells: Vec<Colour> = (0..CELLS)
        .into_par_iter()
        .map(|at| value(brdf, indices(at).map(|i| i as f64 + sampling.offset())))
        .collect();
    if sampling == Sampling::Node {
        let gaps: Vec<Colour> = (0..CELLS - ROW).into_par_iter().map(|at| gap(brdf, &cells, at)).collect();
        let shift = |at: usize| -> Colour {
            let (mut sum, mut widths) = ([0.0; 3], 0.0);
            let before = at.checked_sub(ROW);
            for at in before.into_iter().chain(Some(at)).filter(|&at| at < gaps.len()) {
                // theta_h goes with the square of the index.
                let width = (2 * (at / ROW) + 1) as f64;
                sum.iter_mut().zip(gaps[at]).for_each(|(s, gap)| *s += width * gap);
                widths += width;
            }
            sum.map(|s| 2.0 / 3.0 * s / widths)
        };
        cells.par_iter_mut().enumerate().filter(|(_, cell)| cell[0] >= 0.0).for_each(|(at, cell)| {
            cell.iter_mut().zip(shift(at)).for_each(|(value, shift)| *value = (*value + shift).max(0.0));
        });
    }
    let colours = brdf.colours();
    encode(|colour, at| cells[at][colour.min(colours - 1)])
}

/// The bytes of a file of a table that has the cells of the format: its values as they are.
pub fn write_cells(table: &BrdfTable) -> Vec<u8> {
    let of = |colour: usize| &table.colours[colour.min(table.colours.len() - 1)].total;
    encode(|colour, at| if table.hits[at] > 0 { f64::from(of(colour)[at]) } else { INVALID })
}

fn encode(value: impl Fn(usize, usize) -> f64) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(BYTES);
    SIZE.iter().for_each(|&side| bytes.extend((side as i32).to_le_bytes()));
    for (colour, scale) in SCALE.into_iter().enumerate() {
        let stored = |at| match value(colour, at) {
            value if value < 0.0 => INVALID,
            value => value / scale,
        };
        (0..CELLS).for_each(|at| bytes.extend(stored(at).to_le_bytes()));
    }
    bytes
}

/// Cells of one theta_h.
const ROW: usize = SIZE[1] * SIZE[2];

fn indices(at: usize) -> [usize; 3] {
    [at / ROW, at / SIZE[2] % SIZE[1], at % SIZE[2]]
}

/// The mean of f(wi, wo) and f(wo, wi) at fractional indices; below the horizon the mark of an invalid cell.
fn value(brdf: &dyn Brdf, index: [f64; 3]) -> Colour {
    let (wi, wo) = directions(index);
    if wi.z <= 0.0 || wo.z <= 0.0 {
        return [INVALID; 3];
    }
    let (there, back) = (brdf.brdf(wi, wo), brdf.brdf(wo, wi));
    std::array::from_fn(|c| 0.5 * (there[c] + back[c]))
}

/// How far the value half-way to the next theta_h lies above the straight line; 0 next to invalid cells.
fn gap(brdf: &dyn Brdf, cells: &[Colour], at: usize) -> Colour {
    let ([h, d, p], (low, high)) = (indices(at), (cells[at], cells[at + ROW]));
    let half_way = (0.5 * (h * h + (h + 1) * (h + 1)) as f64).sqrt();
    let middle = value(brdf, [half_way, d as f64, p as f64]);
    if low[0] < 0.0 || high[0] < 0.0 || middle[0] < 0.0 {
        return [0.0; 3];
    }
    std::array::from_fn(|c| middle[c] - 0.5 * (low[c] + high[c]))
}

/// The table of a file's own cells; invalid ones are gaps.
///
/// Refused: another length, another size of the grid, values that are not finite.
// Tested by `damaged_files_are_refused`, `the_cells_of_a_file_are_a_table` (tests/it/interchange/interchange_merl.rs).
pub fn read(bytes: &[u8], sampling: Sampling) -> Checked<BrdfTable> {
    let side = |k: usize| bytes.get(4 * k..4 * k + 4).map(|b| i32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let sides = [side(0), side(1), side(2)];
    if sides != SIZE.map(|side| Some(side as i32)) {
        let what = match sides {
            [Some(h), Some(d), Some(p)] => {
                format!("says {h} x {d} x {p} cells, a MERL file has 90 x 90 x 180")
            }
            _ => format!("{} bytes are too few for a MERL file", bytes.len()),
        };
        return Err(what.into());
    }
    if bytes.len() != BYTES {
        return Err(wrong!("{} bytes, a MERL file has {BYTES}", bytes.len()));
    }
    let mut total: Vec<Vec<f32>> = (0..3).map(|_| Vec::with_capacity(CELLS)).collect();
    let mut hits = vec![1u32; CELLS];
    for (at, chunk) in bytes[12..].as_chunks::<8>().0.iter().enumerate() {
        let value = f64::from_le_bytes(*chunk) * SCALE[at / CELLS];
        let stored = value as f32;
        if !stored.is_finite() {
            return Err(wrong!("value {at} is {value}, no finite BRDF"));
        }
        if stored < 0.0 {
            hits[at % CELLS] = 0;
        }
        total[at / CELLS].push(stored);
    }
    if hits.iter().all(|&hits| hits == 0) {
        return Err("every value is marked invalid".into());
    }
    let seen = |values: Vec<f32>| values.iter().zip(&hits).map(|(&v, &hits)| v * hits as f32 + 0.0).collect();
    let mut table = foreign_table(grid(sampling), total.into_iter().map(seen).collect())?;
    (0..CELLS).filter(|&cell| hits[cell] == 0).for_each(|cell| table.set_gap(cell));
    Ok(table)
}
