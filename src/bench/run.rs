//! The runs of the ladders, and their fits.

use rand::Rng;
use serde::{Deserialize, Serialize};

use super::fit::{LadderFit, Point, fit};
use super::ladder::{Ladders, Rung, Varies};
use super::truth::Truth;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::{self, Measured, Patches};
use crate::rng::{self, Purpose, StreamId};
use crate::stats;

/// One rung, measured.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MeasuredRung {
    /// The ladder it belongs to.
    pub varies: Varies,
    /// Samples of one incidence, all realisations together.
    pub samples: u64,
    /// Realisations among them.
    pub realisations: u32,
    /// Wall time of one run, mean over the replicates; making the patches included.
    pub seconds: f64,
    /// Rays followed in a second of it.
    pub rays_per_s: f64,
    /// Root of the mean squared error of the replicates.
    pub error: f64,
    /// 1/(error^2 seconds): null where the error is 0.
    pub efficiency: Option<f64>,
    /// The error of each replicate.
    pub errors: Vec<f64>,
    /// Largest |all orders + cut paths - 1| over incidences, realisations and replicates, F = 1; null without visibility.
    pub closure: Option<f64>,
}

/// One ladder, measured.
#[derive(Debug, Clone)]
pub struct Ladder {
    /// What changes along it.
    pub varies: Varies,
    /// Its rungs, fewest samples first.
    pub rows: Vec<MeasuredRung>,
    /// Noise and bias; null where an error is 0.
    pub fit: Option<LadderFit>,
}

/// A finished bench.
pub struct Bench {
    /// What the errors were counted from.
    pub truth: Truth,
    /// The ladders; the last one's b is the bias.
    pub ladders: Vec<Ladder>,
}

impl Rung {
    /// Measures it with a seed of its own.
    fn run(
        &mut self,
        patches: &mut Patches,
        seed: u64,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<(Measured, measure::Cost)> {
        self.campaign.seed = seed;
        if let Patches::Random { seed: of_patches, .. } | Patches::Grains { seed: of_patches, .. } = patches {
            *of_patches = seed;
        }
        let (mut measured, cost) = measure::measure(&self.campaign, &self.plan, patches, progress)?;
        let table = measured.pop();
        table.map(|table| (table, cost)).ok_or_else(|| Error::Internal("a rung without a table".into()))
    }
}

/// Runs the ladders of a campaign of one roughness. `progress` is called with the starts of every finished block.
pub fn bench(
    campaign: &Campaign,
    mut ladders: Ladders,
    patches: &mut Patches,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Bench> {
    let truth = match &mut ladders.reference {
        None => Truth::model(campaign, &measure::plan(campaign)?)?,
        Some(rung) => {
            let (measured, _) = rung.run(patches, seed_of(campaign.seed, [u64::MAX, 0, 0]), progress)?;
            Truth::reference(&measured, &rung.plan, rung.samples())
        }
    };
    let mut done = Vec::new();
    for (index, (varies, rungs)) in (0..).zip(&mut ladders.ladders) {
        let mut rows = Vec::new();
        for (step, rung) in (0..).zip(rungs) {
            let seeds: Vec<u64> = (0..ladders.replicates.into())
                .map(|replicate| seed_of(campaign.seed, [index, step, replicate]))
                .collect();
            rows.push(row(*varies, rung, &seeds, &truth, patches, progress)?);
        }
        let points = rows
            .iter()
            .flat_map(|row| row.errors.iter().map(|&error| Point { samples: row.samples as f64, error }));
        let fit = fit(&points.collect::<Vec<_>>());
        done.push(Ladder { varies: *varies, rows, fit });
    }
    Ok(Bench { truth, ladders: done })
}

/// All replicates of one rung.
fn row(
    varies: Varies,
    rung: &mut Rung,
    seeds: &[u64],
    truth: &Truth,
    patches: &mut Patches,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<MeasuredRung> {
    let (mut errors, mut seconds, mut rays, mut closure) = (Vec::new(), 0.0, 0.0, None::<f64>);
    for &seed in seeds {
        let (measured, cost) = rung.run(patches, seed, progress)?;
        errors.push(truth.error_of(&measured.table));
        let closures = measured.incidences.iter().flat_map(|incidence| &incidence.closure);
        let farthest = closures.map(|light| (light - 1.0).abs()).reduce(f64::max);
        closure = farthest.map(|farthest| closure.unwrap_or(0.0).max(farthest));
        seconds += cost.wall_s;
        rays += cost.rays_traced as f64;
    }
    let squared = stats::mean(&errors.iter().map(|error| error * error).collect::<Vec<_>>());
    let rays_per_s = rays / seconds;
    seconds /= seeds.len() as f64;
    Ok(MeasuredRung {
        varies,
        samples: rung.samples(),
        realisations: rung.plan.realisations,
        seconds,
        rays_per_s,
        error: squared.sqrt(),
        efficiency: Some(1.0 / (squared * seconds)).filter(|efficiency| efficiency.is_finite()),
        errors,
        closure: closure.filter(|_| rung.campaign.trace.visibility),
    })
}

/// The seed of one run, of 53 bits: any campaign can write it.
pub(super) fn seed_of(seed: u64, [ladder, rung, replicate]: [u64; 3]) -> u64 {
    let id =
        StreamId { seed, purpose: Purpose::Bench, realisation: ladder, incidence: rung, block: replicate };
    rng::stream(id).next_u64() >> 11
}

#[cfg(test)]
mod tests {
    use super::super::ladder::tests::{RANDOM, campaign};
    use super::*;
    use crate::validate;

    #[test]
    fn the_error_is_the_flux_weighted_distance() {
        let campaign = campaign(RANDOM);
        let plan = measure::plan(&campaign).expect("a plan");
        let patches = Patches::prepare(&campaign, &mut Vec::new()).expect("patches");
        let (measured, _) = measure::measure(&campaign, &plan, &patches, &|_| {}).expect("a table");
        let error = Truth::model(&campaign, &plan).expect("a model").error_of(&measured[0].table);
        let verdict = validate::examine(&measured[0].table, &campaign, None);
        let same = verdict.comparisons.iter().find(|c| c.masking == "height_correlated");
        let l1 = same.and_then(|c| c.figures.l1).expect("a figure");
        assert!((error / l1 - 1.0).abs() < 1e-12, "{error} {l1}");
    }
}
