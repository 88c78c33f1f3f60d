//! What a verb reads of a stored table: the table, its campaign, and its realisations next to it.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use super::text::output::{note, warn};
use crate::campaign::{self, Campaign};
use crate::error::{Error, Result};
use crate::instrument::{Grid, GridKind};
use crate::interchange::content::half_difference;
use crate::measure::memory_limit;
use crate::table::{BrdfTable, Realisations, TableRows, realisations, store};

/// The table in a file; what is odd about it goes to stderr. One of half/difference angles comes as incidences and bins.
pub fn load(path: &Path) -> Result<BrdfTable> {
    arms(path, load_as_stored(path)?, None)
}

/// A table with incidences and bins: those of `grid`, or the usual ones, where it has half/difference angles.
pub fn arms(path: &Path, table: BrdfTable, grid: Option<&Grid>) -> Result<BrdfTable> {
    let arms = half_difference::as_arms(&table, grid).map_err(|why| Error::format(path, why))?;
    if let Some(arms) = &arms {
        note(format_args!(
            "{} has half/difference angles, in which a pair and its exchange are one value (reciprocal as it \
             stands); taken as means over {} incidences of {} bins",
            path.display(),
            arms.grid.incidences(),
            arms.grid.bins()
        ));
    }
    Ok(arms.unwrap_or(table))
}

/// The table in a file, whatever its geometry. Refused where its values do not fit the memory.
pub fn load_as_stored(path: &Path) -> Result<BrdfTable> {
    match open_as_stored(path, TableRows::row_bytes)? {
        Opened::Whole(table) => Ok(*table),
        Opened::Rows(rows) => Err(too_large(&rows)),
    }
}

/// A table as it can be had.
pub enum Opened {
    /// In memory.
    Whole(Box<BrdfTable>),
    /// Too large for that: a band of incidences at a time.
    Rows(Box<TableRows>),
}

/// Opens a table: whole where memory holds as many bytes for every incidence as `row_bytes` says.
pub fn open_as_stored(path: &Path, row_bytes: fn(&TableRows) -> u64) -> Result<Opened> {
    let rows = TableRows::open(path)?;
    for warning in rows.warnings() {
        warn(format_args!("{}: {warning}", path.display()));
    }
    let kept = row_bytes(&rows).saturating_mul(rows.grid().incidences() as u64);
    if kept.max(rows.reading_bytes()) > memory_limit() {
        return Ok(Opened::Rows(Box::new(rows)));
    }
    Ok(Opened::Whole(Box::new(store::load(path)?.table)))
}

/// As [`open_as_stored`]; half/difference angles come as incidences and bins, whole.
pub fn open(path: &Path, row_bytes: fn(&TableRows) -> u64) -> Result<Opened> {
    match open_as_stored(path, row_bytes)? {
        Opened::Whole(table) => arms(path, *table, None).map(Box::new).map(Opened::Whole),
        Opened::Rows(rows) if rows.grid().kind == GridKind::HalfDifference => Err(too_large(&rows)),
        Opened::Rows(rows) => Ok(Opened::Rows(rows)),
    }
}

/// The refusal of a table that a verb needs whole.
pub fn too_large(rows: &TableRows) -> Error {
    Error::Refused(format!(
        "{}: {} incidences of {} bins take {} MiB of memory, {} MiB may be used; validate, report, compare and export \
         --to npy or csv take it by rows",
        rows.path().display(),
        rows.grid().incidences(),
        rows.grid().bins(),
        rows.bytes() >> 20,
        memory_limit() >> 20
    ))
}

/// What a band of incidences may take, with what is made of it.
pub fn band_bytes() -> u64 {
    memory_limit() / 4
}

/// The campaign of a table that may have none: an imported one.
pub fn campaign_if_any(path: &Path, table: &BrdfTable) -> Result<Option<Campaign>> {
    if table.campaign.is_empty() { Ok(None) } else { campaign_of(path, table).map(Some) }
}

/// The campaign that the table was measured by. Its faults are faults of the table's file.
pub fn campaign_of(path: &Path, table: &BrdfTable) -> Result<Campaign> {
    if table.campaign.is_empty() {
        return Err(Error::format(path, "holds no campaign: what it should agree with is not known"));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    match campaign::parse(&table.campaign, "campaign", folder) {
        Ok(parsed) => Ok(parsed.campaign),
        Err(error @ Error::Campaign(_)) => Err(Error::format(path, error.to_string())),
        Err(error) => Err(error),
    }
}

/// Where the realisations of a table lie.
pub fn realisations_path(table: &Path) -> PathBuf {
    let stem = table.file_stem().unwrap_or_default().to_string_lossy();
    table.with_file_name(format!("{stem}.realisations.exr"))
}

/// The table's realisations, where they lie next to it.
pub fn realisations_beside(path: &Path, table: &BrdfTable) -> Result<Option<Realisations>> {
    beside_of(path, &table.campaign, || store::digest(table))
}

/// A table in memory, whose realisations are read when they are first asked for.
pub struct Beside<'a> {
    /// Where it lies.
    pub path: &'a Path,
    /// The table.
    pub table: &'a BrdfTable,
    found: OnceCell<Option<Realisations>>,
}

impl<'a> Beside<'a> {
    /// Of a table that is not looked for yet.
    pub fn new(path: &'a Path, table: &'a BrdfTable) -> Self {
        Beside { path, table, found: OnceCell::new() }
    }

    /// The realisations, where they lie next to the table.
    pub fn get(&self) -> Result<Option<&Realisations>> {
        if let Some(found) = self.found.get() {
            return Ok(found.as_ref());
        }
        let found = realisations_beside(self.path, self.table)?;
        Ok(self.found.get_or_init(|| found).as_ref())
    }
}

/// The realisations of a table that is read by rows.
pub fn realisations_beside_rows(rows: &TableRows) -> Result<Option<Realisations>> {
    beside_of(rows.path(), &rows.header().campaign, || Ok(rows.digest().unwrap_or_default().to_string()))
}

/// Those of the table at `path`, which was measured by this `campaign`.
// Tested by `realisations_without_some_of_their_parts_are_refused` (tests/it/cli.rs).
fn beside_of(
    path: &Path,
    campaign: &str,
    digest: impl FnOnce() -> Result<String>,
) -> Result<Option<Realisations>> {
    let beside = realisations_path(path);
    if !beside.is_file() {
        note(format_args!(
            "{} is absent: nothing is paired over realisations, no interval, no test of reciprocity (measure \
             --keep-realisations keeps them at any size)",
            beside.display()
        ));
        return Ok(None);
    }
    let file = realisations::load(&beside)?;
    for warning in &file.warnings {
        warn(format_args!("{}: {warning}", beside.display()));
    }
    if !file.is_of(&digest()?) {
        warn(format_args!("{} belongs to another table and is not used", beside.display()));
        return Ok(None);
    }
    let (parts, of) = (file.realisations.parts.len(), file.group_size);
    let wanted =
        campaign::parse(campaign, "campaign", path).ok().map(|parsed| parsed.campaign.surface.realisations);
    if wanted.is_some_and(|wanted| parts.checked_mul(of) != Some(wanted as usize)) {
        let wanted = wanted.unwrap_or_default();
        let what = format!(
            "holds {parts} parts of {of} realisations, the table has {wanted}; measure it again, or move it away"
        );
        return Err(Error::format(&beside, what));
    }
    Ok(Some(file.realisations))
}
