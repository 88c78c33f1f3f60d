//! The realisations of a table, seen from a band of its stops.

use crate::table::Realisations;

/// The realisations of a table or of some of its stops.
#[derive(Clone, Copy)]
pub struct Parts<'a> {
    /// Those of the table.
    pub all: &'a Realisations,
    /// Which of their stops is the first of the table at hand.
    pub first_stop: usize,
}

impl<'a> Parts<'a> {
    /// Order 1 of one colour at a stop of the table at hand, in each of them.
    pub fn single(&self, colour: usize, stop: usize, bins: usize) -> Vec<&'a [f32]> {
        let first = (self.first_stop + stop) * bins;
        self.all.parts.iter().map(|part| &part.single[colour][first..first + bins]).collect()
    }
}
