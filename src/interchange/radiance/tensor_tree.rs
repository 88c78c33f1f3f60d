//! Radiance XML with a tensor tree: cells of equal projected solid angle, divided where the BRDF changes.
//!
//! Coordinates in [0, 1]: rank 4 (anisotropic) the Shirley-Chiu squares of (-wi.x, -wi.y) and (wo.x, wo.y); rank 3
//! (isotropic) 0.5 - 0.5 sin theta_i and the square of wo turned so that -wi lies on +x. Text: a branch holds 2^rank
//! groups, bit k of the number is the half of axis k; a leaf holds a grid of values, the last axis fastest.
//! Source: Radiance's bsdf_t.c.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::fmt::Write;

use glam::DVec3;

use super::colour;
use super::tensor_cells::{FIRST, Task, TreeCell};
pub use super::tensor_function::{TensorTree, read, read_side};
use super::xml;
use crate::interchange::{Brdf, Lookup};
use crate::sphere;

/// How the values are meant.
pub const CONVENTION: &str = "tensor tree on Shirley-Chiu squares, BRDF in 1/sr, no cosine, constant in each cell; \
    Reflection Back is the +z side; incident coordinates are those of -wi; Visible is Y, of a table of three colours \
    CIE-u and CIE-v (u\', v\' of 1976) beside it (linear BT.709 primaries, white D65)";

/// What the blocks of a coloured file are, after `Visible`.
pub(crate) const COLOURS: [&str; 2] = ["CIE-u", "CIE-v"];
/// Where division ends: share of the error in the sum, and number of values (20 MB of text).
const VISIBLE: (f64, usize) = (0.01, 1 << 21);
/// The same of u' and v', which vary little.
const CHROMATICITY: (f64, usize) = (0.002, 1 << 18);
/// A group of the tree.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Tree {
    /// 2^rank children.
    Branch(Vec<Tree>),
    /// A grid with so many cells a side.
    Leaf(usize, Vec<f32>),
}

/// The square's point of a point of the unit disc.
fn square(x: f64, y: f64) -> [f64; 2] {
    let (r, mut phi) = (x.hypot(y), y.atan2(x));
    if phi < -FRAC_PI_4 {
        phi += 2.0 * PI;
    }
    let (a, b) = if phi < FRAC_PI_4 {
        (r, phi * r / FRAC_PI_4)
    } else if phi < 3.0 * FRAC_PI_4 {
        (-(phi - FRAC_PI_2) * r / FRAC_PI_4, r)
    } else if phi < 5.0 * FRAC_PI_4 {
        (-r, -(phi - PI) * r / FRAC_PI_4)
    } else {
        ((phi - 1.5 * PI) * r / FRAC_PI_4, -r)
    };
    [0.5 * a + 0.5, 0.5 * b + 0.5]
}

/// The disc's point of a point of the square.
fn disc([x, y]: [f64; 2]) -> (f64, f64) {
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    if a == 0.0 && b == 0.0 {
        return (0.0, 0.0);
    }
    let (r, phi) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * b / a) } else { (b, FRAC_PI_2 - FRAC_PI_4 * a / b) };
    (r * phi.cos(), r * phi.sin())
}

fn above(x: f64, y: f64) -> DVec3 {
    DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// The directions of a point; none for the unused half of rank 3.
fn directions(rank: usize, at: &[f64; 4]) -> Option<(DVec3, DVec3)> {
    if rank == 4 {
        let (to, out) = (disc([at[0], at[1]]), disc([at[2], at[3]]));
        return Some((above(-to.0, -to.1), above(out.0, out.1)));
    }
    let sin = 1.0 - 2.0 * at[0];
    let out = disc([at[1], at[2]]);
    (sin > 0.0).then(|| (above(-sin, 0.0), above(out.0, out.1)))
}

/// The point of a pair of directions. Along the first axis of rank 3 the normal is the end of the used half, which is
/// closed there: the other half is no light at all.
pub(crate) fn coordinates(rank: usize, wi: DVec3, wo: DVec3) -> [f64; 4] {
    if rank == 4 {
        let (to, out) = (square(-wi.x, -wi.y), square(wo.x, wo.y));
        return [to[0], to[1], out[0], out[1]];
    }
    let sin = wi.x.hypot(wi.y);
    let turned = if sin > 0.0 { sphere::turned(wo, (wi.y / sin, -wi.x / sin)) } else { wo };
    let out = square(turned.x, turned.y);
    [0.5 - 0.5 * sin, out[0], out[1], 0.0]
}

/// What a cell counts with: every direction of the light alike, in polar angle where the table is isotropic, else in solid
/// angle. By projected solid angle, which the squares keep, grazing light would count so little that its cells stayed
/// as wide as 15 degrees. Both are 1/cos theta_i.
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

/// The text of a file: rank 3 where the table is isotropic, else 4; of three colours Y, u' and v'.
///
/// Held by: `tensor_trees_of_both_ranks_are_within_three_hundredths`, `colours_of_radiance_files_come_back`
/// (tests/it/interchange/interchange_radiance.rs), and against Radiance in tests/interop.
pub fn write(lookup: &Lookup) -> String {
    let rank = if lookup.is_isotropic() { 3 } else { 4 };
    let text = |tree: &Tree| {
        let mut text = String::new();
        print(tree, &mut text);
        text.push('\n');
        text
    };
    let coloured = lookup.colours() > 1;
    let yuv = |wi, wo| {
        let value = lookup.brdf(wi, wo);
        if coloured { colour::yuv(value) } else { value }
    };
    let mut channels = vec![("Visible", text(&tree(rank, VISIBLE, |wi, wo| yuv(wi, wo)[0])))];
    if coloured {
        channels.push((COLOURS[0], text(&tree(rank, CHROMATICITY, |wi, wo| yuv(wi, wo)[1]))));
        channels.push((COLOURS[1], text(&tree(rank, CHROMATICITY, |wi, wo| yuv(wi, wo)[2]))));
    }
    let basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n";
    xml::write(&format!("TensorTree{rank}"), "", basis, &channels)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_and_coordinates_agree() {
        for (rank, at) in [(4, [0.1, 0.7, 0.9, 0.3]), (4, [0.5, 0.2, 0.45, 0.8]), (3, [0.3, 0.6, 0.1, 0.0])] {
            let (wi, wo) = directions(rank, &at).expect("used");
            let found = coordinates(rank, wi, wo);
            // A few operations on numbers of order 1, and a square root near the disc's edge.
            assert!(found.iter().zip(at).all(|(f, w)| (f - w).abs() < 1e-12), "{found:?}");
        }
        // The corners of the published map: +x is the middle of the right side.
        assert_eq!(square(1.0, 0.0), [1.0, 0.5]);
        assert!((square(0.0, -0.5)[0] - 0.5).abs() < 1e-15 && (square(0.0, -0.5)[1] - 0.25).abs() < 1e-15);
    }
}
