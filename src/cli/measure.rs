//! `gonio measure`: the main job, from the campaign to tables, summaries and a report.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::ending;
use super::job::MeasureJob;
use super::results::cost_lines;
use super::run_store;
use super::targets::{self, TablePaths};
use super::text::output;
use super::text::output::{Output, say, warn};
use crate::campaign::{self, Campaign, Optics, Parsed};
use crate::error::Result;
use crate::files;
use crate::files::lock::Lock;
use crate::measure;
use crate::measure::persist::shards;
use crate::measure::{Part, Plan, RunFiles};
use crate::table::realisations;

/// Measure a campaign: table, realisations, summary and report
#[derive(Args)]
#[command(
    after_help = "Writes <name>.exr, <name>.realisations.exr, <name>.html (the page), <name>.card.md and, last,\n\
    <name>.json; several roughnesses or materials give one set each, <name>_alpha_<value>, ...\n\n\
    Example: gonio measure configs/quickstart.toml --threads 2"
)]
pub struct Arguments {
    /// The campaign, a TOML file
    campaign: PathBuf,
    /// Folder of the results [default: out/<name>]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Seed instead of the campaign's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Worker threads, 0: one a core; results do not depend on it
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub threads: usize,
    /// Take the patches that `gonio surface` wrote there instead of making them
    #[arg(long, value_name = "DIR")]
    pub patches: Option<PathBuf>,
    /// MiB that may be used; larger tables go in bands [default: half the free]
    #[arg(long, value_name = "N")]
    memory_mb: Option<u64>,
    /// Measure one of N shards, whole stops; `gonio merge` puts them together
    #[arg(long, value_name = "K/N")]
    shard: Option<Part>,
    /// Keep all realisations, however large: for fit, compare and validate
    #[arg(long)]
    keep_realisations: bool,
    /// Go on with a run that was ended (Ctrl-C, a crash), to the same bytes
    #[arg(long)]
    resume: bool,
    /// Replace results that are there
    #[arg(long)]
    force: bool,
    /// Print the summary as one JSON document (a list for several roughnesses)
    #[arg(long)]
    pub json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let Parsed { mut campaign, notes, .. } = campaign::read(&arguments.campaign)?;
    campaign.seed = arguments.seed.unwrap_or(campaign.seed);
    notes.iter().for_each(warn);
    arguments.plan(&campaign)?;
    let (folder, _claim) = targets::open_folder(arguments.output.as_deref(), &campaign)?;
    let stem = arguments.shard.map_or_else(|| campaign.name.clone(), |shard| shard.file_name(&campaign.name));
    let _lock = Lock::take(&folder, &stem)?;
    let kept = RunFiles::of(&folder, &stem);
    let (again, kept_there) = (arguments.again(), kept.clone());
    ending::advise(move || run_store::advice(&kept_there, &again));
    let mut out = Output::default();
    match arguments.shard {
        Some(shard) => one_shard(arguments, campaign, shard, (&folder.join(stem), &kept), &mut out)?,
        None => whole(arguments, &campaign, (&folder, &kept), &mut out)?,
    }
    Ok(0)
}

/// Measures and writes the tables that are not there yet.
fn whole(
    arguments: &Arguments,
    campaign: &Campaign,
    (folder, kept): (&Path, &RunFiles),
    out: &mut Output,
) -> Result<()> {
    let all = TablePaths::of(campaign, folder);
    for target in &all {
        targets::spare_inputs(&target.paths(), &arguments.campaign, campaign)?;
    }
    let finished =
        all.iter().map(|target| Ok(!arguments.force && target.is_finished()?)).collect::<Result<Vec<_>>>()?;
    let open: Vec<&TablePaths> =
        all.iter().zip(&finished).filter(|(_, done)| !**done).map(|(target, _)| target).collect();
    for target in all.iter().zip(&finished).filter(|(_, done)| **done).map(|(target, _)| target) {
        let text = format!("{} is finished: nothing to do", target.table.display());
        if arguments.json { say(text) } else { out.line(text)? }
    }
    if open.is_empty() {
        kept.remove_finished(campaign, None)?;
    } else {
        let found = run_store::find(kept, arguments.resume, arguments.force)?;
        let measured = run_store::measured(&found, &all, open.clone());
        let job = MeasureJob { arguments, files: kept, campaign: of_targets(campaign, &measured) };
        found.check(&job.campaign, None, &arguments.campaign)?;
        let plan = if found.headers().next().is_some() {
            // Whatever memory is free by now.
            measure::resumed(&job.campaign, found.band_stops(), arguments.memory())?
        } else {
            arguments.plan(&job.campaign)?
        };
        job.run_to_tables(found, &plan, &open, out)?;
        kept.remove()?;
    }
    if arguments.json { out.json(&summaries(&all)?) } else { Ok(()) }
}

