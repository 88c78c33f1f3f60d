//! Results of a measurement on disk and on the screen: tables, summaries, pages and cards, each with what it shows.

use std::path::Path;

use serde_json::Value;

use super::optics_text;
use super::output::{self, Output, duration, grouped, json_text, warn, with_error};
use super::report::{Sources, page_of};
use super::targets::Target;
use crate::error::Result;
use crate::files::{self, NewFile};
use crate::measure::{Cost, Measured, Plan, StopResult, StoppedBy};
use crate::report::specimen::Shown;
use crate::report::summary::summary;
use crate::report::{self, Scene, terminal};
use crate::stats;
use crate::table::realisations::{self, Kept};
use crate::table::store;
use crate::validate::schlick_error::SchlickError;
use crate::validate::{self, Prediction, Verdict};

/// What all tables of a run have in common.
pub struct Results<'a> {
    pub plan: &'a Plan,
    pub cost: &'a Cost,
    /// The tables that are written.
    pub open: &'a [&'a Target],
    /// Whether stdout is for a JSON document alone.
    pub json: bool,
}

impl Results<'_> {
    /// Writes the open tables, each with its summary, data first. `specimen` shows a patch under a table's campaign.
    pub fn write_all(
        &self,
        results: &[Measured],
        specimen: impl Fn(&Measured) -> Result<Shown>,
        out: &mut Output,
    ) -> Result<()> {
        let Results { plan, cost, json, .. } = *self;
        for (measured, target) in results.iter().filter_map(|measured| {
            // A table that was finished before may be among the results.
            self.open.iter().find(|target| target.is_of(&measured.table)).map(|target| (measured, target))
        }) {
            let Measured { table, campaign, .. } = measured;
            let prediction = Prediction::of(campaign, &table.grid);
            let verdict =
                validate::examine_against(table, campaign, Some(&measured.realisations), prediction.as_ref());
            let schlick = SchlickError::of(campaign, table);
            let mut document = summary(measured, plan, cost, &verdict);
            document["fresnel"] = output::to_json(&schlick)?;
            let specimen = specimen(measured)?;
            let sources =
                Sources { table, campaign: Some(campaign), prediction: prediction.as_ref(), specimen };
            let page = page_of(sources, &document, None);
            let kept = write(measured, &document, &page, target)?;
            verdict.failures.iter().for_each(warn);
            if !json {
                report(out, measured, plan, &verdict)?;
                out.lines(schlick.iter().flat_map(optics_text::schlick_lines))?;
                out.lines(lobes(measured, prediction.as_ref()))?;
                out.lines(files_written(target, kept))?;
            }
        }
        if json { Ok(()) } else { out.lines(cost_lines(cost)) }
    }
}

/// All files reach the disk before the first takes its place: for want of room nothing is replaced.
fn write(measured: &Measured, summary: &Value, page: &str, target: &Target) -> Result<Kept> {
    let Measured { table, realisations, .. } = measured;
    let (kept, parts) =
        realisations::staged(&target.realisations, realisations, table, realisations::SIZE_LIMIT)?;
    let card = report::card(table, summary)?;
    let first = store::staged(&target.table, table)?;
    let last = [
        NewFile::with(&target.page, page.as_bytes())?,
        NewFile::with(&target.card, card.as_bytes())?,
        NewFile::with(&target.summary, format!("{}\n", json_text(summary)?).as_bytes())?,
    ];
    // Without its summary a table counts as unfinished, whatever happens from here on; it comes last.
    files::remove(&target.summary)?;
    first.commit()?;
    parts.map_or_else(|| files::remove(&target.realisations), NewFile::commit)?;
    last.into_iter().try_for_each(NewFile::commit)?;
    Ok(kept)
}

/// The lobe in the plane of incidence, for the eye.
pub fn lobes(measured: &Measured, prediction: Option<&Prediction>) -> Vec<String> {
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
pub fn report(out: &mut Output, measured: &Measured, plan: &Plan, verdict: &Verdict) -> Result<()> {
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

/// Which files a table has.
pub fn files_written(target: &Target, kept: Kept) -> Vec<String> {
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

/// What a run has cost.
pub fn cost_lines(cost: &Cost) -> [String; 2] {
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
