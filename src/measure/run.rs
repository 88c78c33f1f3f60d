//! The measurement itself: realisations, stops and blocks in parallel, integer sums in any order, round by round.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use super::arms::{BlockArms, starts_stream};
use super::assemble::{Measured, StopRecord, assemble};
use super::block::{Block, with_waves};
use super::cost::{Cost, cpu_seconds, peak_bytes};
use super::optics::{Light, f0_of};
use super::patches::Patches;
use super::plan::{Plan, fits_the_lanes};
use super::rounds::Tables;
use super::stage::{Group, Heights, Mounted, Stage};
use super::stopping;
use super::tally::{Shape, Tally};
use crate::campaign::{Alpha, Campaign};
use crate::error::{Error, Result};
use crate::files;
use crate::instrument::Sensor;
use crate::rng;
use crate::trace::{Kernel, Sample, Starts, Sweep};

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
    let mut run = Run::new(&context, patches);
    for round in stopping::rounds(&campaign.stop, plan.blocks) {
        let clock = Instant::now();
        // Patches that are looked at again are kept.
        run.round(round.clone(), round.end < plan.blocks)?;
        run.tables.judge(campaign, plan, round.end);
        let over = campaign.stop.seconds.is_some_and(|budget| {
            // A further round would take about as long as this one.
            (begin.elapsed() + clock.elapsed()).as_secs_f64() > budget
        });
        if over {
            run.tables.time_is_over();
        }
        if run.tables.all_ended() {
            break;
        }
    }
    let patch_digest = if run.digests.is_empty() { String::new() } else { files::sha256_hex(&run.digests) };
    let (synthesis_s, tracing_s) = (run.synthesis_s, run.tracing_s);
    let samples = run.tables.starts(plan);
    let results = run
        .tables
        .finished(plan)
        .into_iter()
        .map(|(alpha, records, stops)| assemble(campaign, plan, alpha, records, &stops, &patch_digest));
    let results = results.collect();
    let cost = Cost {
        wall_s: begin.elapsed().as_secs_f64(),
        cpu_s: cpu_seconds() - cpu,
        synthesis_s,
        tracing_s,
        threads: rayon::current_num_threads(),
        samples,
        rays_traced: context.rays.into_inner(),
        rays_skipped: context.skipped.into_inner(),
        peak_bytes: peak_bytes(),
    };
    Ok((results, cost))
}

/// A measurement under way.
struct Run<'a> {
    context: &'a Context<'a>,
    patches: &'a Patches,
    /// Patches kept from the first round.
    kept: Vec<Mounted>,
    digests: Vec<u8>,
    tables: Tables,
    synthesis_s: f64,
    tracing_s: f64,
}

impl<'a> Run<'a> {
    fn new(context: &'a Context<'a>, patches: &'a Patches) -> Self {
        let tables = Tables::new(context.campaign, context.plan);
        Run { context, patches, kept: vec![], digests: vec![], tables, synthesis_s: 0.0, tracing_s: 0.0 }
    }

    /// The blocks of one round, for all open stops of all realisations.
    fn round(&mut self, blocks: Range<u64>, keep: bool) -> Result<()> {
        let all: Vec<u64> = (0..u64::from(self.context.plan.realisations)).collect();
        // As many patches in memory as there are threads to make them.
        for group in all.chunks(rayon::current_num_threads()) {
            if blocks.start > 0 {
                let kept = std::mem::take(&mut self.kept);
                self.trace(group, &kept[group[0] as usize..][..group.len()], &blocks)?;
                self.kept = kept;
                continue;
            }
            let made = self.mount(group)?;
            self.trace(group, &made, &blocks)?;
            if keep {
                self.kept.extend(made);
            }
        }
        Ok(())
    }

