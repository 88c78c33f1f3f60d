//! The same table by two ways: as planned, and without one of the plan's savings.
//!
//! Both ways measure the same patches under the same azimuths into the same bins, several times with draws of their
//! own (replicates), alternately. The squared error of a bin is a/n + p^2: n starts, p the patches' own spread, which
//! is the same for both. A target e takes n = a/(e^2 - p^2) starts, so that the two times to an equal error stand to
//! each other as a x time per start, whatever the target and however many patches there are.

use std::fmt;

use serde::Serialize;

use super::run::seed_of;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::{self, Measured, Patches, Plan, StartSampler};
use crate::stats;

/// The error that times are given for where the campaign asks for none.
const TARGET: f64 = 0.01;

/// What the plan is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Other {
    /// Surface samples in equal steps from place to place.
    Rays,
    /// All starts of the hemisphere, also where only some apertures are asked for.
    Hemisphere,
}

impl Other {
    /// All of them.
    pub const ALL: [Other; 2] = [Other::Rays, Other::Hemisphere];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        ["rays", "hemisphere"][self as usize]
    }

    /// The plan of this way; `None` where it would be the plan itself, or cannot be.
    fn plan(self, plan: &Plan, campaign: &Campaign) -> Option<Plan> {
        match self {
            Other::Rays if plan.start_sampler == StartSampler::BySlope => plan.by_place(campaign),
            Other::Rays => None,
            Other::Hemisphere => plan.all_directions(campaign),
        }
    }
}

