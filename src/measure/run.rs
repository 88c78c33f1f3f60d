//! The measurement itself: realisations, stops and blocks in parallel, integer sums in any order.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::arms::{BlockArms, starts_stream};
use super::assemble::{Measured, StopRecord, assemble};
use super::cost::{Cost, cpu_seconds, peak_bytes};
use super::optics::{Light, f0_of};
use super::patches::{Patch, Patches, Specimen};
use super::plan::Plan;
use super::tally::{Shape, Tally, to_units};
use crate::campaign::{Alpha, Campaign};
use crate::error::{Error, Result};
use crate::files;
use crate::instrument::Sensor;
use crate::rng;
use crate::trace::{Ending, Sample, SmithWalk, Starts, Walker};

/// Everything that blocks share.
struct Context<'a> {
    campaign: &'a Campaign,
    plan: &'a Plan,
    sensor: Sensor,
    f0: Option<[f64; 3]>,
    progress: &'a (dyn Fn(u64) + Sync),
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
        let made = group.par_iter().map(|&k| patches.realisation(k)).collect::<Result<Vec<Specimen>>>()?;
        let digest = |specimen: &Specimen| specimen.digest().map(Vec::from);
        digests.extend(made.par_iter().filter_map(digest).collect::<Vec<_>>().concat());
        synthesis_s += clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        for (alpha, records) in alphas.iter().zip(&mut records) {
            let measured =
                group.par_iter().zip(&made).map(|(&k, specimen)| context.realisation(specimen, *alpha, k));
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

impl Context<'_> {
    /// All stops of one realisation.
    fn realisation(
        &self,
        specimen: &Specimen,
        alpha: Option<Alpha>,
        realisation: u64,
    ) -> Result<Vec<StopRecord>> {
        let stage = match specimen {
            Specimen::Patch(patch) => {
                Stage::Heights { patch, walker: Walker::new(&patch.field), alpha: patch.alpha(alpha) }
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
            Stage::Heights { patch, walker, alpha } => {
                let sample = Sample { walker: *walker, alpha: *alpha, image: arms.image };
                let starts = Starts::new(&patch.field, patch.window, sample.to_field(arms.wi));
                let flux = starts.share(plan.block_starts) / plan.blocks as f64;
                starts.each(plan.block_starts, &mut rng, |start| {
                    let mut light = Light::new(self.f0);
                    let ending = if campaign.trace.visibility {
                        sample.trace(start, arms.wi, campaign.trace.bounces, &mut light)
                    } else {
                        sample.trace_unobstructed(start, arms.wi, &mut light)
                    };
                    block.end(ending, light, flux);
                });
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

/// What the paths of one block add to.
struct Block<'a> {
    context: &'a Context<'a>,
    arms: BlockArms,
    stop: usize,
    tally: &'a mut Tally,
    rays: Rays,
}

impl Block<'_> {
    /// Counts a path that carried `flux`.
    fn end(&mut self, ending: Ending, light: Light, flux: f64) {
        self.rays.count(&ending, self.context.campaign);
        let units = to_units(flux);
        match ending {
            Ending::Out { wo, order } => self.arrive(Arrival { wo, order, light, flux, units }),
            Ending::Hidden => self.tally.hidden.add(units),
            Ending::Cut { .. } => self.tally.cut.add(units),
            Ending::LeftMap => self.tally.left_map.add(units),
            Ending::Lost => self.tally.lost += 1,
        }
    }

    /// A path that leaves: into its order, and into its bins, mirrored ones too where the stop is folded.
    fn arrive(&mut self, arrival: Arrival) {
        let Arrival { wo, order, light, flux, units } = arrival;
        let (context, tally) = (self.context, &mut *self.tally);
        let out = &mut tally.orders[order as usize - 1];
        out.count += 1;
        out.flux += units;
        for (sum, left) in out.colours.iter_mut().zip(light.throughput) {
            *sum += if context.f0.is_none() { units } else { to_units(flux * left) };
        }
        let folded = context.plan.folded[self.stop];
        let part = if folded { 0.5 } else { 1.0 };
        let units = to_units(part * flux);
        let mut into_bins = |direction: DVec3| {
            context.sensor.each_bin(direction, |bin| {
                tally.hits[bin] += 1;
                if order > 1 {
                    for (sums, left) in tally.multiple.iter_mut().zip(light.throughput) {
                        sums[bin] += to_units(part * flux * left);
                    }
                } else {
                    tally.single[bin] += units;
                    if let Some(sum) = tally.schlick.get_mut(bin) {
                        *sum += to_units(part * flux * light.first);
                    }
                }
            });
        };
        let wo = self.arms.in_bins(wo);
        into_bins(wo);
        if folded {
            into_bins(self.arms.mirrored(wo));
        }
    }
}

/// The surface of one realisation and roughness.
enum Stage<'a> {
    /// Heights to walk over.
    Heights {
        patch: &'a Patch,
        walker: Walker<'a>,
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

/// A path that leaves the surface.
struct Arrival {
    wo: DVec3,
    order: u32,
    light: Light,
    flux: f64,
    units: u128,
}

/// Counts rays for the cost report.
#[derive(Default)]
struct Rays {
    traced: u64,
    skipped: u64,
}

impl Rays {
    fn count(&mut self, ending: &Ending, campaign: &Campaign) {
        let bounces = u64::from(campaign.trace.bounces);
        // The light's ray, and one after each bounce.
        let (traced, skipped) = match *ending {
            Ending::Out { order, .. } => (1 + u64::from(order), 0),
            Ending::Cut { down } => (1 + bounces - u64::from(down), u64::from(down)),
            Ending::Hidden | Ending::LeftMap | Ending::Lost => (1, 0),
        };
        if campaign.trace.visibility {
            self.traced += traced;
            self.skipped += skipped;
        } else {
            self.skipped += traced + skipped;
        }
    }
}
