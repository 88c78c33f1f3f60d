//! `gonio study`: is the sample isotropic? Turns it through 360 degrees and says so.

use std::path::PathBuf;

use clap::Args;

use super::text::output::{Output, note, to_json, warn};
use super::text::progress::{RunProgress, Stage};
use crate::campaign::{self, Parsed};
use crate::error::{Error, Result};
use crate::measure::{self, Patches};
use crate::study;

/// Turn the sample through 360 degrees: isotropic or not, its alpha_x, alpha_y and rotation
#[derive(Args)]
#[command(
    after_help = "Turns at the campaign's phi_i_deg (evenly spaced), or every 15 degrees. Writes no files.\n\n\
    Example: gonio study configs/study_brushed.toml"
)]
pub struct Arguments {
    /// The campaign, a TOML file
    campaign: PathBuf,
    /// Seed instead of the campaign's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Print one JSON document: anisotropy_index, p_value, dimensions, alpha_x, ...
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let Parsed { mut campaign, notes, .. } = campaign::read(&arguments.campaign)?;
    campaign.seed = arguments.seed.unwrap_or(campaign.seed);
    notes.iter().for_each(warn);
    let (campaign, plan) = study::turned(&campaign)?;
    let mut notes = Vec::new();
    let patches = Patches::prepare(&campaign, &mut notes)?;
    notes.iter().for_each(note);
    let progress = RunProgress::new(plan.total_samples, "samples");
    let (results, _) = measure::measure(&campaign, &plan, &patches, &|starts| progress.add(starts))?;
    progress.finish();
    let measured = results.first().ok_or_else(|| Error::Internal("a study measured no table".into()))?;
    let stage = Stage::begin("looking for axes");
    let found = study::examine(measured);
    drop(stage);
    let mut out = Output::default();
    if arguments.json {
        out.json(&to_json(&found)?)?
    } else {
        out.lines(found.lines())?
    }
    Ok(0)
}
