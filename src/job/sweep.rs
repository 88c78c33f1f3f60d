//! What all tables of a campaign have to say together.

use std::path::Path;

use serde::Deserialize;

use super::paths::{TablePaths, spare_foreign};
use crate::error::{Error, Result};
use crate::files::{self, Destination, memory};
use crate::report::Summary;
use crate::report::html::render;
use crate::report::sweep::{CSV_MARK, NETCDF_MARK, ParameterSweep, SweptTable};
use crate::table::{TableRows, realisations, store};

/// Bytes of memory for each of a summary's.
const MEMORY: u64 = 64;

/// The files of a campaign with several tables.
pub struct SweepPaths {
    /// A line a table and incidence.
    pub csv: Destination,
    /// The same as NetCDF.
    pub netcdf: Destination,
    /// Joint plots.
    pub page: Destination,
}

impl SweepPaths {
    /// `None` where the campaign of this name makes one table.
    pub fn of(name: &str, folder: &Path, all: &[TablePaths]) -> Option<Self> {
        let path = |ending: &str| Destination::at(folder.join(format!("{name}.sweep.{ending}")));
        (all.len() > 1).then(|| SweepPaths { csv: path("csv"), netcdf: path("nc"), page: path("html") })
    }

    /// Refuses to replace what this program did not write.
    pub fn spare_foreign(&self) -> Result<()> {
        spare_foreign(&self.csv, CSV_MARK, "sweep")?;
        spare_foreign(&self.netcdf, NETCDF_MARK, "sweep")?;
        spare_foreign(&self.page, render::MARK, "page")
    }

    /// Its files.
    pub fn paths(&self) -> [&Path; 3] {
        [&self.csv, &self.netcdf, &self.page]
    }

    /// Writes them from the summaries of all tables, with fits where these are cheap next to the measuring.
    pub fn write(&self, name: &str, all: &[TablePaths]) -> Result<()> {
        let table = |paths: &TablePaths| {
            let stem = paths.table.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            fitted(SweptTable::new(stem, Some(&paths.one), summary(&paths.summary)?), paths)
        };
        let tables = all.iter().map(table).collect::<Result<Vec<_>>>()?;
        let sweep = ParameterSweep { name: name.to_string(), tables };
        files::write_atomically(&self.csv, sweep.csv().as_bytes())?;
        let netcdf = sweep.netcdf().map_err(|why| Error::format(&self.netcdf, why))?;
        files::write_atomically(&self.netcdf, &netcdf)?;
        files::write_atomically(&self.page, sweep.page(true).as_bytes())
    }
}

/// A table with its best fit, where that costs little and memory holds the table.
fn fitted(swept: SweptTable, paths: &TablePaths) -> Result<SweptTable> {
    let rows = TableRows::open(&paths.table)?;
    let values = rows.grid().incidences() * rows.grid().bins() * rows.colours();
    if !swept.fit_is_cheap(values) || rows.bytes().max(rows.reading_bytes()) > memory::memory_limit() {
        return Ok(swept);
    }
    let table = store::load(&paths.table)?.table;
    let parts = match files::is_there(&paths.realisations) {
        true => Some(realisations::load(&paths.realisations)?.realisations),
        false => None,
    };
    Ok(swept.fitted(&table, Some(&paths.one), parts.as_ref()))
}

fn summary(path: &Path) -> Result<Summary> {
    let bytes = files::read(path)?;
    memory::check_file(path, MEMORY * bytes.len() as u64)?;
    let value: serde_json::Value =
        serde_json::from_slice(&bytes).map_err(|e| Error::format(path, format!("is no JSON: {e}")))?;
    Summary::deserialize(value).map_err(|e| Error::format(path, format!("is no summary: {e}")))
}
