//! The highest corner of every tile of 4^L x 4^L cells of any field, in f64: by which the f64 traversal skips tiles.

use crate::surface::Heightfield;

/// What is known of the heights in the tiles of a field. Tiles end at the field's edge, level 0 are the cells.
pub(crate) trait Tiles {
    /// The highest level.
    fn top_level(&self) -> usize;
    /// The highest corner of the tile of a level that a cell lies in.
    fn highest_in_tile(&self, level: usize, cell: (usize, usize)) -> f64;
}

/// The tiles of a field that has no lanes: 8 (1 + 1/16 + ...) bytes a cell, fewer than those have.
// Tested by `every_level_holds_the_highest_corner_of_its_cells`.
#[derive(Debug, Clone)]
pub struct TilePeaks {
    /// For each level, tiles in a row and the highest corner of each tile, row by row.
    levels: Vec<(usize, Vec<f64>)>,
}

impl TilePeaks {
    /// The tiles of `field`: levels up to the last that cuts it into more than one tile.
    pub fn new(field: &Heightfield) -> Self {
        let (cells_x, mut rows) = (field.cells_x(), field.cells_y());
        let cells = field.all_corners().map(|c| c.h00.max(c.h10).max(c.h01.max(c.h11))).collect();
        let mut levels = vec![(cells_x, cells)];
        let mut columns = cells_x;
        while columns.max(rows) > 4 {
            let (wide, high) = (columns.div_ceil(4), rows.div_ceil(4));
            let mut tiles = vec![f64::NEG_INFINITY; wide * high];
            let below: &Vec<f64> = &levels[levels.len() - 1].1;
            for (y, row) in below.chunks(columns).enumerate() {
                for (x, &peak) in row.iter().enumerate() {
                    let tile = &mut tiles[y / 4 * wide + x / 4];
                    *tile = tile.max(peak);
                }
            }
            levels.push((wide, tiles));
            (columns, rows) = (wide, high);
        }
        TilePeaks { levels }
    }
}

impl Tiles for TilePeaks {
    fn top_level(&self) -> usize {
        self.levels.len() - 1
    }

    #[inline]
    fn highest_in_tile(&self, level: usize, (x, y): (usize, usize)) -> f64 {
        let (wide, tiles) = &self.levels[level];
        tiles[(y >> (2 * level)) * wide + (x >> (2 * level))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_holds_the_highest_corner_of_its_cells() {
        for (nx, ny, periodic) in [(8, 8, true), (9, 33, true), (30, 7, false), (65, 16, false)] {
            let extra = usize::from(!periodic);
            let heights =
                (0..(nx + extra) * (ny + extra)).map(|i| ((i * 7919) % 101) as f64 - 60.5).collect();
            let field = Heightfield::new(nx, ny, periodic, heights);
            let peaks = TilePeaks::new(&field);
            for level in 0..=peaks.top_level() {
                let side = 1 << (2 * level);
                for (y, x) in (0..ny).flat_map(|y| (0..nx).map(move |x| (y, x))) {
                    let (left, top) = (x / side * side, y / side * side);
                    let rows = top..(top + side).min(ny);
                    let all = rows.flat_map(|j| (left..(left + side).min(nx)).map(move |i| (i, j)));
                    let highest = all
                        .map(|(i, j)| field.corners(i, j))
                        .fold(f64::NEG_INFINITY, |high, c| high.max(c.h00).max(c.h10).max(c.h01).max(c.h11));
                    assert_eq!(peaks.highest_in_tile(level, (x, y)), highest, "level {level}, cell {x}, {y}");
                }
            }
        }
    }
}
