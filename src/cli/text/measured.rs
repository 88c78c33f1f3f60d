//! What `measure` and `merge` print of a table: albedos, verdict, lobes, files and costs.

use std::path::Path;

use super::layout::{columns, wrapped};
use super::numbers::{bytes, duration, grouped, with_error};

use super::output::Output;
use super::{lobes, optics, verdict};
use crate::error::Result;
use crate::instrument::IncidenceAngles;
use crate::job::{TablePaths, WrittenTable};
use crate::measure::{Cost, IncidenceResult, Measured, Plan, StoppedBy};
use crate::report::Scene;
use crate::table::BrdfTable;
use crate::table::realisations::{self, StoredRealisations};
use crate::validate::{Prediction, expect};

/// All of it but the costs.
pub fn print(written: &WrittenTable, out: &mut Output) -> Result<()> {
    report(out, written)?;
    out.lines(written.schlick.iter().flat_map(optics::schlick_lines))?;
    out.lines(lobes(written))?;
    out.line("")?;
    out.lines(verdict::ruling(&written.verdict))?;
    out.lines(files_written(written.paths, written.kept))
}

/// The lobe in the plane of incidence, for the eye.
fn lobes(written: &WrittenTable) -> Vec<String> {
    let campaign = &written.measured.campaign;
    let realisations = campaign.surface.realisations as usize;
    let prediction = written.prediction.as_ref();
    let table = &written.table;
    let wanted = Some(expect::masking(campaign));
    let masking = prediction.map_or(0, |prediction| prediction.model.masking_index(wanted));
    let drawn = |table: &BrdfTable, prediction: Option<&Prediction>| {
        let lines = lobes::lobes(&Scene { table, prediction, realisations }, masking);
        if lines.is_empty() { lines } else { [vec![String::new()], lines].concat() }
    };
    if !table.grid.looks_below() {
        return drawn(table, prediction);
    }
    let side = |(below, title): (bool, &str)| {
        let Some(half) = table.half(below) else { return vec![] };
        let prediction = prediction.and_then(|prediction| prediction.half(&table.grid, below));
        [vec![String::new(), title.into()], drawn(&half, prediction.as_ref())].concat()
    };
    let through = "light that has gone through, theta_r as 180 less that of the table:";
    [(false, "light that comes back:"), (true, through)].into_iter().flat_map(side).collect()
}

/// Albedos of every incidence, and how far each model is.
fn report(out: &mut Output, written: &WrittenTable) -> Result<()> {
    let WrittenTable { measured, plan, .. } = written;
    let open_map = measured.incidences.iter().any(|incidence| incidence.left_map > 0);
    let mut headers = vec!["theta_i", "phi_i", "albedo single", "albedo total", "hidden", "cut"];
    let beyond = measured.incidences.iter().any(|incidence| incidence.beyond_order_1().0.is_some());
    headers.extend(beyond.then_some("beyond order 1"));
    headers.extend(open_map.then_some("left map"));
    headers.extend(plan.apertures_only.then_some("outside"));
    let absorbs = measured.campaign.surface.kind.has_absorbing_base();
    headers.extend(absorbs.then_some("absorbed"));
    let angles = IncidenceAngles::of(&plan.grid);
    let row = |(index, incidence): (usize, &IncidenceResult)| {
        let [theta, phi] = angles.texts(index);
        let paths = (incidence.samples * plan.sums.paths_of_a_start()) as f64 * f64::from(plan.realisations);
        let share = |count: u64| format!("{:.4} %", 100.0 * count as f64 / paths);
        let mut row = vec![
            theta,
            phi,
            albedo(incidence.single()),
            albedo(incidence.total()),
            share(incidence.hidden),
            share(incidence.cut),
        ];
        let missed = incidence.beyond_order_1();
        let none_seen = incidence.orders[1..].iter().sum::<u64>() + incidence.cut == 0;
        let beyond = |mean| if none_seen { "not seen".into() } else { with_error(mean, missed.1) };
        row.extend(missed.0.map(beyond));
        row.extend(open_map.then(|| share(incidence.left_map)));
        row.extend(plan.apertures_only.then(|| share(incidence.outside)));
        row.extend(absorbs.then(|| share(incidence.absorbed)));
        row
    };
    let rows: Vec<Vec<String>> = measured.incidences.iter().enumerate().map(row).collect();
    let alpha = match measured.campaign.alphas()[..] {
        [Some(alpha)] => format!(", alpha {}", alpha.text()),
        _ => String::new(),
    };
    out.line("")?;
    let material = measured.campaign.optics.label();
    let material = if material.is_empty() { material } else { format!(", {material}") };
    let name = &measured.campaign.name;
    let colours = match measured.table.colours.len() {
        1 => String::new(),
        count => format!("; albedos are means of {count} colours"),
    };
    out.line(format_args!("{name}{alpha}{material}: mean +- standard error over realisations{colours}"))?;
    out.lines(columns(&headers, &rows))?;
    out.lines(through_lines(measured, &angles))?;
    out.lines(optics::order_lines(measured, plan))?;
    out.lines(lost_light_line(measured, plan))?;
    out.lines(end_lines(measured, plan))?;
    out.line("")?;
    out.lines(verdict::comparisons(&written.verdict))
}

