//! `gonio measure`: the main job, from the campaign to tables, summaries and a report.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::banded::Banded;
use super::optics_text;
use super::output::{self, Output, duration, grouped, json_text, say, warn, with_error};
use super::plan_text;
use super::progress::Progress;
use super::report::{Sources, page_of};
use super::targets::{self, Target};
use crate::campaign::{self, Campaign, Optics, Parsed};
use crate::error::{Error, Result};
use crate::files;
use crate::measure::{self, Cost, Measured, Patches, Plan, StopResult, StoppedBy};
use crate::report::summary::summary;
use crate::report::{self, Scene, specimen, terminal};
use crate::stats;
use crate::table::realisations::{self, Kept};
use crate::table::store;
use crate::validate::aperture::worst;
use crate::validate::schlick_error::SchlickError;
use crate::validate::{self, Prediction, Verdict};

/// Measure a campaign: table, realisations, summary and report
#[derive(Args)]
#[command(after_help = "Writes <name>.exr, <name>.realisations.exr, <name>.html (the page to look at),\n\
    <name>.card.md (where it comes from) and, last, <name>.json to the folder; several roughnesses\n\
    or materials give one set each, <name>_alpha_<value>, <name>_<material>.\n\n\
    Example: gonio measure configs/quickstart.toml --threads 2")]
pub struct Arguments {
    /// The campaign, a TOML file
    campaign: PathBuf,
    /// Folder of the results [default: out/<name>]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Seed instead of the campaign's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Worker threads, 0 for one a core; results do not depend on it
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub threads: usize,
    /// Take the patches that `gonio surface` wrote there instead of making them
    #[arg(long, value_name = "DIR")]
    patches: Option<PathBuf>,
    /// MiB that may be used; larger tables go in bands [default: half of the free]
    #[arg(long, value_name = "N")]
    memory_mb: Option<u64>,
    /// Replace results that are there
    #[arg(long)]
    force: bool,
    /// Print the summary as one JSON document (a list for several roughnesses)
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let Parsed { mut campaign, notes, .. } = campaign::read(&arguments.campaign)?;
    campaign.seed = arguments.seed.unwrap_or(campaign.seed);
    notes.iter().for_each(warn);
    arguments.plan(&campaign)?;
    let folder = targets::open_folder(arguments.output.as_deref(), &campaign)?;
    let all = Target::of(&campaign, &folder);
    for target in &all {
        targets::spare_inputs(&target.paths(), &arguments.campaign, &campaign)?;
    }
    let finished =
        all.iter().map(|target| Ok(!arguments.force && target.is_finished()?)).collect::<Result<Vec<_>>>()?;
    let open: Vec<&Target> =
        all.iter().zip(&finished).filter(|(_, done)| !**done).map(|(target, _)| target).collect();
    let mut out = Output::default();
    for target in all.iter().zip(&finished).filter(|(_, done)| **done).map(|(target, _)| target) {
        let text = format!("{} is finished: nothing to do", target.table.display());
        if arguments.json { say(text) } else { out.line(text)? }
    }
    if !open.is_empty() {
        measure_all(&of_targets(&campaign, &open), &open, arguments, &mut out)?;
    }
    if arguments.json {
        let mut summaries =
            all.iter().map(|target| read_summary(&target.summary)).collect::<Result<Vec<_>>>()?;
        let single = if summaries.len() == 1 { summaries.pop() } else { None };
        out.json(&single.unwrap_or(Value::Array(summaries)))?;
    }
    Ok(0)
}

impl Arguments {
    fn plan(&self, campaign: &Campaign) -> Result<Plan> {
        measure::plan_within(campaign, self.memory())
    }

    /// Bytes that the run may use.
    fn memory(&self) -> u64 {
        self.memory_mb.map_or_else(measure::memory_limit, |mb| mb.saturating_mul(1 << 20))
    }
}

