//! A tensor tree that was read, as a function of two directions: constant in each cell.
//!
//! Source: Radiance's bsdf_t.c, which takes one cell where a direction lies on a border of several.

use glam::DVec3;

use super::colour;
use super::sample_side::{SampleSide, SideBlocks};
use super::tensor_square::{COLOURS, Tree, coordinates};
use super::xml;
use super::xml::{negative_note, short};
use crate::error::wrong;
use crate::interchange::{Brdf, Checked, Colour};

/// Deeper than any file.
const DEEPEST: usize = 16;
/// Points nearer to a border of cells than this belong to both sides: angles in radians come with twelve digits.
const BORDER: f64 = 1e-9;

/// A file as a function: constant in each cell; on a border the mean of both sides, as which side a rounding falls to
/// is nobody's choice.
pub struct TensorTree {
    rank: usize,
    /// Of light that comes back, and that has gone through: none, or Y; of a coloured file u' and v' too.
    halves: [Vec<Tree>; 2],
    /// No cell of any tree has a shorter side: 2^-levels.
    levels: i32,
}

impl TensorTree {
    /// Whether the file has rank 3.
    pub fn is_isotropic(&self) -> bool {
        self.rank == 3
    }
}

/// Reads a file; see [`read_side`].
pub fn read(bytes: &[u8]) -> Checked<TensorTree> {
    read_side(bytes, None).map(|(tree, _)| tree)
}

/// Reads the light from one side of a file, what comes back and what goes through where the file has them, and gives notes
/// on it; negative values become 0, as Radiance has it, and are
/// counted.
// Tested by `negative_values_are_counted` (tests/it/interchange/interchange_radiance.rs).
pub fn read_side(bytes: &[u8], side: Option<SampleSide>) -> Checked<(TensorTree, Vec<String>)> {
    let document = xml::read(bytes)?;
    let rank = match document.structure.as_str() {
        "TensorTree3" => 3,
        "TensorTree4" => 4,
        other => {
            return Err(wrong!(
                "IncidentDataStructure {:?}: TensorTree3 or TensorTree4 needed",
                short(other)
            ));
        }
    };
    let SideBlocks { halves: blocks, mut notes } = document.side(COLOURS, side)?;
    let (mut halves, mut levels, mut seen) = ([vec![], vec![]], 0, CellCheck::default());
    for (half, blocks) in halves.iter_mut().zip(blocks) {
        for block in blocks {
            let mut parser = Parser { rest: block.data.trim_start(), rank, levels: 0, seen };
            half.push(parser.group(0)?);
            if !parser.rest.trim().is_empty() {
                return Err(wrong!("{:?} stands behind the tree", short(parser.rest.trim())));
            }
            (levels, seen) = (levels.max(parser.levels), parser.seen);
        }
    }
    notes.extend(negative_note(seen.negative, seen.values, seen.least));
    Ok((TensorTree { rank, halves, levels: levels as i32 }, notes))
}

/// What a file's values were before they were held.
#[derive(Debug, Clone, Copy, Default)]
struct CellCheck {
    values: usize,
    negative: usize,
    least: f64,
}

struct Parser<'a> {
    rest: &'a str,
    rank: usize,
    /// Halvings down to the finest cell so far.
    levels: usize,
    seen: CellCheck,
}

