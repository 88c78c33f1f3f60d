//! What is done to a measured map before it is measured, in this order: outliers, gaps, form, filters, finer cells.

pub mod cell_mask;
pub mod chain;
pub mod detrend;
pub mod filter;
pub mod form;
pub mod gaps;
mod least_squares;
pub mod outliers;
pub mod refine;
pub(crate) mod spline;

/// The grid that heights lie on, row by row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapGrid {
    /// Samples in a row.
    pub columns: usize,
    /// Distance of neighbouring columns and rows, in the unit of the heights.
    pub pitch: [f64; 2],
    /// Whether the map continues itself.
    pub periodic: bool,
}

impl MapGrid {
    /// Rows of so many heights.
    pub fn rows(&self, heights: &[f64]) -> usize {
        heights.len() / self.columns
    }
}
