//! What the lanes read: heights in f32, and the highest height of every cell, of 4 x 4, of 16 x 16 and of more cells.
//!
//! Input: a periodic field whose sides are powers of two. Output: two tables whose lengths are powers of two, so
//! that an index is made valid by a mask alone.

use rayon::prelude::*;

use super::hit_buffer::LaneHit;
use crate::lanes::vector::Gathered;
use crate::surface::Heightfield;
use crate::surface::heightfield::Corners;
use crate::trace::ray::tile_peaks::Tiles;

/// Sides below this have no tiles of 4 x 4 of their own.
const SMALLEST_SIDE: usize = 8;
/// No tile that the lanes look at has a longer side than this part of the field's, but those of 16 x 16.
const LARGEST_SHARE: usize = 8;
/// Largest number of cells: indices of the maxima, twice as many, must fit an i32.
const MOST_CELLS: usize = 1 << 29;

/// The heights of a field as the lanes read them.
///
/// Maxima: level L (0, 1, 2, and on while 4^L is no more than a side) has one value for each 4^L x 4^L cells; that of
/// cell (x, y) stands at ((y + ny) >> 2L) nx + (x >> 2L), so that one formula serves all levels and their rows never
/// overlap.
#[derive(Debug, Clone)]
pub struct MaxPyramid {
    pub(crate) cells_x: usize,
    pub(crate) cells_y: usize,
    pub(crate) heights: Gathered,
    pub(crate) maxima: Gathered,
    pub(crate) highest: f32,
    /// Largest |dz/dx| or |dz/dy| of any facet, rounded up: a ray with dz > steepest (|dx| + |dy|) rises faster
    /// than everything on its way.
    pub(crate) steepest: f32,
}

impl MaxPyramid {
    /// The lanes' copy of `field`; `None` where only the f64 traversal serves: an open map, sides that are no powers of
    /// two, heights that f32 would round.
    pub fn new(field: &Heightfield) -> Option<Self> {
        let (cells_x, cells_y) = (field.cells_x(), field.cells_y());
        let fits = |side: usize| side.is_power_of_two() && side >= SMALLEST_SIDE;
        let exact = || field.heights().iter().all(|&h| f64::from(h as f32) == h);
        if !field.is_periodic()
            || !fits(cells_x)
            || !fits(cells_y)
            || cells_x * cells_y > MOST_CELLS
            || !exact()
        {
            return None;
        }
        let heights: Vec<f32> = field.heights().iter().map(|&h| h as f32).collect();
        let (maxima, steepest) = maxima(&heights, cells_x, cells_y);
        let highest = field.range().1 as f32;
        let (heights, maxima) = (Gathered::new(heights), Gathered::new(maxima));
        Some(MaxPyramid { cells_x, cells_y, heights, maxima, highest, steepest })
    }
}

impl MaxPyramid {
    /// The corner heights of a cell.
    #[inline]
    pub(crate) fn corners(&self, x: usize, y: usize) -> Corners {
        let (x1, y1) = ((x + 1) & (self.cells_x - 1), (y + 1) & (self.cells_y - 1));
        let at = |x: usize, y: usize| f64::from(self.heights[y * self.cells_x + x]);
        Corners { h00: at(x, y), h10: at(x1, y), h01: at(x, y1), h11: at(x1, y1) }
    }

    /// The cell of a hit of a ray from cell (x, y).
    #[inline]
    pub(crate) fn cell(&self, x: usize, y: usize, hit: &LaneHit) -> (usize, usize) {
        let wrapped = |at: usize, by: i32, cells: usize| at.wrapping_add_signed(by as isize) & (cells - 1);
        (wrapped(x, hit.cells_x, self.cells_x), wrapped(y, hit.cells_y, self.cells_y))
    }

    /// The highest level that the lanes look at: a needle stands in most of the larger tiles, the way down from them takes
    /// longer than their skipping saves.
    ///
    /// Measured at 60 degrees, alpha 0.5 to 0.8: 64 x 64 is best at 1024^2 (1.4 times as fast as 16 x 16), 256 x 256 from
    /// 2048^2 on (1.1 times as fast as 64 x 64); a Gaussian field, whose rays are short, does not care.
    pub(crate) fn level_of_lanes(&self) -> usize {
        let side = self.cells_x.min(self.cells_y) / LARGEST_SHARE;
        (side.checked_ilog2().unwrap_or(0) as usize / 2).max(2)
    }
}

