//! The campaign as the study runs it: light at evenly spaced azimuths, bins that turn with it.

use crate::campaign::{Azimuth, Campaign};
use crate::error::{Error, Result};
use crate::measure::{self, Plan};

/// Turns where the campaign says nothing: every 15 degrees.
const TURNS: u32 = 24;
/// Fewer could not distinguish the fourth harmonic from its aliases.
const FEWEST_TURNS: usize = 9;
/// How evenly the turns must be spaced, degrees.
const EVEN_DEG: f64 = 1e-6;

/// The campaign and the plan of a study.
///
/// Turning the light by phi over the still sample is turning the sample by -phi under the still light: the incidences are
/// those azimuths, and the bins count phi_r from the light. One measurement then serves every turn with the same
/// patches. Mirror images and folding are off; averages over azimuth too.
///
/// Errors: `Usage` where the campaign has several roughnesses, light from both sides or unevenly spaced azimuths; those of `plan`.
// Tested by `mirror_images_and_folding_are_off`, `uneven_turns_are_refused` (tests/it/study.rs).
pub fn turned(campaign: &Campaign) -> Result<(Campaign, Plan)> {
    let mut campaign = campaign.clone();
    if campaign.alphas().len() > 1 {
        let why = "a study takes one roughness; give a campaign for each";
        return Err(Error::Usage(format!("{}: surface.alpha: {why}", campaign.name)));
    }
    if campaign.optics.light_sides().len() > 1 {
        let why = "a study takes light from one side; give a campaign for each";
        return Err(Error::Usage(format!("{}: light.side: {why}", campaign.name)));
    }
    let every = |step: f64, count: u32| (0..count).map(|k| step * f64::from(k)).collect();
    let turns = match &campaign.light.azimuth {
        Azimuth::Relative => every(360.0 / f64::from(TURNS), TURNS),
        Azimuth::Absolute(phi_i_deg) => phi_i_deg.clone(),
        Azimuth::KlemsFull => {
            let why = "a study turns the sample in equal steps; give theta_i_deg and phi_i_deg";
            return Err(Error::Usage(format!("{}: light.azimuth: {why}", campaign.name)));
        }
    };
    check(&campaign.name, &turns)?;
    campaign.light.azimuth = Azimuth::Absolute(turns);
    campaign.light.average_azimuth = false;
    campaign.surface.mirror_images = false;
    campaign.trace.fold = false;
    let mut plan = measure::plan(&campaign)?;
    plan.grid.phi_r_relative = true;
    Ok((campaign, plan))
}

fn check(name: &str, turns: &[f64]) -> Result<()> {
    let refuse = |why: String| Err(Error::Usage(format!("{name}: light.phi_i_deg: {why}")));
    if turns.len() < FEWEST_TURNS {
        return refuse(format!(
            "{} azimuths; a study takes at least {FEWEST_TURNS}, evenly over 360",
            turns.len()
        ));
    }
    let step = 360.0 / turns.len() as f64;
    let uneven = turns.windows(2).find(|pair| (pair[1] - pair[0] - step).abs() > EVEN_DEG);
    match uneven {
        Some(pair) => refuse(format!("{} follows {}; a study takes equal steps of {step}", pair[1], pair[0])),
        None => Ok(()),
    }
}
