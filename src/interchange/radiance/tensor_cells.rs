//! Where a tensor tree is divided: cells are split, the largest share of the error first, until what is left is small
//! enough or the file large enough.
//!
//! A cell holds the function in its 2^rank parts, at their middles until all are divided, then as means. Constant
//! over each part, it is off by about a quarter of the step between neighbours, times its volume and its weight: its
//! share of the flux of all pairs, whichever light counts how much. Splitting the cell halves that.

use rayon::prelude::*;

/// What is divided.
pub struct Task<'a> {
    /// 3 or 4 axes.
    pub rank: usize,
    /// The value at a point of [0, 1]^rank.
    pub value: &'a (dyn Fn(&[f64; 4]) -> f64 + Sync),
    /// What a cell with this middle counts with, next to its volume.
    pub weight: fn(usize, &[f64; 4]) -> f64,
    /// Where to stop: the error's share of the sum.
    pub target: f64,
    /// And the number of values at which to stop.
    pub most: usize,
}

/// A cell: the grid of its parts, or so many cells.
#[derive(Debug, Clone)]
pub struct TreeCell {
    corner: [f64; 4],
    side: f64,
    /// Values of the parts; bit k of the place is the half of axis k.
    pub parts: Vec<f32>,
    /// Place of the first of 2^rank children.
    pub children: Option<usize>,
    error: f64,
    sum: f64,
}

/// The finest cell has this side.
const FINEST: f64 = 1.0 / 512.0;
/// Cells of the start by rank: 8 and 4 a side, their parts half of that.
pub const FIRST: [usize; 2] = [8, 4];

impl Task<'_> {
    fn cell(&self, corner: [f64; 4], side: f64) -> TreeCell {
        let value = |part: usize| {
            let at = std::array::from_fn(|k| corner[k] + side * (0.25 + 0.5 * ((part >> k) & 1) as f64));
            (self.value)(&at) as f32
        };
        let parts: Vec<f32> = (0..1 << self.rank).map(value).collect();
        let axis = |axis: usize| {
            let lower = (0..parts.len()).filter(|part| part >> axis & 1 == 0);
            let step = lower.map(|part| f64::from(parts[part | 1 << axis] - parts[part]).abs()).sum::<f64>();
            (2.0 * step / parts.len() as f64).powi(2)
        };
        let step = (0..self.rank).map(axis).sum::<f64>().sqrt();
        let middle = corner.map(|low| low + 0.5 * side);
        let volume = side.powi(self.rank as i32) * (self.weight)(self.rank, &middle);
        let sum = parts.iter().map(|&v| f64::from(v)).sum::<f64>() / parts.len() as f64 * volume;
        TreeCell { corner, side, parts, children: None, error: 0.25 * step * volume, sum }
    }

    /// Gives each part of a cell that stays its mean for the value at its middle: towards the horizon a BRDF is
    /// hollow, and middles lie below it. Two opposite Gauss points, exact for squares along each axis; on which
    /// diagonal they lie changes from part to part such that products of two axes cancel over the cell.
    fn average(&self, cell: &mut TreeCell) {
        if cell.children.is_some() {
            return;
        }
        let off = 0.25 / 3f64.sqrt() * cell.side;
        for (part, mean) in cell.parts.iter_mut().enumerate() {
            let value = |off: f64| {
                (self.value)(&std::array::from_fn(|k| {
                    let half = ((part >> k) & 1) as f64;
                    cell.corner[k] + cell.side * (0.25 + 0.5 * half) + off * (2.0 * half - 1.0)
                }))
            };
            *mean = (0.5 * (value(off) + value(-off))) as f32;
        }
    }

    /// Cells of a regular start (the first `FIRST`^rank, the last axis slowest), and those that they were divided into.
    ///
    /// The same for any number of threads: each round divides the cells above a limit that the round before has set.
    pub fn cells(&self) -> (usize, Vec<TreeCell>) {
        let first = FIRST[self.rank - 3];
        let side = 1.0 / first as f64;
        let corner = |k: usize| std::array::from_fn(|a| (k / first.pow(a as u32) % first) as f64 * side);
        let mut cells: Vec<TreeCell> =
            (0..first.pow(self.rank as u32)).into_par_iter().map(|k| self.cell(corner(k), side)).collect();
        let mut sum: f64 = cells.iter().map(|cell| cell.sum).sum();
        let mut open: Vec<usize> = (0..cells.len()).collect();
        loop {
            open.sort_by(|&a, &b| cells[b].error.total_cmp(&cells[a].error));
            let error: f64 = open.iter().map(|&k| cells[k].error).sum();
            let room = self.most.saturating_sub(cells.len() << self.rank) >> (2 * self.rank);
            // Half of what is too much, and never less than a tenth: each round is one parallel sweep.
            let excess = error - self.target * sum;
            let (mut taken, mut share) = (0, 0.0);
            while taken < open.len().min(room) && share < (0.5 * excess).max(0.1 * error) {
                share += cells[open[taken]].error;
                taken += 1;
            }
            if excess <= 0.0 || taken == 0 || share == 0.0 {
                cells.par_iter_mut().filter(|cell| cell.error > 0.0).for_each(|cell| self.average(cell));
                return (first, cells);
            }
            let chosen: Vec<usize> = open.drain(..taken).collect();
            let halves = |k: usize| (0..1usize << self.rank).map(move |part| (k, part));
            let pairs: Vec<(usize, usize)> = chosen.iter().flat_map(|&k| halves(k)).collect();
            let child = |&(k, part): &(usize, usize)| {
                let (cell, half) = (&cells[k], 0.5 * cells[k].side);
                let corner = std::array::from_fn(|a| cell.corner[a] + half * (part >> a & 1) as f64);
                self.cell(corner, half)
            };
            let children: Vec<TreeCell> = pairs.par_iter().map(child).collect();
            sum += children.iter().map(|cell| cell.sum).sum::<f64>();
            sum -= chosen.iter().map(|&k| cells[k].sum).sum::<f64>();
            for (n, &k) in chosen.iter().enumerate() {
                cells[k].children = Some(cells.len() + (n << self.rank));
                cells[k].parts = Vec::new();
            }
            let fine = |k: &usize| children[k - cells.len()].side > FINEST;
            open.extend((cells.len()..cells.len() + children.len()).filter(fine));
            cells.extend(children);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_go_where_the_function_changes_and_end_at_the_limit() {
        // A step at 0.3 of the first axis, constant elsewhere.
        let value = |at: &[f64; 4]| if at[0] < 0.3 { 1.0 } else { 2.0 };
        let task = Task { rank: 3, value: &value, weight: |_, _| 1.0, target: 1e-3, most: 60_000 };
        let (first, cells) = task.cells();
        assert_eq!(first, 8);
        assert!(cells.len() << 3 <= 60_000 + 64 && cells.len() > 512);
        for cell in cells.iter().filter(|cell| cell.children.is_some()) {
            assert!(cell.corner[0] <= 0.3 && 0.3 <= cell.corner[0] + cell.side, "{cell:?}");
        }
        // A constant is not divided.
        let flat = Task { value: &|_: &[f64; 4]| 0.3, ..task };
        assert_eq!(flat.cells().1.len(), 512);
    }
}