impl Tiles for MaxPyramid {
    fn top_level(&self) -> usize {
        top_level(self.cells_x, self.cells_y)
    }

    #[inline]
    fn highest_in_tile(&self, level: usize, (x, y): (usize, usize)) -> f64 {
        f64::from(self.maxima[tile(self.cells_x, self.cells_y, 2 * level, x, y)])
    }
}

/// The table of all levels, and the steepest edge.
fn maxima(heights: &[f32], nx: usize, ny: usize) -> (Vec<f32>, f32) {
    let mut table = vec![f32::NEG_INFINITY; 2 * nx * ny];
    let steepest = table[nx * ny..]
        .par_chunks_mut(nx)
        .enumerate()
        .map(|(y, row)| {
            let (near, far) = (&heights[y * nx..][..nx], &heights[(y + 1) % ny * nx..][..nx]);
            let mut steepest = 0f32;
            for (x, cell) in row.iter_mut().enumerate() {
                let x1 = (x + 1) % nx;
                *cell = near[x].max(near[x1]).max(far[x].max(far[x1]));
                steepest = steepest.max((near[x1] - near[x]).abs()).max((far[x] - near[x]).abs());
            }
            steepest
        })
        .reduce(|| 0.0, f32::max);
    for level in 1..=top_level(nx, ny) {
        let (below, above) = (2 * level - 2, 2 * level);
        for y in (0..ny).step_by(1 << below) {
            for x in (0..nx).step_by(1 << below) {
                let highest = table[tile(nx, ny, below, x, y)];
                let to = &mut table[tile(nx, ny, above, x, y)];
                *to = to.max(highest);
            }
        }
    }
    // Differences of f32 heights are rounded to half a unit in the last place.
    (table, steepest * (1.0 + 2.0 * f32::EPSILON))
}

/// The highest level that has tiles of its own: level 2 at least, above it those that fit the field.
fn top_level(nx: usize, ny: usize) -> usize {
    ((nx.min(ny).trailing_zeros() / 2) as usize).max(2)
}

/// Where the tables of maxima hold the tile of 2^shift x 2^shift cells with cell (x, y).
fn tile(nx: usize, ny: usize, shift: usize, x: usize, y: usize) -> usize {
    ((y + ny) >> shift) * nx + (x >> shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bumpy(nx: usize, ny: usize) -> Heightfield {
        let heights = (0..nx * ny).map(|i| ((i * 7919) % 101) as f64 / 8.0).collect();
        Heightfield::new(nx, ny, true, heights)
    }

    #[test]
    fn every_level_holds_the_highest_corner_of_its_cells() {
        for (nx, ny) in [(8, 8), (16, 8), (8, 64), (32, 32), (128, 64)] {
            let field = bumpy(nx, ny);
            let lanes = MaxPyramid::new(&field).expect("periodic, powers of two");
            for level in (0..=lanes.top_level()).map(|level| 2 * level) {
                for (y, x) in (0..ny).flat_map(|y| (0..nx).map(move |x| (y, x))) {
                    let mut highest = f64::NEG_INFINITY;
                    for (j, i) in (0..ny).flat_map(|j| (0..nx).map(move |i| (j, i))) {
                        if (i >> level, j >> level) == (x >> level, y >> level) {
                            let c = field.corners(i, j);
                            highest = highest.max(c.h00).max(c.h10).max(c.h01).max(c.h11);
                        }
                    }
                    let found = lanes.maxima[((y + ny) >> level) * nx + (x >> level)];
                    assert_eq!(f64::from(found), highest, "{nx} x {ny}, level {level}, cell {x}, {y}");
                }
            }
        }
    }

    #[test]
    fn fields_that_f32_or_masks_cannot_hold_are_left_to_the_walk() {
        let pyramid = |nx: usize, ny: usize, periodic: bool, h: f64| {
            let extra = usize::from(!periodic);
            MaxPyramid::new(&Heightfield::new(nx, ny, periodic, vec![h; (nx + extra) * (ny + extra)]))
        };
        assert!(pyramid(8, 16, true, 0.25).is_some());
        assert!(pyramid(8, 16, false, 0.25).is_none());
        assert!(pyramid(12, 16, true, 0.25).is_none());
        assert!(pyramid(4, 16, true, 0.25).is_none());
        assert!(pyramid(8, 8, true, 0.1).is_none());
    }
}
