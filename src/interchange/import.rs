//! The way in: what the bytes of a foreign file hold, as a table.

use std::path::Path;

use super::content::sides::functions;
use super::resample::{gaps, resample_spectrum};
use super::text::samples::one_azimuth;
use super::{Brdf, COMES_BACK, Format, GONE_THROUGH, Imported, Options};
use crate::campaign;
use crate::error::{Checked, ContentError, Error, Result};
use crate::files::{self, memory};
use crate::instrument::{Grid, GridKind};
use crate::table::BrdfTable;

/// The largest file that is read, bytes; the memory that may be used can allow less ([`memory`]).
pub const LARGEST_FILE: u64 = 4 << 30;

/// What the bytes of a file hold. Memory goes with their number; [`import`] judges how much it is first.
pub fn decode(format: Format, options: &Options, bytes: &[u8]) -> Checked<Imported> {
    format.codec().decode(bytes, options).map(|(imported, _)| imported)
}

/// The table in a foreign file, on the geometry of `like` where that is given and the file is a function.
///
/// Returns it with one sentence for each thing that was chosen. Errors: [`Error::Format`], [`Error::Io`].
pub fn import(
    path: &Path,
    format: Format,
    options: &Options,
    like: Option<&Grid>,
) -> Result<(BrdfTable, Vec<String>)> {
    let wrong = |why: ContentError| Error::format(path, why.at(format.name()));
    let length = files::open(path)?.length().map_err(|e| Error::io(path, e))?;
    if length > LARGEST_FILE {
        return Err(wrong(format!("{length} bytes; at most {LARGEST_FILE} are read").into()));
    }
    let bytes = files::read(path)?;
    let codec = format.codec();
    memory::check_file(path, codec.memory_needed(&bytes).map_err(wrong)?)?;
    let (imported, notes) = codec.decode(&bytes, options).map_err(wrong)?;
    let imported = match imported {
        Imported::Table(table) if options.isotropic => Imported::Table(one_azimuth(table).map_err(wrong)?),
        Imported::Function { .. } if options.isotropic => {
            return Err(wrong("says itself whether it is isotropic: leave --isotropic out".into()));
        }
        imported => imported,
    };
    let (table, how) = on_grid(imported, like).map_err(wrong)?;
    if !table.campaign.is_empty() {
        // What the table's readers will ask of it.
        let parsed = campaign::parse(&table.campaign, "campaign", path.parent().unwrap_or(path));
        parsed.map_err(|why| {
            let why = why.to_string();
            Error::format(path, why.lines().next().unwrap_or_default())
        })?;
    }
    Ok((table, notes.into_iter().chain(how).collect()))
}

/// A table of what was read, on the geometry of `like` where that is given, with notes on gaps and on
/// resampling.
fn on_grid(imported: Imported, like: Option<&Grid>) -> Checked<(BrdfTable, Vec<String>)> {
    let (parts, wavelengths_nm, own) = match imported {
        Imported::Table(table) => {
            let Some(grid) = like.filter(|grid| **grid != table.grid) else {
                let note = gaps::note(&table).into_iter().collect();
                return Ok((table, note));
            };
            let how = match table.grid.kind {
                GridKind::HalfDifference => "linear between half/difference angles",
                GridKind::Patches => "constant in each pair of patches, the mean at borders",
                _ => "by cubic interpolation at equal half vector",
            };
            let (parts, wavelengths_nm, filled) = functions(table)?;
            let left = left_out(&parts, grid);
            let table = resample_spectrum(parts.iter().map(Box::as_ref), &wavelengths_nm, grid)?;
            return Ok((
                table,
                filled.into_iter().chain([format!("resampled: {how}")]).chain(left).collect(),
            ));
        }
        Imported::Function { parts, wavelengths_nm, grid } => (parts, wavelengths_nm, grid),
    };
    let grid = like.unwrap_or(&own);
    let (incidences, bins) = (grid.incidences(), grid.bins());
    let how = format!("resampled: means over {incidences} incidences of {bins} bins, 16 directions a bin");
    let notes = std::iter::once(how).chain(left_out(&parts, grid)).collect();
    Ok((resample_spectrum(parts.iter().map(Box::as_ref), &wavelengths_nm, grid)?, notes))
}

/// The note on a side that the file knows and the wanted bins do not collect.
fn left_out(parts: &[Box<dyn Brdf>], grid: &Grid) -> Option<String> {
    let collected = [grid.looks_above(), grid.looks_below()];
    let left = |side: usize| parts.iter().any(|part| part.sides()[side]) && !collected[side];
    let what = [COMES_BACK, GONE_THROUGH].into_iter().enumerate().find(|(side, _)| left(*side))?.1;
    Some(format!("light that {what} is left out: the bins of --like do not collect it"))
}
