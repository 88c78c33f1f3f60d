//! The files that a table of albedos is written to: the end of a name says which.

mod c_header;
mod csv;
mod exr;
mod npz;

use std::io::Write;
use std::path::Path;

use super::table::AlbedoTable;
use crate::error::{Checked, Error, Result};

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// NumPy arrays.
    Npz,
    /// A line a cell.
    Csv,
    /// An image a quantity.
    Exr,
    /// Constants and lookups in C and C++.
    Header,
}

impl Kind {
    /// By the end of a name.
    ///
    /// Errors: `Usage`.
    pub fn of(path: &Path) -> Result<Self> {
        let end = path.extension().map(|end| end.to_string_lossy().to_lowercase());
        match end.as_deref() {
            Some("npz") => Ok(Kind::Npz),
            Some("csv") => Ok(Kind::Csv),
            Some("exr") => Ok(Kind::Exr),
            Some("h") => Ok(Kind::Header),
            _ => Err(Error::Usage(format!(
                "-o {}: the name must end in .npz, .csv, .exr or .h, which says what is written",
                path.display()
            ))),
        }
    }

    /// Writes the table. `stem`: the name of the file without its end, which names of a header begin with.
    pub fn write(self, table: &AlbedoTable, stem: &str, out: &mut dyn Write) -> Checked<()> {
        match self {
            Kind::Npz => npz::write(table, out),
            Kind::Csv => csv::write(table, out),
            Kind::Exr => exr::write(table, out),
            Kind::Header => c_header::write(table, stem, out),
        }
    }
}