impl fmt::Display for Other {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// One way, measured.
#[derive(Debug, Clone, Serialize)]
pub struct Variant {
    /// `planned`, or the other's name.
    pub name: &'static str,
    /// Processor seconds of one run, median of the replicates, the making of the patches left out.
    pub cpu_s: f64,
    /// Rays of one run.
    pub rays: u64,
    /// Standard error of a run: median over the bins of all incidences, relative. Its square is that of the patches and that
    /// of the noise together.
    pub error: f64,
    /// What of it more starts take down: median over the bins, relative.
    pub noise: f64,
    /// Processor seconds until the noise is the target.
    pub to_target_s: f64,
}

/// One incidence of both ways.
#[derive(Debug, Clone, Serialize)]
pub struct IncidenceNoise {
    /// Where the light stands.
    pub theta_i_deg: f64,
    /// Its azimuth.
    pub phi_i_deg: f64,
    /// Bins (of all colours) that count.
    pub bins: usize,
    /// Median noise of each way.
    pub noise: [f64; 2],
}

/// The comparison.
#[derive(Debug, Clone, Serialize)]
pub struct Against {
    /// The error that times are given for.
    pub target: f64,
    /// Runs of each way.
    pub replicates: u32,
    /// As planned, and the other.
    pub ways: [Variant; 2],
    /// Every incidence.
    #[serde(rename = "stops")]
    pub incidences: Vec<IncidenceNoise>,
    /// Variance of the other over that of the plan, for one run of each.
    pub variance_ratio: f64,
    /// Time to an equal error of the other over that of the plan.
    pub ratio: f64,
    /// Its standard error: jackknife over the patches, for the variances; times count as exact.
    pub ratio_se: Option<f64>,
}

/// The values of one bin: [replicate][realisation].
type BinValues = Vec<Vec<f64>>;

/// A bin that counts: of which incidence, and what each way found.
struct JudgedBin {
    incidence: usize,
    mean: f64,
    ways: [BinValues; 2],
}

/// Measures `campaign` (one roughness) `replicates` times as planned and `replicates` times by `other`. `progress` is
/// called with the starts of every finished block.
///
/// Errors: `Usage` with fewer than two replicates, and where `other` is no other way to measure this campaign.
// Tested by `noise_is_what_replicates_show`.
pub fn against(
    campaign: &Campaign,
    other: Other,
    replicates: u32,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Against> {
    let mut campaign = campaign.clone();
    let target = campaign.stop.relative_error.take().unwrap_or(TARGET);
    campaign.stop.seconds = None;
    let plans = plans(&campaign, other, replicates)?;
    let patches = Patches::held(&campaign)?;
    let mut runs: [Vec<Measured>; 2] = Default::default();
    let mut costs: [Vec<measure::Cost>; 2] = Default::default();
    for replicate in 0..u64::from(replicates) {
        let mut one = campaign.clone();
        one.seed = seed_of(campaign.seed, [u64::MAX, 1, replicate]);
        for (way, plan) in plans.iter().enumerate() {
            let (mut measured, cost) = measure::measure(&one, plan, &patches, progress)?;
            runs[way].extend(measured.pop());
            costs[way].push(cost);
        }
    }
    let bins = counted(&runs, &plans[0]);
    let cpu_s = costs.each_ref().map(|costs| median(costs.iter().map(|cost| cost.tracing_cpu_s)));
    let rays = costs.each_ref().map(|costs| costs[0].rays_traced);
    let names = ["planned", other.name()];
    let way = |way: usize| {
        Variant::of(names[way], cpu_s[way], rays[way], target, &VariantBins { way, bins: &bins })
    };
    let ways = [way(0), way(1)];
    let variance = |[plan, other]: [f64; 2]| (other / plan).powi(2);
    let without = |left_out: usize| {
        variance([0, 1].map(|way| median(bins.iter().map(|bin| bin.noise(way, Some(left_out))))))
    };
    let variance_ratio = variance(ways.each_ref().map(|way| way.noise));
    let leave_one_out: Vec<f64> = (0..plans[0].realisations as usize).map(without).collect();
    let times = cpu_s[1] / cpu_s[0];
    Ok(Against {
        target,
        replicates,
        ways,
        incidences: (0..plans[0].incidences)
            .map(|incidence| of_incidence(&plans[0], &bins, incidence))
            .collect(),
        variance_ratio,
        ratio: times * variance_ratio,
        ratio_se: stats::jackknife_se(&leave_one_out).map(|se| times * se),
    })
}

/// The plans of both ways.
pub fn plans(campaign: &Campaign, other: Other, replicates: u32) -> Result<[Plan; 2]> {
    if replicates < 2 {
        return Err(Error::Usage("--replicates 1: noise shows from 2 runs on".into()));
    }
    let plan = measure::plan(campaign)?;
    let why = match other {
        Other::Rays => {
            "is for hemispheres over ggx and beckmann with so many samples that they follow the slopes"
        }
        Other::Hemisphere => "is for apertures (sensor.arm) over ggx and beckmann, one bounce",
    };
    let refused = || Error::Usage(format!("{}: --against {other} {why}", campaign.name));
    let second = other.plan(&plan, campaign).ok_or_else(refused)?;
    Ok([plan, second])
}

/// The bins as one of the ways found them.
struct VariantBins<'a> {
    way: usize,
    bins: &'a [JudgedBin],
}

impl Variant {
    fn of(name: &'static str, cpu_s: f64, rays: u64, target: f64, spread: &VariantBins) -> Self {
        let VariantBins { way, bins } = *spread;
        let noise = median(bins.iter().map(|bin| bin.noise(way, None)));
        let error = median(bins.iter().map(|bin| bin.error(way)));
        Variant { name, cpu_s, rays, error, noise, to_target_s: cpu_s * (noise / target).powi(2) }
    }
}

fn of_incidence(plan: &Plan, bins: &[JudgedBin], incidence: usize) -> IncidenceNoise {
    let (theta_i_deg, phi_i_deg) = plan.grid.incidence_deg(incidence);
    let here: Vec<&JudgedBin> = bins.iter().filter(|bin| bin.incidence == incidence).collect();
    let noise = |way: usize| median(here.iter().map(|bin| bin.noise(way, None)));
    IncidenceNoise { theta_i_deg, phi_i_deg, bins: here.len(), noise: [noise(0), noise(1)] }
}

/// The bins above 1 % of their incidence's and colour's peak, by the mean of all runs of both ways.
fn counted(runs: &[Vec<Measured>; 2], plan: &Plan) -> Vec<JudgedBin> {
    let values = |way: usize, colour: usize, at: usize| -> BinValues {
        let of_run = |run: &Measured| {
            run.realisations.parts.iter().map(|part| f64::from(part.total[colour][at])).collect()
        };
        runs[way].iter().map(of_run).collect()
    };
    let mut counted = Vec::new();
    for colour in 0..plan.colours {
        for incidence in 0..plan.incidences {
            let bin = |k: usize| {
                let ways = [0, 1].map(|way| values(way, colour, incidence * plan.bins + k));
                let values: Vec<f64> = ways.iter().flatten().flatten().copied().collect();
                let mean = stats::mean(&values);
                JudgedBin { incidence, mean, ways }
            };
            let bins: Vec<JudgedBin> = (0..plan.bins).map(bin).collect();
            let peak = bins.iter().fold(0.0f64, |peak, bin| peak.max(bin.mean));
            counted.extend(bins.into_iter().filter(|bin| bin.mean > stats::COUNTED_ABOVE * peak));
        }
    }
    counted
}

impl JudgedBin {
    /// The standard error of a run's mean over the realisations that draws alone make, relative: from the spread of the
    /// replicates of each realisation. One realisation may be left out.
    fn noise(&self, way: usize, left_out: Option<usize>) -> f64 {
        let runs = &self.ways[way];
        let kept = (0..runs[0].len()).filter(|&r| Some(r) != left_out);
        let spread = |r: usize| {
            let (_, se) = stats::mean_and_se(runs.iter().map(|run| run[r]));
            // Variance of one replicate.
            runs.len() as f64 * se.map_or(0.0, |se| se * se)
        };
        let count = kept.clone().count() as f64;
        kept.map(spread).sum::<f64>().sqrt() / (count * self.mean)
    }

    /// The standard error of a run's mean, relative, from the spread over its realisations: root mean square of the
    /// replicates.
    fn error(&self, way: usize) -> f64 {
        let square = |run: &Vec<f64>| {
            let (_, se) = stats::mean_and_se(run.iter().copied());
            se.map_or(f64::NAN, |se| se * se)
        };
        stats::mean(&self.ways[way].iter().map(square).collect::<Vec<_>>()).sqrt() / self.mean
    }
}

/// The upper median; NaN without values.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    stats::upper_median(&mut values.collect::<Vec<_>>()).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two replicates of two realisations, by hand: 1 and 3 (variance 2), 6 and 6 (0).
    #[test]
    fn noise_is_what_replicates_show() {
        let runs = vec![vec![1.0, 6.0], vec![3.0, 6.0]];
        let bin = JudgedBin { incidence: 0, mean: 4.0, ways: [runs.clone(), runs] };
        // A run's mean over both has the variance (2 + 0)/4.
        assert_eq!(bin.noise(0, None), 0.5f64.sqrt() / 4.0);
        assert_eq!(bin.noise(0, Some(0)), 0.0);
        assert_eq!(bin.noise(0, Some(1)), 2f64.sqrt() / 4.0);
        // Means of two with variances 12.5/2 and 4.5/2; their root mean square.
        assert_eq!(bin.error(0), (0.5 * (6.25 + 2.25f64)).sqrt() / 4.0);
    }
}
