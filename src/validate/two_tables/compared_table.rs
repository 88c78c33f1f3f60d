//! One of two tables that are compared.

use crate::campaign::Campaign;
use crate::table::{BrdfTable, Realisations};

/// One of the two tables.
#[derive(Debug, Clone, Copy)]
pub struct ComparedTable<'a> {
    /// The values.
    pub table: &'a BrdfTable,
    /// How it was measured; `None` for an imported table.
    pub campaign: Option<&'a Campaign>,
    /// Its realisations, where they lie next to it.
    pub parts: Option<&'a Realisations>,
    /// Whether the errors are upper bounds, as those of means of bins without realisations.
    pub errors_are_bounds: bool,
}

impl<'a> ComparedTable<'a> {
    /// A table of which nothing else is known.
    pub fn of(table: &'a BrdfTable) -> Self {
        ComparedTable { table, campaign: None, parts: None, errors_are_bounds: false }
    }
}

/// The realisations of both tables, where they were measured on the very same patches.
pub(crate) fn paired<'a>(
    a: &ComparedTable<'a>,
    b: &ComparedTable<'a>,
) -> Option<(&'a Realisations, &'a Realisations)> {
    let same_patches = !a.table.patch_digest.is_empty() && a.table.patch_digest == b.table.patch_digest;
    let equal = |(a, b): &(&Realisations, &Realisations)| a.parts.len() == b.parts.len() && a.parts.len() > 1;
    a.parts.zip(b.parts).filter(|both| same_patches && equal(both))
}
