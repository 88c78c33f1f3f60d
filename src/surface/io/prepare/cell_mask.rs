//! Cells of a map that no path starts on.

use std::sync::Arc;

/// Cells by column and row, of the file's grid under a finer one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellMask {
    cells_x: usize,
    /// Cells of the finer grid for each of the file's along a side.
    steps: usize,
    /// Row by row.
    excluded: Arc<[bool]>,
}

impl CellMask {
    /// The cells around the samples that `marked` names (`columns` in a row), and around the neighbours of these: the spline
    /// through a sample bends the cells next to it most.
    pub fn around(marked: &[bool], columns: usize, periodic: bool) -> Self {
        let rows = marked.len() / columns;
        let extra = usize::from(!periodic);
        let (cells_x, cells_y) = (columns - extra, rows - extra);
        let mut excluded = vec![false; cells_x * cells_y];
        // A sample has two cells on each side within one sample.
        let reach = |at: usize, cells: usize| -> Vec<usize> {
            let near = (0..4).map(|k| at as isize + k - 2);
            if periodic {
                near.map(|cell| cell.rem_euclid(cells as isize) as usize).collect()
            } else {
                near.filter(|cell| (0..cells as isize).contains(cell)).map(|cell| cell as usize).collect()
            }
        };
        for (at, _) in marked.iter().enumerate().filter(|(_, marked)| **marked) {
            for y in reach(at / columns, cells_y) {
                for x in reach(at % columns, cells_x) {
                    excluded[y * cells_x + x] = true;
                }
            }
        }
        CellMask { cells_x, steps: 1, excluded: excluded.into() }
    }

    /// The same on a grid of `steps` as many cells along each side.
    pub fn refined(self, steps: usize) -> Self {
        CellMask { steps: self.steps * steps, ..self }
    }

    /// Whether no path starts on cell (x, y).
    #[inline]
    pub fn holds(&self, x: usize, y: usize) -> bool {
        self.excluded[y / self.steps * self.cells_x + x / self.steps]
    }

    /// Cells of the file's grid, and how many of them it holds.
    pub fn counts(&self) -> (usize, usize) {
        (self.excluded.len(), self.excluded.iter().filter(|cell| **cell).count())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sample_takes_the_cells_within_one_sample_of_it() {
        let held = |at: usize, periodic: bool| -> Vec<(usize, usize)> {
            let mut marked = vec![false; 8 * 8];
            marked[at] = true;
            let mask = CellMask::around(&marked, 8, periodic);
            let cells = 8 - usize::from(!periodic);
            (0..cells * cells).map(|k| (k % cells, k / cells)).filter(|&(x, y)| mask.holds(x, y)).collect()
        };
        let middle = held(3 * 8 + 4, false);
        assert_eq!((middle.len(), middle[0], middle[15]), (16, (2, 1), (5, 4)));
        // A corner has fewer, or those of the other side.
        assert_eq!(held(0, false), [(0, 0), (1, 0), (0, 1), (1, 1)]);
        let corner = held(0, true);
        assert_eq!((corner.len(), corner.contains(&(7, 6)), corner.contains(&(2, 0))), (16, true, false));
        let mut marked = vec![false; 64];
        marked[0] = true;
        let fine = CellMask::around(&marked, 8, false).refined(4);
        assert!(fine.holds(7, 7) && !fine.holds(8, 0) && fine.counts() == (49, 4));
    }
}