impl Parser<'_> {
    /// A group from its brace to its brace.
    fn group(&mut self, depth: usize) -> Checked<Tree> {
        if depth > DEEPEST {
            return Err(wrong!("branches {DEEPEST} deep: no such tree is"));
        }
        self.rest = self.rest.strip_prefix('{').ok_or("a brace is missing in the tree")?.trim_start();
        if self.rest.starts_with('{') {
            let children =
                (0..1 << self.rank).map(|_| self.group(depth + 1)).collect::<Checked<Vec<Tree>>>()?;
            self.close()?;
            return Ok(Tree::Branch(children));
        }
        let end = self.rest.find(['{', '}']).ok_or("the tree is cut off")?;
        let cells =
            self.rest[..end].split(|c: char| c == ',' || c.is_whitespace()).filter(|cell| !cell.is_empty());
        let seen = &mut self.seen;
        let value = |cell: &str| match cell.parse::<f32>() {
            Ok(value) if value.is_finite() => {
                seen.values += 1;
                seen.negative += usize::from(value < 0.0);
                seen.least = seen.least.min(f64::from(value));
                Ok(value.max(0.0))
            }
            _ => Err(wrong!("{:?} is no finite number", short(cell))),
        };
        let values = cells.map(value).collect::<Checked<Vec<f32>>>()?;
        self.rest = &self.rest[end..];
        self.close()?;
        let side =
            (0..12).map(|k| 1usize << k).find(|side| side.pow(self.rank as u32) >= values.len()).unwrap_or(0);
        if values.is_empty() || side.checked_pow(self.rank as u32) != Some(values.len()) {
            return Err(wrong!("a leaf of {} values; 2^({} k) needed", values.len(), self.rank));
        }
        self.levels = self.levels.max(depth + side.ilog2() as usize);
        Ok(Tree::Leaf(side, values))
    }

    fn close(&mut self) -> Checked<()> {
        self.rest = self.rest.strip_prefix('}').ok_or("a group has too many values or no end")?.trim_start();
        Ok(())
    }
}

impl Tree {
    /// The value at a point of [0, 1]^rank.
    fn at(&self, rank: usize, mut at: [f64; 4]) -> f64 {
        let mut tree = self;
        while let Tree::Branch(children) = tree {
            let mut part = 0;
            for (k, x) in at.iter_mut().take(rank).enumerate() {
                let upper = *x >= 0.5;
                part |= usize::from(upper) << k;
                *x = 2.0 * *x - if upper { 1.0 } else { 0.0 };
            }
            tree = &children[part];
        }
        let Tree::Leaf(side, values) = tree else { return 0.0 };
        let index = |x: f64| ((x * *side as f64) as usize).min(side - 1);
        let cell = at.iter().take(rank).fold(0, |cell, &x| cell * side + index(x));
        f64::from(values[cell])
    }
}

impl TensorTree {
    /// The value at a point; 0 where the file has no trees.
    fn at(&self, trees: &[Tree], at: [f64; 4]) -> Colour {
        let value = |tree: &Tree| tree.at(self.rank, at);
        match trees {
            [] => [0.0; 3],
            [y, u, v] => colour::of_yuv([value(y), value(u), value(v)]),
            [y, ..] => [value(y); 3],
        }
    }

    /// The point at this place of an axis, or two points where a border of the finest cells is there.
    fn sides(&self, axis: usize, x: f64) -> [f64; 2] {
        if axis == self.rank {
            return [0.0; 2];
        }
        // The used half of rank 3 ends at the normal.
        let end = if (self.rank, axis) == (3, 0) { 0.5f64 } else { 1.0 };
        let cells = f64::powi(2.0, self.levels);
        let off = ((x * cells).round() / cells - x).abs();
        let both = if off < BORDER { [x - BORDER, x + BORDER] } else { [x, x] };
        both.map(|x| x.clamp(0.0, end.next_down()))
    }
}

impl Brdf for TensorTree {
    fn colours(&self) -> usize {
        self.halves.iter().map(Vec::len).max().unwrap_or(1)
    }

    fn sides(&self) -> [bool; 2] {
        self.halves.each_ref().map(|trees| !trees.is_empty())
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let trees = &self.halves[usize::from(wo.z < 0.0)];
        let at = coordinates(self.rank, wi, wo);
        let sides: [[f64; 2]; 4] = std::array::from_fn(|axis| self.sides(axis, at[axis]));
        if sides.iter().all(|[below, above]| below == above) {
            return self.at(trees, sides.map(|[x, _]| x));
        }
        let mut sum = [0.0; 3];
        for corner in 0..16 {
            let value = self.at(trees, std::array::from_fn(|axis| sides[axis][corner >> axis & 1]));
            sum.iter_mut().zip(value).for_each(|(s, v)| *s += v / 16.0);
        }
        sum
    }
}
