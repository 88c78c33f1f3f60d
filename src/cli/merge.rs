//! `gonio merge`: shards into the tables of the run that was dealt to them.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::measure::summaries;
use super::streams::folder;
use super::text::output::{inform, warn};
use super::text::terminal::Terminal;
use crate::campaign;
use crate::error::{Error, Result};
use crate::files::lock::Lock;
use crate::job::{self, SweepPaths, TablePaths, TableWriting, Watcher, paths};
use crate::measure::persist::shards;
use crate::measure::{self, Disk, Merge, Part, Shards};
use crate::report::html::specimen::FirstPatch;
use crate::table::realisations;

/// Put the shards of a campaign together: the very bytes of one run
#[derive(Args)]
#[command(
    after_help = "Writes what `gonio measure` writes without --shard. With --partial what is there is merged: tables\n\
    <name>_partial with the incidences of these shards alone, each with all its samples and errors.\n\n\
    Example: gonio merge out/night -o out/night"
)]
pub struct Arguments {
    /// Folders with shards (<name>.shard_<K>_of_<N>), or their files
    #[arg(required = true, value_name = "DIR")]
    from: Vec<PathBuf>,
    /// Folder of the results [default: out/<name>]
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    output: Option<PathBuf>,
    /// Merge what is there, though shards are missing
    #[arg(long)]
    partial: bool,
    /// MiB that may be used; larger tables go in bands [default: half the free]
    #[arg(long, value_name = "N")]
    memory_mb: Option<u64>,
    /// Keep every realisation, however large their file
    #[arg(long)]
    keep_realisations: bool,
    /// Replace results that are there
    #[arg(long)]
    force: bool,
    /// Print the summary as one JSON document (a list for several roughnesses)
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let mut found = Vec::new();
    for at in &arguments.from {
        for path in shards::find(at)? {
            found.push(shards::open(&path)?);
        }
    }
    let shards = Shards::new(found)?;
    let folder = shards.path().parent().unwrap_or(Path::new(""));
    let mut campaign =
        campaign::parse(shards.campaign(), &shards.path().display().to_string(), folder)?.campaign;
    let incidences = measure::incidences(&campaign);
    let missing = missing(&shards, incidences, arguments.partial)?;
    let memory = arguments.memory_mb.map_or_else(measure::memory_limit, |mb| mb.saturating_mul(1 << 20));
    let merge = Merge::of_shards(shards, &campaign, memory)?;
    if !missing.is_empty() {
        let there = merge.incidences().len();
        let missing = names(&missing);
        warn(format_args!(
            "{there} of {incidences} incidences: {missing} missing; no other incidence is in the tables"
        ));
        campaign.name = format!("{}_partial", campaign.name);
    }
    let (folder, _claim) = paths::open_folder(arguments.output.as_deref(), &campaign)?;
    let _lock = Lock::take(&folder, &campaign.name)?;
    let all = TablePaths::of(&campaign, &folder);
    let unchanged = |error| error;
    let terminal = Terminal::new(arguments.json, &unchanged);
    let open = open(&all, (arguments, !missing.is_empty()), &terminal)?;
    let realisations_limit = realisations::limit(arguments.keep_realisations);
    job::realisations_fit(Disk::of(&campaign, merge.plan(), realisations_limit), memory)?;
    let writing =
        TableWriting { plan: merge.plan(), open: &open, memory, realisations_limit, watcher: &terminal };
    let first = FirstPatch::default();
    writing.write(|incidences| merge.tables(&campaign, incidences), |table| first.remade(&table.campaign))?;
    if let Some(sweep) = SweepPaths::of(&campaign.name, &folder, &all) {
        if !arguments.force {
            sweep.spare_foreign()?;
        }
        sweep.write(&campaign.name, &all)?;
        terminal.swept(&sweep)?;
    }
    let mut out = terminal.into_output();
    if arguments.json {
        let numbers: Vec<String> = missing.iter().map(Part::to_string).collect();
        let document = summaries(&all)?;
        out.json(&if numbers.is_empty() {
            document
        } else {
            json!({ "missing": numbers, "tables": document })
        })?;
    }
    Ok(0)
}

/// The shards that are missing, which must be allowed.
fn missing(shards: &Shards, incidences: usize, partial: bool) -> Result<Vec<Part>> {
    if shards.of() as usize > incidences {
        let what = format!("is one of {} shards, the campaign has {incidences} incidences", shards.of());
        return Err(Error::format(shards.path(), what));
    }
    let missing = shards.missing();
    if missing.is_empty() || partial {
        return Ok(missing);
    }
    let what = format!(
        "{} of {} shards are there, {} missing; --partial merges what is there",
        shards.count(),
        shards.of(),
        names(&missing)
    );
    Err(Error::format(shards.path(), what))
}

fn names(missing: &[Part]) -> String {
    let names: Vec<String> = missing.iter().take(20).map(Part::to_string).collect();
    let more = if missing.len() > names.len() {
        format!(" and {} more", missing.len() - names.len())
    } else {
        String::new()
    };
    format!("{}{more} {}", names.join(", "), if missing.len() == 1 { "is" } else { "are" })
}

/// The tables that are not there yet. Those of some of the shards give way to those of more.
fn open<'a>(
    all: &'a [TablePaths],
    (arguments, partial): (&Arguments, bool),
    terminal: &Terminal,
) -> Result<Vec<&'a TablePaths>> {
    let mut open = Vec::new();
    for table in all {
        if arguments.force || !table.is_finished(terminal)? || partial {
            open.push(table);
        } else {
            inform(format_args!("{} is finished: nothing to do", table.table.display()));
        }
    }
    Ok(open)
}