/// The campaign with the roughnesses and materials of `open` alone. They share patches and draws: the tables stay the
/// same.
fn of_targets(campaign: &Campaign, open: &[&Target]) -> Campaign {
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

/// Measures the open tables and writes each with its summary, data first.
fn measure_all(campaign: &Campaign, open: &[&Target], arguments: &Arguments, out: &mut Output) -> Result<()> {
    let json = arguments.json;
    let plan = arguments.plan(campaign)?;
    let mut notes = Vec::new();
    let patches = match &arguments.patches {
        Some(folder) => Patches::from_folder(campaign, folder)?,
        None => Patches::prepare(campaign, &mut notes)?,
    };
    notes.iter().for_each(warn);
    if !json {
        out.lines(plan_text::facts(campaign, &plan))?;
        out.lines(worst(campaign).iter().flat_map(plan_text::aperture))?;
    }
    let progress = Progress::new(plan.total_samples, "samples");
    if plan.bands().len() > 1 {
        let job = Banded { campaign, plan: &plan, open, json, memory: arguments.memory() };
        return job.run(patches, &progress, out);
    }
    let (results, cost) = measure::measure(campaign, &plan, &patches, &|starts| progress.add(starts))?;
    progress.finish();
    for (measured, target) in results.iter().filter_map(|measured| {
        // A table that was finished before may be among the results.
        open.iter().find(|target| target.is_of(&measured.table)).map(|target| (measured, target))
    }) {
        let Measured { table, campaign, .. } = measured;
        let prediction = Prediction::of(campaign, &table.grid);
        let verdict =
            validate::examine_against(table, campaign, Some(&measured.realisations), prediction.as_ref());
        let schlick = SchlickError::of(campaign, table);
        let mut document = summary(measured, &plan, &cost, &verdict);
        document["fresnel"] = output::to_json(&schlick)?;
        let specimen = specimen::of_patches(&patches, campaign)?;
        let sources = Sources { table, campaign: Some(campaign), prediction: prediction.as_ref(), specimen };
        let page = page_of(sources, &document, None);
        let kept = write(measured, &document, &page, target)?;
        verdict.failures.iter().for_each(warn);
        if !json {
            report(out, measured, &plan, &verdict)?;
            out.lines(schlick.iter().flat_map(optics_text::schlick_lines))?;
            out.lines(lobes(measured, prediction.as_ref()))?;
            out.lines(files_written(target, kept))?;
        }
    }
    if json { Ok(()) } else { out.lines(cost_lines(&cost)) }
}

fn write(measured: &Measured, summary: &Value, page: &str, target: &Target) -> Result<Kept> {
    // Without its summary a table counts as unfinished, whatever happens from here on.
    targets::remove(&target.summary)?;
    store::save(&target.table, &measured.table)?;
    let limit = realisations::SIZE_LIMIT;
    let kept = realisations::save(&target.realisations, &measured.realisations, &measured.table, limit)?;
    if kept == Kept::Nothing {
        targets::remove(&target.realisations)?;
    }
    files::write_atomically(&target.page, page.as_bytes())?;
    let card = report::card(&measured.table, summary)?;
    files::write_atomically(&target.card, card.as_bytes())?;
    files::write_atomically(&target.summary, format!("{}\n", json_text(summary)?).as_bytes())?;
    Ok(kept)
}

fn read_summary(path: &Path) -> Result<Value> {
    let bytes = files::read(path)?;
    serde_json::from_slice(&bytes).map_err(|e| Error::format(path, format!("is no summary: {e}")))
}

/// The lobe in the plane of incidence, for the eye.
pub(super) fn lobes(measured: &Measured, prediction: Option<&Prediction>) -> Vec<String> {
    let campaign = &measured.campaign;
    let realisations = campaign.surface.realisations as usize;
    let scene = Scene { table: &measured.table, prediction, realisations };
    let masking = prediction.and_then(|prediction| {
        prediction.model.maskings().iter().position(|name| *name == validate::expect::masking(campaign))
    });
    let lines = terminal::lobes(&scene, masking.unwrap_or(0));
    if lines.is_empty() { lines } else { [vec![String::new()], lines].concat() }
}

/// Albedos of every stop, and the verdict.
pub(super) fn report(out: &mut Output, measured: &Measured, plan: &Plan, verdict: &Verdict) -> Result<()> {
    let open_map = measured.stops.iter().any(|stop| stop.left_map > 0);
    let mut headings = vec!["theta_i", "phi_i", "albedo single", "albedo total", "hidden", "cut"];
    let beyond = measured.stops.iter().any(|stop| stop.beyond_order_1().0.is_some());
    headings.extend(beyond.then_some("beyond order 1"));
    headings.extend(open_map.then_some("left map"));
    headings.extend(plan.apertures_only.then_some("outside"));
    let row = |(index, stop): (usize, &StopResult)| {
        let (theta, phi) = plan.grid.stop_deg(index);
        let starts = stop.samples as f64 * f64::from(plan.realisations);
        let share = |count: u64| format!("{:.4} %", 100.0 * count as f64 / starts);
        let single = stop.albedo_by_order[..1].iter();
        let (single, total) = (albedo(single), albedo(stop.albedo_by_order.iter()));
        let mut row = vec![
            format!("{theta:.2}"),
            format!("{phi:.2}"),
            single,
            total,
            share(stop.hidden),
            share(stop.cut),
        ];
        let missed = stop.beyond_order_1();
        row.extend(missed.0.map(|mean| with_error(mean, missed.1)));
        row.extend(open_map.then(|| share(stop.left_map)));
        row.extend(plan.apertures_only.then(|| share(stop.outside)));
        row
    };
    let rows: Vec<Vec<String>> = measured.stops.iter().enumerate().map(row).collect();
    let alpha = match measured.campaign.alphas()[..] {
        [Some(alpha)] if alpha.x == alpha.y => format!(", alpha {}", alpha.x),
        [Some(alpha)] => format!(", alpha_x {}, alpha_y {}", alpha.x, alpha.y),
        _ => String::new(),
    };
    out.line("")?;
    let material = measured.campaign.optics.label();
    let material = if material.is_empty() { material } else { format!(", {material}") };
    let name = &measured.campaign.name;
    out.line(format_args!("{name}{alpha}{material}: mean +- standard error over realisations"))?;
    out.lines(output::columns(&headings, &rows))?;
    out.lines(optics_text::order_lines(measured, plan))?;
    out.lines(end_lines(measured, plan))?;
    out.line("")?;
    out.lines(verdict.lines())
}

/// What ended the stops, where it was not that all samples were measured.
fn end_lines(measured: &Measured, plan: &Plan) -> Vec<String> {
    let line = |(index, stop): (usize, &StopResult)| {
        let why = match stop.stopped_by {
            StoppedBy::Samples if measured.campaign.stop.relative_error.is_none() => return None,
            StoppedBy::Samples => "all samples measured".into(),
            StoppedBy::RelativeError => "error reached".into(),
            StoppedBy::Seconds => "time is over".into(),
            StoppedBy::PatchLimited => {
                let needed = stop.realisations_needed.map_or("more".into(), grouped);
                format!(
                    "patch-limited: {needed} realisations would be needed, there are {}",
                    plan.realisations
                )
            }
        };
        let (theta, phi) = plan.grid.stop_deg(index);
        let error = stop.relative_error.map_or(String::new(), |e| format!(", relative error {e:.4}"));
        Some(format!("stop {theta:.2} {phi:.2}: {} starts a patch{error}; {why}", grouped(stop.samples)))
    };
    measured.stops.iter().enumerate().filter_map(line).collect()
}

/// Sum over orders, its mean over the realisations and the standard error.
fn albedo<'a>(orders: impl Iterator<Item = &'a Vec<f64>> + Clone) -> String {
    let count = orders.clone().map(Vec::len).min().unwrap_or(0);
    let sums: Vec<f64> = (0..count).map(|k| orders.clone().map(|order| order[k]).sum()).collect();
    if sums.is_empty() {
        return "not seen".into();
    }
    let (mean, se) = stats::mean_and_se(sums.into_iter());
    with_error(mean, se)
}

