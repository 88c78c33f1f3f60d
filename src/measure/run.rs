//! The measurement itself: realisations, stops and blocks in parallel, integer sums in any order.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;

use super::arms::{BlockArms, starts_stream};
use super::assemble::{Measured, StopRecord, assemble};
use super::block::{Block, Rays};
use super::cost::{Cost, cpu_seconds, peak_bytes};
use super::optics::{Light, f0_of};
use super::patches::{Patch, Patches, Specimen};
use super::plan::{Plan, fits_the_lanes};
use super::tally::{Shape, Tally};
use crate::campaign::{Alpha, Campaign};
use crate::error::{Error, Result};
use crate::files;
use crate::instrument::Sensor;
use crate::rng;
use crate::trace::{Kernel, LaneField, LaneWalker, Place, Sample, SmithWalk, Starts, Walker};

/// Everything that blocks share.
pub(super) struct Context<'a> {
    pub campaign: &'a Campaign,
    pub plan: &'a Plan,
    pub sensor: Sensor,
    pub f0: Option<[f64; 3]>,
    progress: &'a (dyn Fn(u64) + Sync),
    kernel: Kernel,
    rays: AtomicU64,
    skipped: AtomicU64,
}

/// Measures a campaign: one result for each roughness. `progress` is called with the starts of every finished block.
///
/// Errors: those of loading patches; `Internal` if a ray is lost.
pub fn measure(
    campaign: &Campaign,
    plan: &Plan,
    patches: &Patches,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<(Vec<Measured>, Cost)> {
    let (begin, cpu) = (Instant::now(), cpu_seconds());
    let context = Context {
        campaign,
        plan,
        sensor: Sensor::new(&plan.grid),
        f0: f0_of(&campaign.optics),
        progress,
        kernel: Kernel::widest(),
        rays: AtomicU64::new(0),
        skipped: AtomicU64::new(0),
    };
    let alphas = campaign.alphas();
    let mut records: Vec<Vec<Vec<StopRecord>>> = vec![Vec::new(); alphas.len()];
    let mut digests = Vec::new();
    let (mut synthesis_s, mut tracing_s) = (0.0, 0.0);
    let all: Vec<u64> = (0..u64::from(plan.realisations)).collect();
    // As many patches in memory as there are threads to make them.
    for group in all.chunks(rayon::current_num_threads()) {
        let clock = Instant::now();
        let mount = |&k: &u64| Ok(context.mounted(patches.realisation(k)?));
        let made = group.par_iter().map(mount).collect::<Result<Vec<Mounted>>>()?;
        let digest = |mounted: &Mounted| mounted.specimen.digest().map(Vec::from);
        digests.extend(made.par_iter().filter_map(digest).collect::<Vec<_>>().concat());
        synthesis_s += clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        for (alpha, records) in alphas.iter().zip(&mut records) {
            let measured =
                group.par_iter().zip(&made).map(|(&k, mounted)| context.realisation(mounted, *alpha, k));
            records.extend(measured.collect::<Result<Vec<_>>>()?);
        }
        tracing_s += clock.elapsed().as_secs_f64();
    }
    let patch_digest = if digests.is_empty() { String::new() } else { files::sha256_hex(&digests) };
    let results = alphas.iter().zip(records);
    let results =
        results.map(|(alpha, records)| assemble(campaign, plan, *alpha, records, &patch_digest)).collect();
    let cost = Cost {
        wall_s: begin.elapsed().as_secs_f64(),
        cpu_s: cpu_seconds() - cpu,
        synthesis_s,
        tracing_s,
        threads: rayon::current_num_threads(),
        samples: plan.total_samples,
        rays_traced: context.rays.into_inner(),
        rays_skipped: context.skipped.into_inner(),
        peak_bytes: peak_bytes(),
    };
    Ok((results, cost))
}

/// A specimen, and the lanes' copy of its heights where they serve.
struct Mounted {
    specimen: Specimen,
    lanes: Option<LaneField>,
}

impl Context<'_> {
    fn mounted(&self, specimen: Specimen) -> Mounted {
        let lanes = match &specimen {
            Specimen::Patch(patch) if self.campaign.trace.visibility => LaneField::new(&patch.field),
            _ => None,
        };
        Mounted { specimen, lanes }
    }

    /// All stops of one realisation.
    fn realisation(
        &self,
        mounted: &Mounted,
        alpha: Option<Alpha>,
        realisation: u64,
    ) -> Result<Vec<StopRecord>> {
        let stage = match &mounted.specimen {
            Specimen::Patch(patch) => {
                let (walker, lanes) = (Walker::new(&patch.field), mounted.lanes.as_ref());
                let lanes = lanes.map(|lanes| LaneWalker::new(walker, lanes, self.kernel));
                Stage::Heights { patch, walker, lanes, alpha: patch.alpha(alpha) }
            }
            Specimen::Statistical { law, independent_heights } => Stage::Statistical(SmithWalk {
                law: *law,
                alpha: alpha.map_or(DVec2::ONE, |alpha| DVec2::new(alpha.x, alpha.y)),
                independent_heights: *independent_heights,
            }),
        };
        let stop = |stop: usize| {
            let tally = (0..self.plan.blocks)
                .into_par_iter()
                .fold(
                    || Tally::new(self.shape()),
                    |mut tally, block| {
                        self.block(Work { stage: &stage, realisation, stop, block }, &mut tally);
                        tally
                    },
                )
                .reduce(|| Tally::new(self.shape()), Tally::merge);
            if tally.lost > 0 || tally.starts() != self.plan.samples {
                let (lost, starts) = (tally.lost, tally.starts());
                return Err(Error::Internal(format!(
                    "realisation {realisation}, stop {stop}: {lost} rays lost, {starts} of {} starts counted",
                    self.plan.samples
                )));
            }
            Ok(StopRecord::new(&tally))
        };
        (0..self.plan.stops).into_par_iter().map(stop).collect()
    }

    fn shape(&self) -> Shape {
        Shape {
            bins: self.plan.bins,
            bounces: self.campaign.trace.bounces,
            fresnel_colours: self.f0.map_or(0, |_| self.plan.colours),
        }
    }

    /// One block of starts of one stop.
    fn block(&self, work: Work, tally: &mut Tally) {
        let (campaign, plan) = (self.campaign, self.plan);
        let arms = BlockArms::new(campaign, plan, work.stop, work.realisation, work.block);
        let mut rng = rng::stream(starts_stream(campaign, plan, work.stop, work.realisation, work.block));
        let mut block = Block { context: self, arms, stop: work.stop, tally, rays: Rays::default() };
        match work.stage {
            Stage::Heights { patch, walker, lanes, alpha } => {
                let sample = Sample { walker: *walker, alpha: *alpha, image: arms.image };
                let light = sample.to_field(arms.wi);
                let starts = Starts::new(&patch.field, patch.window, light);
                let flux = starts.share(plan.block_starts) / plan.blocks as f64;
                let each = |visit: &mut dyn FnMut(Place)| starts.each(plan.block_starts, &mut rng, visit);
                match lanes.filter(|_| fits_the_lanes(walker.range(), light)) {
                    Some(over) => block.follow_in_waves(&sample, &over, flux, each),
                    None => block.follow(&sample, flux, each),
                }
            }
            Stage::Statistical(walk) => {
                let flux = 1.0 / (plan.block_starts as f64 * plan.blocks as f64);
                for _ in 0..plan.block_starts {
                    let mut light = Light::new(self.f0);
                    let ending = walk.trace(arms.wi, campaign.trace.bounces, &mut rng, &mut light);
                    block.end(ending, light, flux);
                }
            }
        }
        self.rays.fetch_add(block.rays.traced, Ordering::Relaxed);
        self.skipped.fetch_add(block.rays.skipped, Ordering::Relaxed);
        (self.progress)(plan.block_starts);
    }
}

/// The surface of one realisation and roughness.
enum Stage<'a> {
    /// Heights to walk over.
    Heights {
        patch: &'a Patch,
        walker: Walker<'a>,
        /// The same in lanes.
        lanes: Option<LaneWalker<'a>>,
        /// World slope per canonical slope.
        alpha: DVec2,
    },
    /// A law to draw from.
    Statistical(SmithWalk),
}

/// The address of a block, and the surface that it is measured on.
struct Work<'a> {
    stage: &'a Stage<'a>,
    realisation: u64,
    stop: usize,
    block: u64,
}