    fn mount(&mut self, realisations: &[u64]) -> Result<Vec<Mounted>> {
        let clock = Instant::now();
        let mount = |&k: &u64| Ok(Mounted::new(self.patches.realisation(k)?, self.context.campaign));
        let made = realisations.par_iter().map(mount).collect::<Result<Vec<Mounted>>>()?;
        let digest = |mounted: &Mounted| mounted.specimen.digest().map(Vec::from);
        self.digests.extend(made.par_iter().filter_map(digest).collect::<Vec<_>>().concat());
        self.synthesis_s += clock.elapsed().as_secs_f64();
        Ok(made)
    }

    fn trace(&mut self, realisations: &[u64], mounted: &[Mounted], blocks: &Range<u64>) -> Result<()> {
        let clock = Instant::now();
        for table in self.tables.each_mut() {
            let open = table.open_stops();
            let measured = realisations.par_iter().zip(mounted).map(|(&realisation, mounted)| {
                self.context.realisation(mounted, table.alpha, realisation, &open, blocks)
            });
            for (&realisation, records) in realisations.iter().zip(measured.collect::<Result<Vec<_>>>()?) {
                table.add(realisation as usize, records);
            }
        }
        self.tracing_s += clock.elapsed().as_secs_f64();
        Ok(())
    }
}