pub(super) fn files_written(target: &Target, kept: Kept) -> Vec<String> {
    let size = |path: &Path| path.metadata().map_or(String::new(), |meta| output::bytes(meta.len()));
    let line = |what: &str, path: &Path| format!("{what:<14}{} ({})", path.display(), size(path));
    let limit = realisations::SIZE_LIMIT / 1_000_000;
    let realisations = match kept {
        Kept::All => line("realisations", &target.realisations),
        Kept::Groups => {
            let groups = realisations::GROUPS;
            format!(
                "{}, in {groups} groups: all would exceed {limit} MB",
                line("realisations", &target.realisations)
            )
        }
        Kept::Nothing => format!("{:<14}left out: they would exceed {limit} MB", "realisations"),
    };
    let summary = line("summary", &target.summary);
    vec![
        String::new(),
        line("table", &target.table),
        realisations,
        summary,
        line("report", &target.page),
        line("card", &target.card),
    ]
}

pub(super) fn cost_lines(cost: &Cost) -> [String; 2] {
    let rate = cost.samples as f64 / cost.tracing_s.max(1e-9) / 1e6;
    let times = format!(
        "{:<14}{} ({} of it making patches), {} of processor time, {} threads",
        "time",
        duration(cost.wall_s),
        duration(cost.synthesis_s),
        duration(cost.cpu_s),
        cost.threads
    );
    let (rays, memory) = (grouped(cost.rays_traced), output::bytes(cost.peak_bytes));
    [times, format!("{:<14}{rays} rays, {rate:.2} million samples/s, {memory} of memory", "work")]
}
