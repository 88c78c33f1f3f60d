//! `gonio measure`: the main job, from the campaign to tables, summaries and a report.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use serde_json::{Value, json};

use super::process::ending;
use super::streams::folder;
use super::text::measured::cost_lines;
use super::text::numbers::bytes;
use super::text::output::{self, Output, inform, warn};
use super::text::quoted;
use super::text::terminal::Terminal;
use crate::campaign::{self, Campaign, CampaignRun, CampaignRuns};
use crate::error::{Error, Result};
use crate::job::{Measurement, SweepPaths, TablePaths, Watcher, Written, paths};
use crate::measure::{Cost, Pace, Part, Plan, RunFiles};

/// Measure a campaign: table, realisations, summary and report
#[derive(Args)]
#[command(
    after_help = "Writes <name>.exr, <name>.realisations.exr, <name>.html (the page), <name>.card.md and, last,\n\
    <name>.json; lists of roughnesses, materials, seeds or correlation lengths give one set each\n\
    (<name>_alpha_<value>, ...) and, together, <name>.sweep.csv, .nc and .html.\n\n\
    Example: gonio measure configs/quickstart.toml --threads 2"
)]
pub struct Arguments {
    /// The campaign, a TOML file
    campaign: PathBuf,
    /// Folder of the results [default: out/<name>]
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    output: Option<PathBuf>,
    /// Seed instead of the campaign's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Take the patches that `gonio surface` wrote there instead of making them
    #[arg(long, value_name = "DIR")]
    pub patches: Option<PathBuf>,
    /// MiB that may be used; larger tables go in bands [default: half the free]
    #[arg(long, value_name = "N")]
    memory_mb: Option<u64>,
    /// Measure one of N shards; `gonio merge` puts them together
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

pub fn run(arguments: &Arguments, threads: usize) -> Result<u8> {
    let CampaignRuns { mut runs, notes, .. } = campaign::read_runs(&arguments.campaign)?;
    notes.iter().for_each(warn);
    match (runs.pop(), runs.is_empty()) {
        (Some(CampaignRun { mut campaign, .. }), true) => {
            campaign.seed = arguments.seed.unwrap_or(campaign.seed);
            let (written, mut out) = arguments.measured(arguments.measurement(campaign)?, threads)?;
            match written {
                Written::Tables(all) if arguments.json => out.json(&summaries(&all)?)?,
                Written::Tables(_) => {}
                shard => arguments.print_shard(&shard, &mut out)?,
            }
        }
        (last, _) => arguments.measure_runs(runs.into_iter().chain(last).collect(), threads)?,
    }
    Ok(0)
}

fn shard_json(shard: Option<Part>, file: &Path, plan: Option<&Plan>, cost: &Cost) -> Value {
    let mut document = json!({ "shard": shard.map(|shard| shard.to_string()), "file": file });
    if let Some(plan) = plan {
        document["stops"] =
            (0..plan.incidences).map(|incidence| json!(plan.grid.incidence_deg(incidence))).collect();
        document["cost"] = json!(cost);
    }
    document
}

fn print_shard(
    file: &Path,
    (measured, incidences): (usize, usize),
    cost: &Cost,
    out: &mut Output,
) -> Result<()> {
    let size = file.metadata().map_or(0, |meta| meta.len());
    let file = format!("{} ({})", file.display(), bytes(size));
    out.line(format_args!(
        "{:<14}{file}: {measured} of {incidences} incidences; gonio merge puts all together",
        "shard"
    ))?;
    out.lines(cost_lines(cost))
}

impl Arguments {
    /// Measures one run, and gives what it has written and stdout.
    fn measured(&self, job: Measurement, threads: usize) -> Result<(Written, Output)> {
        let (files, again) = (Arc::new(job.files()), self.again(threads));
        let advice = (Arc::clone(&files), again.clone());
        ending::advise(move || before_its_end(&advice.0, &advice.1));
        let advised = |error| with_advice(error, &files, &again);
        let terminal = Terminal::new(self.json, &advised);
        let written = job.watcher(&terminal).write().map_err(advised)?;
        Ok((written, terminal.into_output()))
    }

