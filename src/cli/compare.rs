//! `gonio compare`: two stored tables, bin by bin, with errors.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::table_file::{self, Opened};
use super::text::layout::columns;
use super::text::numbers::or_na;
use super::text::output::{Output, to_json};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::instrument::{Grid, GridKind};
use crate::table::{BrdfTable, Realisations, TableRows};
use crate::validate::prediction::aperture::{Extrapolated, extrapolate};
use crate::validate::two_tables::{
    ComparedTable, DifferenceFigures, TableDifference, difference, difference_of_rows,
};

/// Compare two tables on the same grid bin by bin, with the errors of both
#[derive(Args)]
#[command(
    after_help = "Distances are relative to B. Tables of the same patches are paired by realisation.\n\
    Exits with 1 where they differ by more than noise explains.\n\n\
    Example: gonio compare out/a/a.exr out/b/b.exr"
)]
pub struct Arguments {
    /// The table that is compared
    a: PathBuf,
    /// The table that it is compared with
    b: PathBuf,
    /// A has an arm's apertures h, B half of them: print (4 B - A)/3
    #[arg(long)]
    richardson: bool,
    /// Print one JSON document: bins, l1, l1_noise, max_t, share_outside_95
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    // Both tables must fit at once.
    let open = |path: &Path| table_file::open_as_stored(path, |rows| 2 * rows.row_bytes());
    let (a, b) = match (open(&arguments.a)?, open(&arguments.b)?) {
        (Opened::Whole(a), Opened::Whole(b)) => (a, b),
        _ => return by_rows(arguments),
    };
    // Where only one has half/difference angles, it is seen at the stops and bins of the other.
    let other = |grid: &Grid| (grid.kind != GridKind::HalfDifference).then(|| grid.clone());
    let (grid_a, grid_b) = (other(&a.grid), other(&b.grid));
    let a = Read::of(&arguments.a, table_file::arms(&arguments.a, *a, grid_b.as_ref())?)?;
    let b = Read::of(&arguments.b, table_file::arms(&arguments.b, *b, grid_a.as_ref())?)?;
    let mut out = Output::default();
    if arguments.richardson {
        let rows = extrapolate(a.side(), b.side()).map_err(|why| Error::format(&arguments.b, why))?;
        if arguments.json {
            out.json(&json!({ "positions": to_json(&rows)? }))?;
        } else {
            out.lines(extrapolated_lines(&rows))?;
        }
        return Ok(0);
    }
    let found = difference(a.side(), b.side()).map_err(|why| Error::format(&arguments.b, why))?;
    say_difference(&mut out, &found, arguments.json)
}

fn say_difference(out: &mut Output, found: &TableDifference, json: bool) -> Result<u8> {
    if json {
        out.json(&to_json(found)?)?;
    } else {
        out.lines(lines(found))?;
    }
    found.disagreement().map_or(Ok(0), |why| Err(Error::Disagreement(why)))
}

/// Tables that do not fit the memory together.
fn by_rows(arguments: &Arguments) -> Result<u8> {
    let open = |path: &Path| {
        let rows = TableRows::open(path)?;
        let needs_all = arguments.richardson || rows.grid().kind == GridKind::HalfDifference;
        if needs_all { Err(table_file::too_large(&rows)) } else { Ok(rows) }
    };
    let (mut a, mut b) = (open(&arguments.a)?, open(&arguments.b)?);
    let campaigns = [&a, &b].map(|rows| table_file::campaign_if_any(rows.path(), rows.header()));
    let parts = [&a, &b].map(table_file::realisations_beside_rows);
    let ([in_a, in_b], [of_a, of_b]) = (campaigns, parts);
    let (in_a, in_b, of_a, of_b) = (in_a?, in_b?, of_a?, of_b?);
    let (campaigns, parts) = ([in_a.as_ref(), in_b.as_ref()], [of_a.as_ref(), of_b.as_ref()]);
    let found = difference_of_rows((&mut a, &mut b), campaigns, parts, table_file::band_bytes())?;
    say_difference(&mut Output::default(), &found, arguments.json)
}

/// A table with all that is known about it.
struct Read {
    table: BrdfTable,
    campaign: Option<Campaign>,
    parts: Option<Realisations>,
}

impl Read {
    fn of(path: &Path, table: BrdfTable) -> Result<Self> {
        let campaign = table_file::campaign_if_any(path, &table)?;
        let parts = table_file::realisations_beside(path, &table)?;
        Ok(Read { table, campaign, parts })
    }

    fn side(&self) -> ComparedTable<'_> {
        ComparedTable { table: &self.table, campaign: self.campaign.as_ref(), parts: self.parts.as_ref() }
    }
}

fn extrapolated_lines(rows: &[Extrapolated]) -> Vec<String> {
    let several = rows.iter().any(|row| row.colour > 0);
    let cells = |row: &Extrapolated| {
        let angles = [row.theta_i_deg, row.phi_i_deg, row.theta_r_deg, row.phi_r_deg];
        let mut cells = angles.map(|angle| angle.to_string()).to_vec();
        if several {
            cells.push(["R", "G", "B"][row.colour.min(2)].into());
        }
        cells.extend([row.wide, row.narrow, row.extrapolated].map(|value| format!("{value:.6}")));
        cells.push(or_na(row.extrapolated_se, 6));
        cells
    };
    let mut head = vec!["theta_i", "phi_i", "theta_r", "phi_r"];
    if several {
        head.push("colour");
    }
    head.extend(["A", "B", "(4 B - A)/3", "+-"]);
    let mut lines = vec!["BRDF, 1/sr, extrapolated to apertures of 0:".to_string()];
    lines.extend(columns(&head, &rows.iter().map(cells).collect::<Vec<_>>()));
    lines
}

/// What the column "without it" means, and how far off it may be.
fn interval(figures: &DifferenceFigures) -> Option<String> {
    let (low, high) = figures.l1_difference_low.zip(figures.l1_difference_high)?;
    Some(match figures.l1_difference {
        Some(_) => {
            format!("without it: l1 without noise, by realisations; 95 % interval {low:.5} to {high:.5}")
        }
        None => {
            "without it: on average between l1 - noise and l1; neither table has 4 realisations to say more"
                .into()
        }
    })
}

fn lines(found: &TableDifference) -> Vec<String> {
    let errors = if found.paired { "paired by realisation" } else { "of both tables in quadrature" };
    let mut lines =
        vec![format!("{} bins of all orders, errors {errors}; distances relative to B:", found.bins)];
    let cells = |figures: &DifferenceFigures| {
        let share = figures.share_outside_95.map(|share| 100.0 * share);
        vec![
            or_na(figures.l1, 5),
            or_na(figures.l1_noise, 5),
            figures.shown(),
            or_na(figures.max_t, 2),
            or_na(share, 1),
        ]
    };
    let row = |head: [String; 2], figures: &DifferenceFigures| [head.to_vec(), cells(figures)].concat();
    let mut rows: Vec<Vec<String>> = found
        .stops
        .iter()
        .map(|stop| row([stop.theta_i_deg.to_string(), stop.phi_i_deg.to_string()], &stop.figures))
        .collect();
    rows.push(row(["all".into(), String::new()], &found.figures));
    lines.extend(columns(&["theta_i", "phi_i", "l1", "noise", "without it", "max t", "% outside 95"], &rows));
    lines.extend(interval(&found.figures));
    if let (Some((limit, most)), None) = (found.t_limit.zip(found.figures.max_t), found.disagreement()) {
        let bins = found.bins;
        lines.push(format!("largest t {most:.2}, 1 % limit of {bins} bins {limit:.2}: noise explains it"));
    }
    lines
}
