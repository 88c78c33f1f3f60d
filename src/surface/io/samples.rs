//! The samples of a height map and what its file says about them.

/// How the file stores a height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    /// Whole numbers of 8 bits.
    Byte,
    /// 16-bit float: 11 significant bits.
    Half,
    /// 32-bit float: 24 significant bits.
    Single,
    /// 64-bit float or longer integers: as exact as this program computes.
    Exact,
}

/// A height map as its file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSamples {
    /// Samples in a row (along x).
    pub columns: usize,
    /// Rows (along y); row 0 is y = 0.
    pub rows: usize,
    /// Heights row by row; NaN where there are no data.
    pub heights: Vec<f64>,
    /// How they were stored.
    pub stored: Stored,
    /// `pitch_x` and `pitch_y` of the file, in the unit of the heights.
    pub pitch: [Option<f64>; 2],
    /// One unit of height, um, where the file says so.
    pub unit_um: Option<f64>,
    /// Why there are no pitches, where the file has something to say about them.
    pub no_pitch: Option<String>,
    /// What of the file was not read.
    pub notes: Vec<String>,
}

impl MapSamples {
    /// Heights alone, without pitches or unit.
    pub fn new(columns: usize, rows: usize, heights: Vec<f64>, stored: Stored) -> Self {
        let (pitch, notes) = ([None, None], vec![]);
        MapSamples { columns, rows, heights, stored, pitch, unit_um: None, no_pitch: None, notes }
    }

    /// With pitches in units named `lateral` and heights in units named `height`, by which `kind` of file: a length that
    /// is not known, or not positive, is asked for in the campaign.
    pub fn with_units(self, kind: &str, pitch: [f64; 2], lateral: [&str; 2], height: &str) -> Self {
        use super::readers::units;
        let unit_um = units::metres(height).map(|metres| 1e6 * metres);
        let along = |axis: usize| {
            let ratio = units::ratio(lateral[axis], height).map_err(|why| {
                format!("{kind}: x y in `{:.40}`, heights in `{height:.40}`: {why}", lateral[axis])
            })?;
            let pitch = pitch[axis] * ratio;
            if pitch > 0.0 && pitch.is_finite() {
                Ok(pitch)
            } else {
                Err(format!("{kind}: {pitch} between samples: not positive"))
            }
        };
        match (along(0), along(1)) {
            (Ok(x), Ok(y)) => MapSamples { pitch: [Some(x), Some(y)], unit_um, ..self },
            (Err(why), _) | (_, Err(why)) => MapSamples { no_pitch: Some(why), unit_um, ..self },
        }
    }
}