/// Measures the stops of one shard, and keeps their sums for `gonio merge`.
fn one_shard(
    arguments: &Arguments,
    campaign: Campaign,
    shard: Part,
    (path, kept): (&Path, &RunFiles),
    out: &mut Output,
) -> Result<()> {
    targets::spare_inputs(&[path], &arguments.campaign, &campaign)?;
    if !arguments.force && files::is_there(path) {
        let there =
            shards::open(path).map_err(|e| targets::in_the_way(path, &format!("is no shard ({e})")))?;
        let faults = there.header.faults(
            (&campaign, Some(shard)),
            &arguments.campaign.display().to_string(),
            "this file",
        );
        if faults.is_empty() && there.header.is_of_all(&campaign) {
            kept.remove_finished(&campaign, Some(shard))?;
            let text = format!("{} is finished: nothing to do", path.display());
            return if arguments.json {
                out.json(&json!({ "shard": shard.to_string(), "file": path }))
            } else {
                out.line(text)
            };
        }
        return Err(targets::in_the_way(path, "was measured by another campaign, version or seed"));
    }
    let found = run_store::find(kept, arguments.resume, arguments.force)?;
    found.check(&campaign, Some(shard), &arguments.campaign)?;
    let job = MeasureJob { arguments, files: kept, campaign };
    let plan = arguments.plan(&job.campaign)?;
    job.run(found, &plan, out)?;
    kept.remove()?;
    let cost = shards::open(path)?.header.cost();
    if arguments.json {
        let stops: Vec<_> = (0..plan.stops).map(|stop| plan.grid.stop_deg(stop)).collect();
        return out.json(&json!({ "shard": shard.to_string(), "file": path, "stops": stops, "cost": cost }));
    }
    let size = path.metadata().map_or(0, |meta| meta.len());
    let (measured, stops) = (plan.stops, measure::stops(&job.campaign));
    let file = format!("{} ({})", path.display(), output::bytes(size));
    out.line(format_args!(
        "{:<14}{file}: {measured} of {stops} stops; gonio merge puts all together",
        "shard"
    ))?;
    out.lines(cost_lines(&cost))
}

impl Arguments {
    fn plan(&self, campaign: &Campaign) -> Result<Plan> {
        measure::plan_of(campaign, self.shard, self.memory())
    }

    /// Bytes that the run may use.
    pub fn memory(&self) -> u64 {
        self.memory_mb.map_or_else(measure::memory_limit, |mb| mb.saturating_mul(1 << 20))
    }

    /// Bytes that a file of realisations may take.
    pub fn realisations_limit(&self) -> u64 {
        realisations::limit(self.keep_realisations)
    }

    /// The command that goes on with this one.
    pub fn again(&self) -> String {
        let mut words = vec!["gonio measure".to_string(), run_store::quoted(&self.campaign)];
        let folders = [("-o", &self.output), ("--patches", &self.patches)];
        for (option, folder) in
            folders.into_iter().filter_map(|(option, folder)| Some((option, folder.as_ref()?)))
        {
            words.extend([option.to_string(), run_store::quoted(folder)]);
        }
        words.extend(self.memory_mb.map(|mb| format!("--memory-mb {mb}")));
        words.extend(self.shard.map(|shard| format!("--shard {shard}")));
        words.extend(self.seed.map(|seed| format!("--seed {seed}")));
        words.extend(self.keep_realisations.then(|| "--keep-realisations".to_string()));
        words.extend((self.threads > 0).then(|| format!("--threads {}", self.threads)));
        words.extend(self.force.then(|| "--force".to_string()));
        words.extend(self.json.then(|| "--json".to_string()));
        words.push("--resume".into());
        words.join(" ")
    }
}

/// The campaign with the roughnesses and materials of `open` alone. They share patches and draws: the tables stay the
/// same.
fn of_targets(campaign: &Campaign, open: &[&TablePaths]) -> Campaign {
    let mut some = campaign.clone();
    if let Some(alphas) = some.surface.kind.alphas_mut() {
        alphas.retain(|alpha| open.iter().any(|target| target.alpha == Some(*alpha)));
    }
    if let Optics::Several(all) = &mut some.optics {
        all.retain(|optics| open.iter().any(|target| target.optics == *optics));
        if let [one] = &all[..] {
            some.optics = one.clone();
        }
    }
    some
}

/// The summaries of finished tables: one document, or a list of them.
pub fn summaries(all: &[TablePaths]) -> Result<Value> {
    let mut summaries =
        all.iter().map(|target| output::read_json(&target.summary)).collect::<Result<Vec<Value>>>()?;
    let single = if summaries.len() == 1 { summaries.pop() } else { None };
    Ok(single.unwrap_or(Value::Array(summaries)))
}
