//! A field's heights in the two orders that sweeps read them in.

use crate::surface::Heightfield;

/// A periodic field laid out for lines along either axis: made once, used by every sweep.
pub struct Layout<'a> {
    pub(super) field: &'a Heightfield,
    /// The heights with rows and columns exchanged.
    transposed: Vec<f64>,
    /// Highest minus lowest height.
    pub(super) range: f64,
}

impl<'a> Layout<'a> {
    /// Lays out `field`; `None` for an open one, over whose edge lines cannot go on.
    pub fn new(field: &'a Heightfield) -> Option<Self> {
        let (lowest, highest) = field.range();
        let transposed = || transposed(field.heights(), field.cells_x());
        field.is_periodic().then(|| Layout { field, transposed: transposed(), range: highest - lowest })
    }

    /// Bytes of what it holds besides the field.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.transposed)
    }

    /// Heights across in column `column`.
    pub(super) fn column(&self, column: usize, across: usize, lines_along_x: bool) -> &[f64] {
        let heights = if lines_along_x { &self.transposed } else { self.field.heights() };
        &heights[column * across..(column + 1) * across]
    }
}

/// Rows of `width` become columns, in tiles that fit the cache.
fn transposed(heights: &[f64], width: usize) -> Vec<f64> {
    const TILE: usize = 16;
    let rows = heights.len() / width;
    let mut out = vec![0.0; heights.len()];
    for tile in (0..rows).step_by(TILE) {
        for x in 0..width {
            for y in tile..(tile + TILE).min(rows) {
                out[x * rows + y] = heights[y * width + x];
            }
        }
    }
    out
}
