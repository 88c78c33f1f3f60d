//! `gonio bench --against` and `--cells`: one table by two ways, and cost against size.

use serde_json::json;

use crate::bench;
use crate::bench::{Against, Other, Scale, scale};
use crate::campaign::Campaign;
use crate::cli::text::layout::columns;
use crate::cli::text::numbers::{grouped, or_na};
use crate::cli::text::output::{Output, inform, to_json};
use crate::cli::text::progress::RunProgress;
use crate::error::Result;
use crate::instrument::IncidenceAngles;

/// Measures a campaign as planned and by another way.
pub fn against(campaign: &Campaign, other: Other, replicates: u32, json: bool) -> Result<u8> {
    let plans = bench::against::plans(campaign, other, replicates)?;
    let progress = RunProgress::new(
        plans.iter().map(|plan| plan.total_samples * u64::from(replicates)).sum(),
        "samples",
    );
    let found = bench::against(campaign, other, replicates, &|starts| progress.add(starts))?;
    progress.finish();
    let mut out = Output::default();
    if json {
        let mut answer = to_json(&found)?;
        answer["name"] = json!(campaign.name);
        answer["against"] = json!(other);
        out.json(&answer)?;
        return Ok(0);
    }
    let [plan, _] = &plans;
    let samples = grouped(plan.samples);
    out.line(format_args!(
        "{}: as planned and by `{other}`, {replicates} runs each of {samples} starts per incidence and patch,",
        campaign.name
    ))?;
    out.line(format_args!(
        "over the same {} patches, azimuths and bins; medians over the bins above 1 % of their incidence's peak",
        plan.realisations
    ))?;
    out.line("noise: relative standard error of a run that more starts take down; error: the patches' too")?;
    out.line("")?;
    out.lines(incidences(&found, other))?;
    out.line("")?;
    out.lines(ways(&found))?;
    out.line("")?;
    let se = found.ratio_se.map_or(String::new(), |se| format!(" +- {se:.2}"));
    out.line(format_args!(
        "variance      {:.2} times as large by `{other}` at the same starts",
        found.variance_ratio
    ))?;
    out.line(format_args!(
        "time          {:.2}{se} times as long by `{other}` for the same error",
        found.ratio
    ))?;
    Ok(0)
}

fn incidences(found: &Against, other: Other) -> Vec<String> {
    let headers = ["theta_i", "phi_i", "bins", "noise", &format!("by {other}"), "variance ratio"];
    let angles = IncidenceAngles::new(
        found.incidences.iter().map(|incidence| (incidence.theta_i_deg, incidence.phi_i_deg)),
    );
    let row = |(index, incidence): (usize, &bench::against::IncidenceNoise)| {
        let [plan, other] = incidence.noise;
        let [theta, phi] = angles.texts(index);
        vec![
            theta,
            phi,
            incidence.bins.to_string(),
            format!("{plan:.5}"),
            format!("{other:.5}"),
            format!("{:.2}", (other / plan).powi(2)),
        ]
    };
    columns(&headers, &found.incidences.iter().enumerate().map(row).collect::<Vec<_>>())
}

fn ways(found: &Against) -> Vec<String> {
    let target = format!("cpu s to {} %", 100.0 * found.target);
    let headers = ["way", "Mrays", "cpu s", "error", "noise", &target];
    let row = |way: &bench::against::Variant| {
        vec![
            way.name.into(),
            format!("{:.1}", way.rays as f64 / 1e6),
            format!("{:.3}", way.cpu_s),
            format!("{:.5}", way.error),
            format!("{:.5}", way.noise),
            format!("{:.3}", way.to_target_s),
        ]
    };
    columns(&headers, &found.ways.iter().map(row).collect::<Vec<_>>())
}

/// Measures the incidences of a campaign on patches of several sizes.
pub fn sizes(campaign: &Campaign, sides: &[u32], json: bool) -> Result<u8> {
    let mut sides = sides.to_vec();
    sides.sort_unstable();
    sides.dedup();
    let incidences = campaign.light.theta_i_deg.len() as u64;
    let runs = if incidences > 1 { 2 * incidences } else { 1 };
    let progress = RunProgress::new(sides.iter().map(|&side| scale::starts(side) * runs).sum(), "samples");
    let found = bench::scale(campaign, &sides, &|starts| progress.add(starts))?;
    progress.finish();
    let mut out = Output::default();
    if json {
        let mut answer = to_json(&found)?;
        answer["name"] = json!(campaign.name);
        out.json(&answer)?;
        return Ok(0);
    }
    inform("one start for each cell and incidence; processor time; bytes for each cell of the patch");
    out.lines(patch_lines(&found))?;
    out.line("")?;
    out.lines(scale_lines(&found))?;
    Ok(0)
}

fn patch_lines(found: &Scale) -> Vec<String> {
    let row = |patch: &bench::ScalePatch| {
        let cells = f64::from(patch.cells).powi(2);
        vec![
            patch.cells.to_string(),
            format!("{:.2}", patch.synthesis_cpu_s),
            format!("{:.0}", 1e9 * patch.synthesis_cpu_s / cells),
            or_na(patch.synthesis_bytes, 1),
            format!("{:.1}", patch.tracing_bytes),
        ]
    };
    const HEADINGS: [&str; 5] = ["cells", "synthesis s", "ns/cell", "its bytes/cell", "tracing bytes/cell"];
    columns(&HEADINGS, &found.patches.iter().map(row).collect::<Vec<_>>())
}

fn scale_lines(found: &Scale) -> Vec<String> {
    let row = |row: &bench::ScaleRow| {
        let thetas: Vec<String> = row.theta_i_deg.iter().map(f64::to_string).collect();
        vec![
            row.cells.to_string(),
            thetas.join(" "),
            grouped(row.starts),
            format!("{:.2}", row.cpu_s),
            format!("{:.0}", row.nanoseconds()),
        ]
    };
    columns(
        &["cells", "theta_i", "starts", "cpu s", "ns/start"],
        &found.rows.iter().map(row).collect::<Vec<_>>(),
    )
}
