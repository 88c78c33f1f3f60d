//! The ladders of a campaign: which runs they take.

use serde::{Deserialize, Serialize};

use super::truth::TruthKind;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::{self, Plan};

/// From one rung to the next.
const FACTOR: u64 = 4;
/// Rungs where the user does not say how many.
const RUNGS: u32 = 6;
/// A line and its scatter need three.
const FEWEST_RUNGS: usize = 3;

/// What changes along a ladder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Varies {
    /// Samples of each realisation; their number is fixed.
    Samples,
    /// Realisations; the samples of each are fixed.
    Realisations,
}

/// What the user asks for.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// Fewest samples of an incidence, all realisations together.
    pub from: Option<u64>,
    /// Most of them.
    pub to: Option<u64>,
    /// Most realisations of the second ladder.
    pub most_realisations: Option<u32>,
    /// Runs of each rung, at least 1.
    pub replicates: u32,
}

/// A run to come.
pub struct Rung {
    pub(super) campaign: Campaign,
    pub(super) plan: Plan,
}

/// The runs of a bench.
pub struct Ladders {
    /// Each ladder.
    pub ladders: Vec<(Varies, Vec<Rung>)>,
    /// The run that is taken for the truth, where there is one.
    pub reference: Option<Rung>,
    /// Runs of each rung.
    pub replicates: u32,
}

/// Plans the ladders. N = samples of one incidence, all realisations together; factor 4 from rung to rung.
///
/// The first ladder keeps the campaign's realisations. A random surface gets a second one: 1, 4, 16, ... realisations
/// with as many samples each as on the first one's last rung. Errors: `Usage` where a ladder would have fewer than
/// three rungs; those of planning its largest run.
pub fn planned(campaign: &Campaign, range: &Range, truth: TruthKind) -> Result<Ladders> {
    let realisations = campaign.surface.realisations;
    let own = measure::plan(campaign)?.samples.saturating_mul(realisations.into());
    let to = range.to.unwrap_or(own);
    let from = range.from.unwrap_or((to / FACTOR.pow(RUNGS - 1)).max(realisations.into()));
    let counts = powers(from, to);
    let rung = |n: &u64| Rung::new(campaign, realisations, n.div_ceil(realisations.into()));
    let samples = counts.iter().map(rung).collect::<Result<Vec<_>>>()?;
    let each = match samples.last() {
        Some(last) if from >= realisations.into() && samples.len() >= FEWEST_RUNGS => last.plan.samples,
        _ => {
            return Err(Error::Usage(format!(
                "from {from} to {to} samples: at least {realisations} (one a realisation), and 16 times as many"
            )));
        }
    };
    let mut ladders = vec![(Varies::Samples, samples)];
    let mut most = realisations;
    if campaign.surface.kind.has_random_patches() {
        let last = range.most_realisations.unwrap_or((4 * realisations).max(16));
        let counts = powers(1, last.into());
        if counts.len() < FEWEST_RUNGS {
            return Err(Error::Usage(format!("realisations up to {last}: at least 16")));
        }
        let rung = |&count: &u64| Rung::new(campaign, count as u32, each);
        ladders.push((Varies::Realisations, counts.iter().map(rung).collect::<Result<_>>()?));
        most = most.max(last).saturating_mul(4);
    }
    let each = if most > realisations { each } else { each.saturating_mul(FACTOR) };
    let reference = match truth {
        TruthKind::Model => None,
        TruthKind::Reference => Some(Rung::new(campaign, most, each)?),
    };
    Ok(Ladders { ladders, reference, replicates: range.replicates })
}

/// `from`, 4 `from`, ... up to `to`.
fn powers(from: u64, to: u64) -> Vec<u64> {
    std::iter::successors(Some(from.max(1)), |n| n.checked_mul(FACTOR)).take_while(|&n| n <= to).collect()
}

impl Rung {
    /// `each` starts for each incidence and realisation: whole blocks, or one smaller block.
    fn new(campaign: &Campaign, realisations: u32, each: u64) -> Result<Self> {
        let mut campaign = campaign.clone();
        campaign.surface.realisations = realisations;
        campaign.stop.samples = each;
        let mut plan = measure::plan(&campaign)?;
        if each < plan.block_starts {
            plan.total_samples = plan.total_samples / plan.samples * each;
            (plan.block_starts, plan.samples) = (each, each);
        }
        Ok(Rung { campaign, plan })
    }

    /// Samples of one incidence.
    pub(super) fn samples(&self) -> u64 {
        self.plan.samples * u64::from(self.plan.realisations)
    }
}

impl Ladders {
    /// Samples of all runs.
    pub fn total_samples(&self) -> u64 {
        let rungs = self.ladders.iter().flat_map(|(_, rungs)| rungs);
        let runs: u64 = rungs.map(|rung| rung.plan.total_samples).sum();
        runs * u64::from(self.replicates) + self.reference.as_ref().map_or(0, |rung| rung.plan.total_samples)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::path::Path;

    use super::*;
    use crate::campaign;

    pub(in crate::bench) fn campaign(surface: &str) -> Campaign {
        let text = format!(
            "name = \"tiny\"\nseed = 3\n[surface]\n{surface}\n[light]\ntheta_i_deg = [0, 40]\n\
             average_azimuth = true\n[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 8\n[stop]\nsamples = 65536\n"
        );
        campaign::parse(&text, "tiny", Path::new("")).expect("a campaign").campaign
    }

    pub(in crate::bench) const RANDOM: &str =
        "realisations = 4\ncells = 32\ncorrelation_cells = 4.0\n[surface.ggx]\nalpha = 0.3";
    const RANGE: Range =
        Range { from: Some(256), to: Some(4096), most_realisations: Some(16), replicates: 2 };

    #[test]
    fn a_random_surface_varies_samples_and_realisations_apart() {
        let planned = planned(&campaign(RANDOM), &RANGE, TruthKind::Reference).expect("ladders");
        let of = |k: usize| -> Vec<(u32, u64)> {
            planned.ladders[k].1.iter().map(|r| (r.plan.realisations, r.plan.samples)).collect()
        };
        assert_eq!(of(0), [(4, 64), (4, 256), (4, 1024)]);
        assert_eq!(of(1), [(1, 1024), (4, 1024), (16, 1024)]);
        // Four times the largest N, 2 incidences, 2 replicates.
        assert_eq!(planned.reference.as_ref().map(Rung::samples), Some(65_536));
        assert_eq!(planned.total_samples(), 2 * (65_536 + 2 * (5_376 + 21_504)));
    }

    #[test]
    fn a_surface_without_chance_has_one_ladder() {
        let grooves = campaign("[surface.v_groove]\nslope = 0.5");
        let planned = planned(&grooves, &RANGE, TruthKind::Reference).expect("ladders");
        assert_eq!(planned.ladders.len(), 1);
        let reference = planned.reference.as_ref().map(Rung::samples);
        assert!(reference.is_some_and(|samples| samples >= 4 * 4096), "{reference:?}");
    }

    #[test]
    fn short_ladders_are_refused() {
        for (from, to) in [(4096, 16_384), (1, 4096), (4096, 256)] {
            let range = Range { from: Some(from), to: Some(to), ..RANGE };
            assert!(matches!(planned(&campaign(RANDOM), &range, TruthKind::Model), Err(Error::Usage(_))));
        }
    }
}
