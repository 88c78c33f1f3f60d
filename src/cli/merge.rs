//! `gonio merge`: shards into the tables of the run that was dealt to them.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::measure::summaries;
use super::output::{Output, say, warn};
use super::results::Results;
use super::targets::{self, Target};
use crate::campaign;
use crate::error::{Error, Result};
use crate::files::lock::Lock;
use crate::measure::{self, Plan, Shard, Shards, shards};
use crate::report::specimen;

/// Put the shards of a campaign together: the very bytes of one run
#[derive(Args)]
#[command(
    after_help = "Writes what `gonio measure` writes without --shard. With --partial what is there is merged: tables\n\
    <name>_partial with the stops of these shards alone, each with all its samples and errors.\n\n\
    Example: gonio merge out/night -o out/night"
)]
pub struct Arguments {
    /// Folders with shards (<name>.shard_<K>_of_<N>), or their files
    #[arg(required = true, value_name = "DIR")]
    from: Vec<PathBuf>,
    /// Folder of the results [default: out/<name>]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Merge what is there, though shards are missing
    #[arg(long)]
    partial: bool,
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
            let kept = shards::load(&path)?;
            found.push((path, kept));
        }
    }
    let shards = Shards::new(found)?;
    let folder = shards.path().parent().unwrap_or(Path::new(""));
    let mut campaign =
        campaign::parse(shards.campaign(), &shards.path().display().to_string(), folder)?.campaign;
    let plan = measure::plan(&campaign)?;
    if plan.bands().len() > 1 {
        let what = "the whole table does not fit the memory that is free: merging in bands is not there";
        return Err(Error::Refused(format!("{}: {what}", campaign.name)));
    }
    let missing = missing(&shards, &plan, arguments.partial)?;
    let part = (!missing.is_empty()).then(|| shards.stops(&plan.grid));
    let mut ledger = shards.ledger(&campaign, &plan)?;
    let mut plan = plan;
    if let Some(stops) = part {
        warn(format_args!(
            "{} of {} stops: {} missing; no other stop is in the tables",
            stops.len(),
            plan.stops,
            names(&missing)
        ));
        plan = plan.of_stops(&stops).ok_or_else(|| Error::Internal("half vectors in a campaign".into()))?;
        ledger = ledger.with_stops(&stops);
        campaign.name = format!("{}_partial", campaign.name);
    }
    let mut tables = Some(measure::tables(&campaign, &plan, ledger));
    let folder = targets::open_folder(arguments.output.as_deref(), &campaign)?;
    let _lock = Lock::take(&folder.join(format!("{}.lock", campaign.name)))?;
    let all = Target::of(&campaign, &folder);
    let open = open(&all, arguments, !missing.is_empty())?;
    let mut out = Output::default();
    let whole = |_| tables.take().ok_or_else(|| Error::Internal("one run in two bands".into()));
    let results = Results { plan: &plan, open: &open, json: arguments.json, memory: measure::memory_limit() };
    results.write_all(whole, |table| specimen::remade(&table.campaign), &mut out)?;
    if arguments.json {
        let numbers: Vec<String> = missing.iter().map(Shard::to_string).collect();
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
fn missing(shards: &Shards, plan: &Plan, partial: bool) -> Result<Vec<Shard>> {
    if shards.of() as usize > plan.stops {
        let what = format!("is one of {} shards, the campaign has {} stops", shards.of(), plan.stops);
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

fn names(missing: &[Shard]) -> String {
    let names: Vec<String> = missing.iter().take(20).map(Shard::to_string).collect();
    let more = if missing.len() > names.len() {
        format!(" and {} more", missing.len() - names.len())
    } else {
        String::new()
    };
    format!("{}{more} {}", names.join(", "), if missing.len() == 1 { "is" } else { "are" })
}

/// The tables that are not there yet. Those of some of the shards give way to those of more.
fn open<'a>(all: &'a [Target], arguments: &Arguments, partial: bool) -> Result<Vec<&'a Target>> {
    let mut open = Vec::new();
    for target in all {
        if arguments.force || !target.is_finished()? || partial {
            open.push(target);
        } else {
            say(format_args!("{} is finished: nothing to do", target.table.display()));
        }
    }
    Ok(open)
}
