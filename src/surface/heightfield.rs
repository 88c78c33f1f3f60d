//! A grid of heights and its two facets per cell.

use glam::DVec2;

/// Heights on a grid of unit cells, row 0 at y = 0, y growing with the row.
///
/// A periodic field of nx x ny cells has nx x ny heights and continues itself. An open field of nx x ny cells has
/// (nx + 1) x (ny + 1) heights. Each cell (x, y) is split along (x+1, y)-(x, y+1) into a lower facet (corners
/// (x, y), (x+1, y), (x, y+1)) and an upper facet (the other three).
#[derive(Debug, Clone, PartialEq)]
pub struct Heightfield {
    cells_x: usize,
    cells_y: usize,
    periodic: bool,
    heights: Vec<f64>,
}

/// The four corner heights of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corners {
    /// At (x, y).
    pub h00: f64,
    /// At (x+1, y).
    pub h10: f64,
    /// At (x, y+1).
    pub h01: f64,
    /// At (x+1, y+1).
    pub h11: f64,
}

impl Corners {
    /// Slopes (dz/dx, dz/dy) of the lower facet.
    pub fn lower_slope(&self) -> DVec2 {
        DVec2::new(self.h10 - self.h00, self.h01 - self.h00)
    }

    /// Slopes (dz/dx, dz/dy) of one of the two.
    #[inline]
    pub fn slope(&self, upper: bool) -> DVec2 {
        if upper { self.upper_slope() } else { self.lower_slope() }
    }

    /// Slopes (dz/dx, dz/dy) of the upper facet.
    pub fn upper_slope(&self) -> DVec2 {
        DVec2::new(self.h11 - self.h01, self.h11 - self.h10)
    }

    /// Slopes of the lower and of the upper facet.
    pub fn slopes(&self) -> [DVec2; 2] {
        [self.lower_slope(), self.upper_slope()]
    }
}

impl Heightfield {
    /// A field from its heights, row by row.
    ///
    /// Panics if the number of heights does not fit: callers build both from one size.
    pub fn new(cells_x: usize, cells_y: usize, periodic: bool, heights: Vec<f64>) -> Self {
        let extra = usize::from(!periodic);
        assert_eq!(heights.len(), (cells_x + extra) * (cells_y + extra), "heights do not fit the grid");
        Heightfield { cells_x, cells_y, periodic, heights }
    }

    /// Cells along x.
    pub fn cells_x(&self) -> usize {
        self.cells_x
    }

    /// Cells along y.
    pub fn cells_y(&self) -> usize {
        self.cells_y
    }

    /// Whether the field continues itself.
    pub fn is_periodic(&self) -> bool {
        self.periodic
    }

    /// The same surface seen from below, in a frame whose z points down.
    pub fn upside_down(&self) -> Self {
        Heightfield { heights: self.heights.iter().map(|h| -h).collect(), ..*self }
    }

    /// The heights, row by row.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Heights in one row of the grid.
    fn stride(&self) -> usize {
        self.cells_x + usize::from(!self.periodic)
    }

    /// The corner heights of cell (x, y), which must lie in the field.
    #[inline]
    pub fn corners(&self, x: usize, y: usize) -> Corners {
        let stride = self.stride();
        let x1 = if self.periodic && x + 1 == self.cells_x { 0 } else { x + 1 };
        let y1 = if self.periodic && y + 1 == self.cells_y { 0 } else { y + 1 };
        Corners {
            h00: self.heights[y * stride + x],
            h10: self.heights[y * stride + x1],
            h01: self.heights[y1 * stride + x],
            h11: self.heights[y1 * stride + x1],
        }
    }

    /// The corner heights of all cells, row by row.
    pub fn all_corners(&self) -> impl Iterator<Item = Corners> {
        (0..self.cells_y).flat_map(move |y| (0..self.cells_x).map(move |x| self.corners(x, y)))
    }

    /// The cells at the smallest x and y, open: at most so many along each side.
    pub fn crop(&self, most: usize) -> Self {
        let [columns, rows] = [self.cells_x, self.cells_y].map(|cells| cells.min(most));
        let height = |x: usize, y: usize| {
            let corners = self.corners(x.min(columns - 1), y.min(rows - 1));
            match (x == columns, y == rows) {
                (false, false) => corners.h00,
                (true, false) => corners.h10,
                (false, true) => corners.h01,
                (true, true) => corners.h11,
            }
        };
        let heights = (0..=rows).flat_map(|y| (0..=columns).map(move |x| height(x, y))).collect();
        Heightfield::new(columns, rows, false, heights)
    }

    /// Lowest and highest height.
    pub fn range(&self) -> (f64, f64) {
        self.heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &h| (lo.min(h), hi.max(h)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_periodic_field_continues_itself() {
        let field = Heightfield::new(2, 2, true, vec![0.0, 1.0, 2.0, 3.0]);
        let corners = field.corners(1, 1);
        assert_eq!((corners.h00, corners.h10, corners.h01, corners.h11), (3.0, 2.0, 1.0, 0.0));
    }

    #[test]
    fn a_crop_has_the_cells_of_its_field() {
        let heights: Vec<f64> = (0..15).map(|i| f64::from(i * i % 7)).collect();
        for field in [Heightfield::new(5, 3, true, heights.clone()), Heightfield::new(4, 2, false, heights)] {
            for most in [1, 2, 4, 9] {
                let crop = field.crop(most);
                assert_eq!(
                    [crop.cells_x(), crop.cells_y()],
                    [field.cells_x(), field.cells_y()].map(|cells| cells.min(most))
                );
                for (x, y) in (0..crop.cells_y()).flat_map(|y| (0..crop.cells_x()).map(move |x| (x, y))) {
                    assert_eq!(crop.corners(x, y), field.corners(x, y));
                }
            }
        }
    }

    #[test]
    fn an_open_field_has_one_more_row_and_column() {
        let field = Heightfield::new(2, 1, false, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let corners = field.corners(1, 0);
        assert_eq!((corners.h00, corners.h10, corners.h01, corners.h11), (1.0, 2.0, 4.0, 5.0));
        assert_eq!(corners.lower_slope(), DVec2::new(1.0, 3.0));
        assert_eq!(corners.upper_slope(), DVec2::new(1.0, 3.0));
    }
}
