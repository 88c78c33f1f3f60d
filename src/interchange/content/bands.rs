//! A table as bands of incidences, one after the other: in memory, where it is one band, or read from its file.

use std::ops::Range;

use crate::error::{Checked, Result};
use crate::table::{BrdfTable, TableRows};

/// A table of which a band of incidences is looked at after the other.
pub trait Bands {
    /// Its geometry and colours; the values may be those of some bands, or none.
    fn outline(&self) -> &BrdfTable;

    /// Visits the bands in their order.
    fn each(&mut self, visit: &mut dyn FnMut(&BrdfTable) -> Checked<()>) -> Checked<()>;
}

impl Bands for &BrdfTable {
    fn outline(&self) -> &BrdfTable {
        self
    }

    fn each(&mut self, visit: &mut dyn FnMut(&BrdfTable) -> Checked<()>) -> Checked<()> {
        visit(self)
    }
}

/// A table that is read from its file band by band.
pub struct RowBands<'a> {
    rows: &'a mut TableRows,
    outline: BrdfTable,
    bands: Vec<Range<usize>>,
}

impl<'a> RowBands<'a> {
    /// Bands of at most `bytes`. Errors: those of the table's file.
    pub fn new(rows: &'a mut TableRows, bytes: u64) -> Result<Self> {
        rows.verify()?;
        let bands = rows.bands(bytes, rows.row_bytes());
        let outline = BrdfTable { grid: rows.grid().clone(), ..rows.take(&[0])? };
        Ok(RowBands { rows, outline, bands })
    }
}

impl Bands for RowBands<'_> {
    fn outline(&self) -> &BrdfTable {
        &self.outline
    }

    fn each(&mut self, visit: &mut dyn FnMut(&BrdfTable) -> Checked<()>) -> Checked<()> {
        for band in &self.bands {
            visit(&self.rows.take(&band.clone().collect::<Vec<_>>())?)?;
        }
        Ok(())
    }
}