/// Light that has gone through the surface, where any can.
fn through_lines(measured: &Measured, angles: &IncidenceAngles) -> Vec<String> {
    if measured.incidences.iter().all(|incidence| incidence.through.is_empty()) {
        return vec![];
    }
    let row = |(index, incidence): (usize, &IncidenceResult)| {
        let [theta, phi] = angles.texts(index);
        vec![theta, phi, albedo(incidence.single_transmittance()), albedo(incidence.total_transmittance())]
    };
    let rows: Vec<Vec<String>> = measured.incidences.iter().enumerate().map(row).collect();
    let headers = ["theta_i", "phi_i", "through single", "through total"];
    [vec![String::new()], columns(&headers, &rows)].concat()
}

/// How much light left an open map by its edge, where any did.
fn lost_light_line(measured: &Measured, plan: &Plan) -> Vec<String> {
    let incidences =
        measured.incidences.iter().enumerate().map(|(index, incidence)| (index, incidence.lost_light[1]));
    let most = incidences.filter(|incidence| incidence.1 > 0.0).max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((index, flux)) = most else { return vec![] };
    let [theta, phi] = IncidenceAngles::of(&plan.grid).texts(index);
    let text = format!(
        "at {theta}, {phi} up to {flux:.4} of the light is missing; error bars cover where it may have gone"
    );
    wrapped("left map: ", &text)
}

/// What ended the incidences, where it was not that all samples were measured.
fn end_lines(measured: &Measured, plan: &Plan) -> Vec<String> {
    let angles = IncidenceAngles::of(&plan.grid);
    let line = |(index, incidence): (usize, &IncidenceResult)| {
        let why = match incidence.stopped_by {
            StoppedBy::Samples if measured.campaign.stop.relative_error.is_none() => return None,
            StoppedBy::Samples => "all samples measured".into(),
            StoppedBy::RelativeError => "error reached".into(),
            StoppedBy::Seconds => "time is over".into(),
            StoppedBy::PatchLimited => {
                let needed = incidence.realisations_needed.map_or("more".into(), grouped);
                format!(
                    "patch-limited: {needed} realisations would be needed, there are {}",
                    plan.realisations
                )
            }
        };
        let [theta, phi] = angles.texts(index);
        let error = incidence.relative_error.map_or(String::new(), |e| format!(", relative error {e:.4}"));
        Some(format!("incidence {theta} {phi}: {} starts a patch{error}; {why}", grouped(incidence.samples)))
    };
    measured.incidences.iter().enumerate().filter_map(line).collect()
}

/// An albedo and its standard error.
fn albedo((mean, se): (Option<f64>, Option<f64>)) -> String {
    mean.map_or_else(|| "not seen".into(), |mean| with_error(mean, se))
}

/// Which files a table has.
fn files_written(paths: &TablePaths, kept: StoredRealisations) -> Vec<String> {
    let size = |path: &Path| path.metadata().map_or(String::new(), |meta| bytes(meta.len()));
    let line = |what: &str, path: &Path| format!("{what:<14}{} ({})", path.display(), size(path));
    let limit = realisations::SIZE_LIMIT / 1_000_000;
    let realisations = match kept {
        StoredRealisations::All => line("realisations", &paths.realisations),
        StoredRealisations::Groups => {
            let groups = realisations::GROUPS;
            format!(
                "{}, in {groups} groups: all would exceed {limit} MB (--keep-realisations)",
                line("realisations", &paths.realisations)
            )
        }
        StoredRealisations::Nothing => {
            format!("{:<14}left out: they would exceed {limit} MB (--keep-realisations)", "realisations")
        }
    };
    let summary = line("summary", &paths.summary);
    vec![
        String::new(),
        line("table", &paths.table),
        realisations,
        summary,
        line("report", &paths.page),
        line("card", &paths.card),
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
    let (rays, memory) = (grouped(cost.rays_traced), bytes(cost.peak_bytes));
    [times, format!("{:<14}{rays} rays, {rate:.2} million samples/s, {memory} of memory", "work")]
}
