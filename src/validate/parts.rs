//! The realisations of a table, seen from a band of its incidences.

use crate::table::Realisations;

/// The realisations of a table or of some of its incidences.
#[derive(Clone, Copy)]
pub struct Parts<'a> {
    /// Those of the table.
    pub all: &'a Realisations,
    /// Which of their incidences is the first of the table at hand.
    pub first_incidence: usize,
}

impl<'a> Parts<'a> {
    /// Order 1 of one colour at an incidence of the table at hand, in each of them.
    pub fn single(&self, colour: usize, incidence: usize, bins: usize) -> Vec<&'a [f32]> {
        let first = (self.first_incidence + incidence) * bins;
        self.all.parts.iter().map(|part| &part.single[colour][first..first + bins]).collect()
    }
}