impl Context<'_> {
    /// Some blocks of the `open` stops of one realisation, in any order of the stops.
    fn realisation(
        &self,
        mounted: &Mounted,
        alpha: Option<Alpha>,
        realisation: u64,
        open: &[usize],
        blocks: &Range<u64>,
    ) -> Result<Vec<(usize, StopRecord)>> {
        let stage = mounted.stage(alpha, self.kernel, self.campaign);
        let groups = stage.groups(open, self.campaign, self.plan);
        let measured = groups.par_iter().map(|group| {
            let empty = || vec![Tally::new(self.shape()); group.stops.len()];
            let tallies = blocks
                .clone()
                .into_par_iter()
                .fold(empty, |mut tallies, block| {
                    self.block(&Work { stage: &stage, group, realisation, block }, &mut tallies);
                    tallies
                })
                .reduce(empty, |a, b| a.into_iter().zip(b).map(|(a, b)| a.merge(b)).collect());
            let records = group.stops.iter().zip(&tallies);
            records.map(|(&stop, tally)| Ok((stop, self.record(realisation, stop, tally, blocks)?))).collect()
        });
        Ok(measured.collect::<Result<Vec<Vec<_>>>>()?.concat())
    }

    /// The record of a tally in which no start may be missing.
    fn record(
        &self,
        realisation: u64,
        stop: usize,
        tally: &Tally,
        blocks: &Range<u64>,
    ) -> Result<StopRecord> {
        let wanted = (blocks.end - blocks.start) * self.plan.block_starts;
        if tally.lost == 0 && tally.starts() == wanted {
            return Ok(StopRecord::new(tally));
        }
        let (lost, starts) = (tally.lost, tally.starts());
        Err(Error::Internal(format!(
            "realisation {realisation}, stop {stop}: {lost} rays lost, {starts} of {wanted} starts counted"
        )))
    }

    fn shape(&self) -> Shape {
        Shape {
            bins: self.plan.bins,
            bounces: self.campaign.trace.bounces,
            fresnel_colours: self.f0.map_or(0, |_| self.plan.colours),
        }
    }

    /// One block of starts of every stop of a group.
    fn block(&self, work: &Work, tallies: &mut [Tally]) {
        match work.stage {
            Stage::Heights(heights) if work.group.swept => self.swept_block(work, heights, tallies),
            Stage::Heights(heights) => self.ray_block(work, heights, &mut tallies[0]),
            Stage::Statistical(walk) => {
                let stop = work.group.stops[0];
                let arms = self.arms(work, stop);
                let mut rng = rng::stream(self.starts_stream(work, stop));
                let flux = 1.0 / (self.plan.block_starts as f64 * self.plan.blocks as f64);
                let mut block = Block::new(self, arms, stop, flux, false, &mut tallies[0]);
                for _ in 0..self.plan.block_starts {
                    let mut light = Light::new(self.f0);
                    let ending = walk.trace(arms.wi, self.campaign.trace.bounces, &mut rng, &mut light);
                    block.end(ending, light);
                }
            }
        }
        (self.progress)(self.plan.block_starts * work.group.stops.len() as u64);
    }

    /// Starts on the facets, and a ray towards the light for each.
    fn ray_block(&self, work: &Work, heights: &Heights, tally: &mut Tally) {
        let (plan, stop) = (self.plan, work.group.stops[0]);
        let arms = self.arms(work, stop);
        let mut rng = rng::stream(self.starts_stream(work, stop));
        let sample = Sample { walker: heights.walker, alpha: heights.alpha, image: arms.image };
        let light = sample.to_field(arms.wi);
        let starts = Starts::new(&heights.patch.field, heights.patch.window, light);
        let flux = starts.share(plan.block_starts) / plan.blocks as f64;
        let mut block = Block::new(self, arms, stop, flux, false, tally);
        match heights.lanes.filter(|_| fits_the_lanes(heights.walker.range(), light)) {
            Some(over) => with_waves(1, |waves| {
                starts.each(plan.block_starts, &mut rng, |start| {
                    block.follow_later(&sample, &over, start, &mut waves[0]);
                });
                block.follow_wave(&sample, &over, &mut waves[0]);
            }),
            None => starts.each(plan.block_starts, &mut rng, |start| block.follow(&sample, start)),
        }
    }

    /// Starts along the lines of a sweep, which says as well which of them the light sees.
    fn swept_block(&self, work: &Work, heights: &Heights, tallies: &mut [Tally]) {
        let (Some(over), Some(layout)) = (&heights.lanes, &heights.layout) else {
            unreachable!("only fields with both are swept");
        };
        let (plan, stops) = (self.plan, &work.group.stops);
        let arms: Vec<BlockArms> = stops.iter().map(|&stop| self.arms(work, stop)).collect();
        let sample = Sample { walker: heights.walker, alpha: heights.alpha, image: arms[0].image };
        let lights: Vec<_> = arms.iter().map(|arms| sample.to_field(arms.wi)).collect();
        let heading = sample.to_field(arms[0].heading).truncate();
        let sweep = Sweep::new(layout, heading, &lights, arms[0].line);
        let offset = |&stop: &usize| rng::uniform(&mut rng::stream(self.starts_stream(work, stop)));
        let offsets: Vec<f64> = stops.iter().map(offset).collect();
        let of_stop = |(k, tally): (usize, _)| {
            let flux = sweep.share(k, plan.block_starts) / plan.blocks as f64;
            Block::new(self, arms[k], stops[k], flux, true, tally)
        };
        let mut blocks: Vec<Block> = tallies.iter_mut().enumerate().map(of_stop).collect();
        with_waves(blocks.len(), |waves| {
            sweep.each(plan.block_starts, &offsets, |k, start, lit| {
                if lit {
                    blocks[k].follow_later(&sample, over, start, &mut waves[k]);
                } else {
                    blocks[k].hide();
                }
            });
            for (block, wave) in blocks.iter_mut().zip(waves) {
                block.follow_wave(&sample, over, wave);
            }
        });
    }

    fn arms(&self, work: &Work, stop: usize) -> BlockArms {
        BlockArms::new(self.campaign, self.plan, stop, work.realisation, work.block)
    }

    fn starts_stream(&self, work: &Work, stop: usize) -> rng::StreamId {
        starts_stream(self.campaign, self.plan, stop, work.realisation, work.block)
    }

    /// Adds to the rays of the cost report.
    pub(super) fn add_rays(&self, traced: u64, skipped: u64) {
        self.rays.fetch_add(traced, Ordering::Relaxed);
        self.skipped.fetch_add(skipped, Ordering::Relaxed);
    }
}

/// The address of a block, and the surface that it is measured on.
struct Work<'a> {
    stage: &'a Stage<'a>,
    group: &'a Group,
    realisation: u64,
    block: u64,
}
