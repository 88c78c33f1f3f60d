//! The measurement itself: realisations, stops and blocks in parallel, integer sums in any order, round by round.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use super::assemble::{Measured, assemble};
use super::cost::{Cost, cpu_seconds, peak_bytes};
use super::patches::{Patches, Specimen};
use super::plan::Plan;
use super::record::StopRecord;
use super::rounds::Tables;
use super::stage::Mounted;
use super::stopping;
use super::tally::Tally;
use super::ways::Work;
use crate::campaign::{Alpha, Campaign};
use crate::error::{Error, Result};
use crate::files;
use crate::instrument::Sensor;
use crate::trace::Kernel;

/// Everything that blocks share.
pub(super) struct Context<'a> {
    pub campaign: &'a Campaign,
    pub plan: &'a Plan,
    pub sensor: Sensor,
    pub progress: &'a (dyn Fn(u64) + Sync),
    kernel: Kernel,
    rays: AtomicU64,
    skipped: AtomicU64,
}

/// Measures a campaign: one result for each roughness and material. `progress` is called with the starts of every finished block.
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
    let Run { synthesis_s, tracing_s, tracing_cpu_s, .. } = run;
    let samples = run.tables.starts(plan);
    let finished = run.tables.finished(plan).into_iter();
    let results = finished.flat_map(|table| assemble(campaign, plan, table, &patch_digest)).collect();
    let cost = Cost {
        wall_s: begin.elapsed().as_secs_f64(),
        cpu_s: cpu_seconds() - cpu,
        synthesis_s,
        tracing_s,
        tracing_cpu_s,
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
    tracing_cpu_s: f64,
}

impl<'a> Run<'a> {
    fn new(context: &'a Context<'a>, patches: &'a Patches) -> Self {
        let tables = Tables::new(context.campaign, context.plan);
        let (synthesis_s, tracing_s, tracing_cpu_s) = (0.0, 0.0, 0.0);
        let (kept, digests) = (Vec::new(), Vec::new());
        Run { context, patches, kept, digests, tables, synthesis_s, tracing_s, tracing_cpu_s }
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
        let made = realisations.par_iter().map(|&k| self.patches.realisation(k));
        let made = made.collect::<Result<Vec<Specimen>>>()?;
        let digests: Vec<_> = made.par_iter().filter_map(|made| made.digest().map(Vec::from)).collect();
        self.digests.extend(digests.concat());
        let cpu = cpu_seconds();
        let mount = |made: Specimen| Mounted::new(made, self.context.campaign, self.context.plan);
        let mounted = made.into_par_iter().map(mount).collect();
        self.tracing_cpu_s += cpu_seconds() - cpu;
        self.synthesis_s += clock.elapsed().as_secs_f64();
        Ok(mounted)
    }

    fn trace(&mut self, realisations: &[u64], mounted: &[Mounted], blocks: &Range<u64>) -> Result<()> {
        let (clock, cpu) = (Instant::now(), cpu_seconds());
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
        self.tracing_cpu_s += cpu_seconds() - cpu;
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
        let groups = stage.groups(open, self.campaign, self.plan, realisation);
        let measured = groups.par_iter().map(|group| {
            let empty = || vec![Tally::new(self.plan.bins, &self.plan.weighing); group.stops.len()];
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

    /// Adds to the rays of the cost report.
    pub(super) fn add_rays(&self, traced: u64, skipped: u64) {
        self.rays.fetch_add(traced, Ordering::Relaxed);
        self.skipped.fetch_add(skipped, Ordering::Relaxed);
    }
}
