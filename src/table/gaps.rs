//! Pairs of directions that a table lists and that were not measured: a scan whose sensor went elsewhere for each
//! light.
//!
//! A gap has no light, no arrivals and the error [`NOT_MEASURED`] in every colour. It counts nowhere: it is no
//! darkness.

use super::BrdfTable;

/// The `stderr` of a pair that was not measured.
pub const NOT_MEASURED: f32 = -2.0;
/// The `stderr` of a measured pair whose error is not available.
pub const NOT_KNOWN: f32 = -1.0;

impl BrdfTable {
    /// Whether an entry (`incidence * bins + bin`) was not measured.
    pub fn is_gap(&self, entry: usize) -> bool {
        self.colours[0].stderr.get(entry) == Some(&NOT_MEASURED)
    }

    /// How many entries were not measured.
    pub fn gaps(&self) -> usize {
        self.colours[0].stderr.iter().filter(|&&stderr| stderr == NOT_MEASURED).count()
    }

    /// Makes an entry one that was not measured.
    pub fn set_gap(&mut self, entry: usize) {
        for colour in &mut self.colours {
            for channel in [&mut colour.total, &mut colour.single, &mut colour.multiple] {
                channel[entry] = 0.0;
            }
            (colour.stderr[entry], colour.stderr_single[entry]) = (NOT_MEASURED, NOT_MEASURED);
        }
        self.hits[entry] = 0;
    }
}
