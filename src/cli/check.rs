//! `gonio check`: every fault of a campaign, or what measuring it would mean.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::text::output::{Output, note, print_error, to_json, warn};
use super::text::plan;
use crate::campaign::{self, Campaign, CampaignRun, CampaignRuns, SurfaceKind};
use crate::error::{Error, Result};
use crate::instrument::grid_of;
use crate::measure::{self, Disk};
use crate::surface::io::import;
use crate::table::realisations::SIZE_LIMIT;
use crate::validate::GeometricOptics;
use crate::validate::prediction::aperture::worst;

/// List all faults of a campaign, or show the plan: incidences, bins, samples, memory, time
#[derive(Args)]
#[command(after_help = "Example: gonio check configs/quickstart.toml")]
pub struct Arguments {
    /// The campaign, a TOML file
    campaign: PathBuf,
    /// Say of all that is skipped why, and what that saves
    #[arg(short, long)]
    verbose: bool,
    /// Print one JSON document: faults, plan, notes
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let parsed = match campaign::read_runs(&arguments.campaign) {
        Err(error @ Error::Campaign(_)) if arguments.json => return answer(&error),
        parsed => parsed?,
    };
    let CampaignRuns { runs, notes: mut warnings, preset, uncertainty } = parsed;
    let campaign = runs[0].campaign.clone();
    let prepared = map_notes(&campaign, &mut warnings)?;
    let plan = measure::plan(&campaign);
    let mut out = Output::default();
    if arguments.json {
        let code = plan.as_ref().err().map_or(0, Error::exit_code);
        let disk = plan.as_ref().ok().map(|plan| Disk::of(&campaign, plan, SIZE_LIMIT));
        let plan = match plan {
            Ok(plan) => to_json(&plan)?,
            Err(error) => {
                print_error(&error);
                Value::Null
            }
        };
        let notes = [warnings, prepared].concat();
        let preset = to_json(&preset)?;
        let apertures = to_json(&worst(&campaign))?;
        let waves = to_json(&GeometricOptics::of(&campaign, &grid_of(&campaign)))?;
        out.json(&json!({
            "faults": [], "plan": plan, "notes": notes, "preset": preset, "aperture_bias": apertures,
            "geometric_optics": waves, "disk": disk, "runs": runs.iter().map(run_json).collect::<Vec<_>>(),
        }))?;
        return Ok(code);
    }
    warnings.iter().for_each(warn);
    prepared.iter().for_each(note);
    let plan = plan?;
    out.lines(preset.iter().flat_map(plan::preset))?;
    out.lines(plan::facts(&campaign, &plan, Disk::of(&campaign, &plan, SIZE_LIMIT)))?;
    out.lines(plan::runs(&runs, &plan))?;
    out.lines(worst(&campaign).iter().flat_map(plan::aperture))?;
    out.lines(uncertainty.iter().flat_map(plan::uncertainty))?;
    out.lines(plan::waves(&GeometricOptics::of(&campaign, &plan.grid)))?;
    out.lines(if arguments.verbose { plan::reasons(&plan) } else { plan::skipped(&plan) })?;
    Ok(0)
}

/// A run of several, with what it costs; null where it is refused.
fn run_json(run: &CampaignRun) -> Value {
    let plan = measure::plan(&run.campaign).ok();
    let seconds = plan.as_ref().map(|plan| plan.estimated_s);
    json!({ "label": run.label, "tables": plan.map(|plan| plan.tables), "estimated_s": seconds })
}

/// How a height map is prepared, or why it cannot be measured. That it is not there is no fault of the campaign, but a warning:
/// a run before it may have to make it.
fn map_notes(campaign: &Campaign, warnings: &mut Vec<String>) -> Result<Vec<String>> {
    let SurfaceKind::File(map) = &campaign.surface.kind else { return Ok(vec![]) };
    if map.resolved_path.is_file() {
        return Ok(import::load(map)?.notes);
    }
    let path = map.resolved_path.display();
    warnings.push(format!("{path}: not there, so not looked at; `gonio measure` needs it"));
    Ok(vec![])
}

/// The faults as JSON.
fn answer(error: &Error) -> Result<u8> {
    let faults = if let Error::Campaign(faults) = error { to_json(faults)? } else { Value::Null };
    Output::default().json(&json!({ "faults": faults, "plan": null, "notes": [] }))?;
    Ok(error.exit_code())
}