    /// Measures one run after the other, each with patches of its own, and puts their figures together.
    fn measure_runs(&self, runs: Vec<CampaignRun>, threads: usize) -> Result<()> {
        let refused = [
            (self.shard.is_some(), "--shard", "shards are of one run"),
            (self.patches.is_some(), "--patches", "each run has patches of its own"),
            (self.seed.is_some(), "--seed", "the runs would be the same, or have seeds already"),
        ];
        if let Some((_, option, why)) = refused.iter().find(|(given, ..)| *given) {
            let count = runs.len();
            let text = format!(
                "{option} next to a list that makes {count} runs: {why}; give seed and surface.correlation_cells one number"
            );
            return Err(Error::Usage(text));
        }
        let name = runs[0].campaign.name.clone();
        let folder = paths::folder_of(self.output.as_deref(), &runs[0].campaign);
        let first = runs[0].campaign.clone();
        let labelled = |run: CampaignRun| {
            Ok((run.label.clone(), self.measurement(run.campaign)?.label(run.label).look()))
        };
        let jobs = runs.into_iter().map(labelled).collect::<Result<Vec<_>>>()?;
        let all: Vec<_> = jobs.iter().flat_map(|(_, job)| job.tables()).collect();
        let sweep = SweepPaths::of(&name, &folder, &all)
            .ok_or_else(|| Error::Internal("several runs make several tables".into()))?;
        paths::spare_inputs(&sweep.paths(), &self.campaign, &first)?;
        if !self.force {
            sweep.spare_foreign()?;
        }
        let count = jobs.len();
        for (k, (label, job)) in jobs.into_iter().enumerate() {
            inform(format_args!("run {} of {count}: {}", k + 1, label.unwrap_or_default()));
            self.measured(job, threads)?;
        }
        sweep.write(&name, &all)?;
        let terminal = Terminal::new(self.json, &|error| error);
        terminal.swept(&sweep)?;
        let mut out = terminal.into_output();
        if self.json { out.json(&summaries(&all)?) } else { Ok(()) }
    }

    /// What a shard has measured; nothing of one that was there already, but in JSON.
    fn print_shard(&self, written: &Written, out: &mut Output) -> Result<()> {
        let Written::Shard { file, plan, incidences, cost } = written else { return Ok(()) };
        match plan {
            plan if self.json => out.json(&shard_json(self.shard, file, plan.as_deref(), cost)),
            Some(plan) => print_shard(file, (plan.incidences, *incidences), cost, out),
            None => Ok(()),
        }
    }

    fn measurement<'a>(&self, campaign: Campaign) -> Result<Measurement<'a>> {
        let mut job = Measurement::new(campaign)
            .source(&self.campaign)
            .patches(self.patches.clone())
            .shard(self.shard)
            .keep_realisations(self.keep_realisations)
            .resume(self.resume)
            .force(self.force)
            .pace(pace()?);
        if let Some(folder) = &self.output {
            job = job.folder(folder);
        }
        if let Some(mb) = self.memory_mb {
            job = job.memory(mb.saturating_mul(1 << 20));
        }
        Ok(job)
    }

    /// The command that resumes this one.
    fn again(&self, threads: usize) -> String {
        let mut words = vec!["gonio measure".to_string(), quoted(&self.campaign)];
        for (option, folder) in [("-o", &self.output), ("--patches", &self.patches)] {
            words.extend(folder.iter().flat_map(|folder| [option.to_string(), quoted(folder)]));
        }
        words.extend(self.memory_mb.map(|mb| format!("--memory-mb {mb}")));
        words.extend(self.shard.map(|shard| format!("--shard {shard}")));
        words.extend(self.seed.map(|seed| format!("--seed {seed}")));
        words.extend(self.keep_realisations.then(|| "--keep-realisations".to_string()));
        words.extend((threads > 0).then(|| format!("--threads {threads}")));
        words.extend(self.force.then(|| "--force".to_string()));
        words.extend(self.json.then(|| "--json".to_string()));
        words.push("--resume".into());
        words.join(" ")
    }
}

/// The environment's word for how often finished blocks are kept, s of processor time.
const EVERY_S: &str = "GONIO_CHECKPOINT_S";

fn pace() -> Result<Pace> {
    let Some(word) = std::env::var_os(EVERY_S) else { return Ok(Pace::Rare) };
    let seconds = word.to_str().and_then(|word| word.parse::<f64>().ok());
    match seconds {
        Some(seconds) if (1e-3..=86_400.0).contains(&seconds) => Ok(Pace::Every(seconds)),
        _ => Err(Error::Usage(format!(
            "{EVERY_S} = {}: seconds of processor time between two checkpoints, 0.001 to 86400, are expected",
            quoted(&word)
        ))),
    }
}

/// An interruption with the command that resumes.
fn with_advice(error: Error, files: &RunFiles, again: &str) -> Error {
    match error {
        Error::Interrupted(when) if matches!(files.any(), Ok(Some(_))) => {
            Error::Interrupted(format!("{when}; resume with: {again}"))
        }
        Error::Interrupted(_) => Error::Interrupted("before anything was measured".into()),
        other => other,
    }
}

/// What is said where a run is ended and does not measure just then.
fn before_its_end(files: &RunFiles, again: &str) -> String {
    match files.any() {
        Ok(Some(_)) => format!("before its end; resume with: {again}"),
        _ => "before its end; nothing is kept to be resumed".into(),
    }
}

/// The summaries of finished tables: one document, or a list of them.
pub fn summaries(all: &[TablePaths]) -> Result<Value> {
    let mut summaries =
        all.iter().map(|paths| output::read_json(&paths.summary)).collect::<Result<Vec<Value>>>()?;
    let single = if summaries.len() == 1 { summaries.pop() } else { None };
    Ok(single.unwrap_or(Value::Array(summaries)))
}
