//! Radiance XML with a tensor tree: cells of equal projected solid angle, divided where the BRDF changes.
//!
//! Coordinates in [0, 1]: rank 4 (anisotropic) the Shirley-Chiu squares of (-wi.x, -wi.y) and (wo.x, wo.y); rank 3
//! (isotropic) 0.5 - 0.5 sin theta_i and the square of wo turned so that -wi lies on +x. Text: a branch holds 2^rank
//! groups, bit k of the number is the half of axis k; a leaf holds a grid of values, the last axis fastest. The coordinates
//! of light that goes through are the same: z does not matter. Source: Radiance's bsdf_t.c.

use std::fmt::Write;

use glam::DVec3;

use super::colour;
use super::tensor_cells::{FIRST, Task, TreeCell};
pub use super::tensor_function::{TensorTree, read, read_side};
use super::tensor_square::{COLOURS, Tree, directions};
use super::{sides, xml_writer};
use crate::campaign::SensorSide;
use crate::interchange::codec::{Codec, Encoded, FormatTraits, Sides, resampling_notes};
use crate::interchange::resample::default_grid;
use crate::interchange::{Brdf, Checked, Imported, Lookup, Options, needed};
use crate::table::BrdfTable;

/// How the values are meant.
const CONVENTION: &str = "tensor tree on Shirley-Chiu squares, BRDF in 1/sr, no cosine, constant in each cell; \
    Back is light from the +z side; incident coordinates are those of -wi; Visible is Y, of a table of three colours \
    CIE-u and CIE-v (u\', v\' of 1976) beside it (linear BT.709 primaries, white D65)";

/// The format.
pub struct TensorTreeFile;

impl Codec for TensorTreeFile {
    fn traits(&self) -> FormatTraits {
        FormatTraits { sides: Sides::Both, light_from_back: true, ..FormatTraits::resampled("tensor_tree") }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        Ok(needed::xml(bytes))
    }

    fn decode(&self, bytes: &[u8], options: &Options) -> Checked<(Imported, Vec<String>)> {
        let (tree, notes) = read_side(bytes, options.side)?;
        let even = |count: u32| (0..count).map(|k| 15.0 * f64::from(k)).collect();
        let grid = default_grid(even(6), if tree.is_isotropic() { vec![] } else { even(24) });
        let side = match tree.sides() {
            [true, true] => SensorSide::Both,
            [false, true] => SensorSide::Transmission,
            _ => SensorSide::Reflection,
        };
        Ok((Imported::of(tree, grid.of_side(side)), notes))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, options: &Options) -> Checked<Encoded<'a>> {
        let (text, notes) = write(table, options)?;
        Ok(Encoded::bytes(text, xml_writer::convention(CONVENTION, table.grid.looks_below()), notes))
    }
}

/// Where division ends: share of the error in the sum, and number of values (20 MB of text).
const VISIBLE: (f64, usize) = (0.01, 1 << 21);
/// The same of u' and v', which vary little.
const CHROMATICITY: (f64, usize) = (0.002, 1 << 18);
/// What a cell counts with: every direction of the light alike, in polar angle where the table is isotropic, else in
/// solid angle. By projected solid angle, which the squares keep, grazing light would count so little that its cells
/// stayed as wide as 15 degrees. Both are 1/cos theta_i.
fn weight(rank: usize, at: &[f64; 4]) -> f64 {
    let sin =
        if rank == 4 { (2.0 * at[0] - 1.0).abs().max((2.0 * at[1] - 1.0).abs()) } else { 1.0 - 2.0 * at[0] };
    if sin > 0.0 { 1.0 / (1.0 - sin * sin).sqrt() } else { 0.0 }
}

/// The tree of a function of two directions, 0 where there are none.
fn tree(rank: usize, (target, most): (f64, usize), brdf: impl Fn(DVec3, DVec3) -> f64 + Sync) -> Tree {
    let value = |at: &[f64; 4]| match directions(rank, at) {
        Some((wi, wo)) if wi.z > 0.0 && wo.z > 0.0 => brdf(wi, wo),
        _ => 0.0,
    };
    let (first, cells) = Task { rank, value: &value, weight, target, most }.cells();
    gathered(rank, &cells, first, &[0; 4])
}

