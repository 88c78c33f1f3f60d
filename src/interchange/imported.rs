//! What a foreign file holds: a table, or a function of two directions.

use super::half_difference::HalfDifference;
use super::radiance::klems::Patchwise;
use super::{Brdf, Lookup};
use crate::error::Checked;
use crate::instrument::{Grid, GridKind};
use crate::table::BrdfTable;

/// What a foreign file holds.
pub enum Imported {
    /// Incidences and bins of its own.
    Table(BrdfTable),
    /// A function of two directions, and a grid that suits it.
    Function(Box<dyn Brdf>, Grid),
    /// The same with a wavelength for each colour.
    Spectrum {
        /// Three wavelengths each, the last what is left.
        parts: Vec<Box<dyn Brdf>>,
        /// All, nm.
        wavelengths_nm: Vec<f64>,
        /// A grid that suits it.
        grid: Grid,
    },
}

impl Imported {
    /// The function that `part` makes of the values of at most three colours.
    pub(super) fn function(
        values: &[Vec<f32>],
        wavelengths_nm: &[f64],
        grid: Grid,
        part: impl Fn(&[Vec<f32>]) -> Box<dyn Brdf>,
    ) -> Self {
        if wavelengths_nm.is_empty() {
            return Imported::Function(part(values), grid);
        }
        let parts = values.chunks(3).map(part).collect();
        Imported::Spectrum { parts, wavelengths_nm: wavelengths_nm.to_vec(), grid }
    }

    /// A file without wavelengths as a function.
    pub(super) fn into_function(self) -> Checked<Box<dyn Brdf>> {
        match self {
            Imported::Function(brdf, _) => Ok(brdf),
            Imported::Spectrum { .. } => Err("the file has wavelengths".into()),
            Imported::Table(table) => function_of(table),
        }
    }
}

/// A table of at most three colours as a function.
pub(super) fn function_of(table: BrdfTable) -> Checked<Box<dyn Brdf>> {
    Ok(match table.grid.kind {
        GridKind::HalfDifference => Box::new(HalfDifference::new(&table)?),
        GridKind::Patches => Box::new(Patchwise::new(table)?),
        _ => Box::new(Lookup::new(&table)?),
    })
}
