//! `gonio compare`: stored tables, bin by bin, with errors.

mod text;

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::table_file::{self, Opened};
use super::text::output::{Output, to_json};
use super::text::progress::Stage;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::instrument::{Grid, GridKind};
use crate::table::{BrdfTable, Realisations, TableRows};
use crate::validate::common_grid::compared;
use crate::validate::prediction::aperture::extrapolate;
use crate::validate::two_tables::{ComparedTable, TableDifference, difference_of_rows};

/// Compare tables bin by bin, with the errors of both
#[derive(Args)]
#[command(
    after_help = "Distances are relative to B. Tables of the same patches are paired by realisation.\n\
    On different grids: common incidences and wavelengths; of R, G, B next to one channel the\n\
    luminance; bins that nest are averaged, others interpolated, and the output says so.\n\
    Of three tables and more, A is compared with each of the others.\n\
    Exits with 1 where they differ by more than noise explains.\n\n\
    Example: gonio compare out/a/a.exr out/b/b.exr"
)]
pub struct Arguments {
    /// The table that is compared
    a: PathBuf,
    /// The tables that it is compared with
    #[arg(required = true, value_name = "B")]
    others: Vec<PathBuf>,
    /// A has an arm's apertures h, B half of them: print (4 B - A)/3
    #[arg(long)]
    richardson: bool,
    /// Print one JSON document: bins, l1, l1_noise, max_t, share_outside_95, made_comparable
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    if arguments.richardson {
        return match &arguments.others[..] {
            [b] => richardson(&arguments.a, b, arguments.json),
            _ => Err(Error::Usage("--richardson: two tables, A B".into())),
        };
    }
    let mut reference = None;
    let against = |b: &PathBuf| against(&arguments.a, b, &mut reference);
    let stage = Stage::begin("comparing");
    let all = arguments.others.iter().map(against).collect::<Result<Vec<_>>>()?;
    drop(stage);
    let mut out = Output::default();
    if let [found] = &all[..] {
        if arguments.json {
            out.json(&to_json(found)?)?;
        } else {
            out.lines(text::lines(found))?;
        }
        return found.disagreement().map_or(Ok(0), |why| Err(Error::Disagreement(why)));
    }
    if arguments.json {
        let row = |(path, found): (&PathBuf, &TableDifference)| -> Result<Value> {
            let mut row = to_json(found)?;
            row["file"] = json!(path);
            row["disagreement"] = json!(found.disagreement());
            Ok(row)
        };
        let tables = arguments.others.iter().zip(&all).map(row).collect::<Result<Vec<_>>>()?;
        out.json(&json!({ "a": arguments.a, "tables": tables }))?;
    } else {
        out.lines(text::lines_of_many(&arguments.a, &arguments.others, &all))?;
    }
    match all.iter().filter(|found| found.disagreement().is_some()).count() {
        0 => Ok(0),
        count => Err(Error::Disagreement(format!("{count} of {} tables differ from A", all.len()))),
    }
}

/// A against B. A is kept for the next comparison, unless it is seen at the bins of B.
fn against(a: &Path, b: &Path, kept: &mut Option<StoredTable>) -> Result<TableDifference> {
    if let Some(a) = kept {
        return match open(b)? {
            Opened::Whole(found) => a.difference(&StoredTable::of(b, *found, Some(&a.table.grid))?, b),
            Opened::Rows(_) => by_rows(&a.path, b),
        };
    }
    let (Opened::Whole(found_a), Opened::Whole(found_b)) = (open(a)?, open(b)?) else { return by_rows(a, b) };
    let (on_a, on_b) = (arms_of(&found_a.grid), arms_of(&found_b.grid));
    let first = StoredTable::of(a, *found_a, on_b.as_ref())?;
    let found = first.difference(&StoredTable::of(b, *found_b, on_a.as_ref())?, b)?;
    if on_a.is_some() {
        *kept = Some(first);
    }
    Ok(found)
}

fn richardson(a: &Path, b: &Path, as_json: bool) -> Result<u8> {
    let whole = |path| StoredTable::of(path, table_file::load_as_stored(path)?, None);
    let (first, second) = (whole(a)?, whole(b)?);
    let rows = extrapolate(first.side(), second.side()).map_err(|why| Error::format(b, why))?;
    let mut out = Output::default();
    if as_json {
        out.json(&json!({ "positions": to_json(&rows)? }))?;
    } else {
        out.lines(text::extrapolated_lines(&rows))?;
    }
    Ok(0)
}

/// A table as it is stored. Both tables must fit at once.
fn open(path: &Path) -> Result<Opened> {
    table_file::open_as_stored(path, |rows| 2 * rows.row_bytes())
}

/// The grid at which a table of half/difference angles is seen next to one of this grid.
fn arms_of(grid: &Grid) -> Option<Grid> {
    (grid.kind != GridKind::HalfDifference).then(|| grid.clone())
}

/// Tables that do not fit the memory together.
fn by_rows(a: &Path, b: &Path) -> Result<TableDifference> {
    let open = |path: &Path| {
        let rows = TableRows::open(path)?;
        let needs_all = rows.grid().kind == GridKind::HalfDifference;
        if needs_all { Err(table_file::too_large(&rows)) } else { Ok(rows) }
    };
    let (mut a, mut b) = (open(a)?, open(b)?);
    let campaigns = [&a, &b].map(|rows| table_file::campaign_if_any(rows.path(), rows.header()));
    let parts = [&a, &b].map(table_file::realisations_beside_rows);
    let ([in_a, in_b], [of_a, of_b]) = (campaigns, parts);
    let (in_a, in_b, of_a, of_b) = (in_a?, in_b?, of_a?, of_b?);
    let (campaigns, parts) = ([in_a.as_ref(), in_b.as_ref()], [of_a.as_ref(), of_b.as_ref()]);
    difference_of_rows((&mut a, &mut b), campaigns, parts, table_file::band_bytes())
}

/// A table with all that is known about it.
struct StoredTable {
    path: PathBuf,
    table: BrdfTable,
    campaign: Option<Campaign>,
    parts: Option<Realisations>,
}

impl StoredTable {
    /// The table of a file; one of half/difference angles at the incidences and bins of `grid`.
    fn of(path: &Path, stored: BrdfTable, grid: Option<&Grid>) -> Result<Self> {
        let table = table_file::arms(path, stored, grid)?;
        let campaign = table_file::campaign_if_any(path, &table)?;
        let parts = table_file::realisations_beside(path, &table)?;
        Ok(StoredTable { path: path.into(), table, campaign, parts })
    }

    fn side(&self) -> ComparedTable<'_> {
        let (campaign, parts) = (self.campaign.as_ref(), self.parts.as_ref());
        ComparedTable { campaign, parts, ..ComparedTable::of(&self.table) }
    }

    fn difference(&self, other: &Self, path: &Path) -> Result<TableDifference> {
        compared(&self.side(), &other.side()).map_err(|why| Error::format(path, why))
    }
}
