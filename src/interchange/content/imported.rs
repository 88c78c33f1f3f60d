//! What a foreign file holds: a table, or a function of two directions.

use super::brdf::TwoSided;
use super::half_difference::HalfDifference;
use crate::error::Checked;
use crate::instrument::{Grid, GridKind};
use crate::interchange::radiance::klems::Patchwise;
use crate::interchange::{Brdf, Lookup};
use crate::table::BrdfTable;

/// What a foreign file holds.
pub enum Imported {
    /// Incidences and bins of its own.
    Table(BrdfTable),
    /// A function of two directions.
    Function {
        /// Three colours each, the last what is left.
        parts: Vec<Box<dyn Brdf>>,
        /// One for each colour, nm; none of Y and R, G, B.
        wavelengths_nm: Vec<f64>,
        /// A grid that suits it.
        grid: Grid,
    },
}

impl From<BrdfTable> for Imported {
    fn from(table: BrdfTable) -> Self {
        Imported::Table(table)
    }
}

impl Imported {
    /// A function of Y, or of R, G and B.
    pub(crate) fn of(brdf: impl Brdf + 'static, grid: Grid) -> Self {
        Imported::Function { parts: vec![Box::new(brdf)], wavelengths_nm: vec![], grid }
    }

    /// A file without wavelengths as a function.
    pub(crate) fn into_function(self) -> Checked<Box<dyn Brdf>> {
        match self {
            Imported::Function { mut parts, .. } if parts.len() == 1 => Ok(parts.remove(0)),
            Imported::Function { .. } => Err("the file has wavelengths".into()),
            Imported::Table(table) => function_of(table),
        }
    }
}

/// A table of at most three colours as a function.
pub(crate) fn function_of(table: BrdfTable) -> Checked<Box<dyn Brdf>> {
    if table.grid.looks_below() {
        let of = |below| table.half(below).map(|half| one_sided(half, below)).transpose();
        return Ok(Box::new(TwoSided([of(false)?, of(true)?])));
    }
    one_sided(table, false)
}

/// The same of one side.
fn one_sided(table: BrdfTable, through: bool) -> Checked<Box<dyn Brdf>> {
    Ok(match table.grid.kind {
        GridKind::HalfDifference => Box::new(HalfDifference::new(&table)?),
        GridKind::Patches => Box::new(Patchwise::new(table)?),
        _ => Box::new(Lookup::of_side(&table, through)?),
    })
}