/// The branch over `size` cells a side of the start, from the place `at` on.
fn gathered(rank: usize, cells: &[TreeCell], size: usize, at: &[usize; 4]) -> Tree {
    let first = FIRST[rank - 3];
    if size == 1 {
        let place = (0..rank).rev().fold(0, |place, axis| place * first + at[axis]);
        return grown(rank, cells, place);
    }
    let child = |part: usize| {
        let corner = std::array::from_fn(|axis| at[axis] + size / 2 * (part >> axis & 1));
        gathered(rank, cells, size / 2, &corner)
    };
    joined(rank, (0..1 << rank).map(child).collect())
}

/// A cell with all that it was divided into.
fn grown(rank: usize, cells: &[TreeCell], place: usize) -> Tree {
    match cells[place].children {
        Some(first) => joined(rank, (first..first + (1 << rank)).map(|k| grown(rank, cells, k)).collect()),
        None => joined(rank, cells[place].parts.iter().map(|&value| Tree::Leaf(1, vec![value])).collect()),
    }
}

/// Children that are all single values become one grid; where they are equal, one value.
fn joined(rank: usize, children: Vec<Tree>) -> Tree {
    let single = |child: &Tree| match child {
        Tree::Leaf(1, values) => Some(values[0]),
        _ => None,
    };
    let Some(values) = children.iter().map(single).collect::<Option<Vec<f32>>>() else {
        return Tree::Branch(children);
    };
    if values.iter().all(|&value| value == values[0]) {
        return Tree::Leaf(1, vec![values[0]]);
    }
    // In a grid the last axis runs fastest, in a branch the first.
    let reversed = |k: usize| (0..rank).fold(0, |part, bit| part | ((k >> bit) & 1) << (rank - 1 - bit));
    Tree::Leaf(2, (0..values.len()).map(|k| values[reversed(k)]).collect())
}

/// The text of a file, and notes on it: rank 3 where the table is isotropic, else 4; of three colours Y, u' and v'.
// Tested by `tensor_trees_of_both_ranks_are_within_three_hundredths`, `colours_of_radiance_files_come_back`
// (tests/it/interchange/interchange_radiance.rs), and against Radiance in tests/interop.
pub fn write(table: &BrdfTable, options: &Options) -> Checked<(String, Vec<String>)> {
    let (all, mut notes) = sides::of(table, options)?;
    let rank = if table.grid.is_isotropic() { 3 } else { 4 };
    let mut blocks = vec![];
    for side in &all {
        let lookup = Lookup::of_side(&side.half, side.through)?;
        if lookup.is_isotropic() != (rank == 3) {
            return Err("--back: one of the tables is isotropic, the other is not".into());
        }
        notes.extend(
            resampling_notes(&lookup).into_iter().filter(|note| !notes.contains(note)).collect::<Vec<_>>(),
        );
        let coloured = lookup.colours() > 1;
        let yuv = |wi, wo| {
            let value = lookup.brdf(wi, wo);
            if coloured { colour::yuv(value) } else { value }
        };
        let channels = [("Visible", VISIBLE), (COLOURS[0], CHROMATICITY), (COLOURS[1], CHROMATICITY)];
        for (c, (wavelength, limits)) in channels.into_iter().enumerate().take(if coloured { 3 } else { 1 }) {
            let mut data = String::new();
            print(&tree(rank, limits, |wi, wo| yuv(wi, wo)[c]), &mut data);
            data.push('\n');
            let bases = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n".into();
            blocks.push(xml_writer::Block {
                light: side.light,
                through: side.through,
                bases,
                wavelength,
                data,
            });
        }
    }
    Ok((xml_writer::write(&format!("TensorTree{rank}"), "", &blocks), notes))
}

fn print(tree: &Tree, out: &mut String) {
    out.push('{');
    match tree {
        Tree::Branch(children) => {
            for child in children {
                print(child, out);
                out.push('\n');
            }
        }
        Tree::Leaf(_, values) => {
            for value in values {
                // Writing into a String does not fail.
                let _written = write!(out, " {value:.4e}");
            }
            out.push(' ');
        }
    }
    out.push('}');
}
