//! The samples of a height map and what its file says about them.

/// How the file stores a height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    /// 16-bit float: 11 significant bits.
    Half,
    /// 32-bit float: 24 significant bits.
    Single,
    /// 64-bit float or integer: as exact as this program computes.
    Exact,
}

/// A height map as its file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSamples {
    /// Samples in a row (along x).
    pub columns: usize,
    /// Rows (along y); row 0 is y = 0.
    pub rows: usize,
    /// Heights row by row, all finite.
    pub heights: Vec<f64>,
    /// How they were stored.
    pub stored: Stored,
    /// `pitch_x` and `pitch_y` of the file, in the unit of the heights.
    pub pitch: [Option<f64>; 2],
    /// One unit of height, um, where the file says so.
    pub unit_um: Option<f64>,
    /// Why there are no pitches, where the file has something to say about them.
    pub no_pitch: Option<String>,
}

impl MapSamples {
    /// Heights alone, without pitches or unit.
    pub fn new(columns: usize, rows: usize, heights: Vec<f64>, stored: Stored) -> Self {
        MapSamples { columns, rows, heights, stored, pitch: [None, None], unit_um: None, no_pitch: None }
    }
}
