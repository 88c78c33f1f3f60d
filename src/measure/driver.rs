//! The measurement itself: realisations, incidences and blocks in parallel, integer sums in any order, round by round.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::mpsc;
use std::thread;
use std::time::Instant;

use rayon::prelude::*;

use super::accumulate::assemble::{Measured, assemble};
use super::context::Context;
use super::cost::{Cost, cpu_seconds};
use super::patches::Patches;
use super::patches::specimen::Specimen;
use super::persist::run_state::RunState;
use super::plan::Plan;
use super::prepared_patch::PreparedPatch;
use super::session::{Keeper, Session, interrupted, locked};
use super::stopping;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::files;

/// Measures a campaign: one result for each roughness and material. `progress` is called with the samples of every finished block.
///
/// Errors: those of loading patches; `Internal` if a ray is lost.
pub fn measure(
    campaign: &Campaign,
    plan: &Plan,
    patches: &Patches,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<(Vec<Measured>, Cost)> {
    let run_state = RunState::new(campaign, plan);
    let run_state = measure_missing(campaign, plan, patches, run_state, &Session::plain(progress))?;
    Ok(tables(campaign, plan, run_state))
}

/// Measures what is missing in `run_state`, and keeps what is finished as the session asks.
///
/// Errors: as [`measure`]; `Interrupted`; `Io` where the last checkpoint could not be written; `Format` where a patch
/// is not the one of the sums in `run_state`.
pub fn measure_missing(
    campaign: &Campaign,
    plan: &Plan,
    patches: &Patches,
    run_state: RunState,
    session: &Session,
) -> Result<RunState> {
    let context = Context::new(campaign, plan, session, run_state);
    let cost = || context.cost();
    let keeper = Keeper { session, campaign, plan, run_state: &context.run_state, cost: &cost };
    let mut run = RunRounds { context: &context, patches, mounted: BTreeMap::new() };
    let (measured, kept) = thread::scope(|scope| {
        let (others, end) = mpsc::channel();
        let keeper = match thread::Builder::new().spawn_scoped(scope, move || keeper.run(end)) {
            Ok(keeper) => keeper,
            Err(why) => return (Err(no_thread(&why)), Ok(())),
        };
        let measured = run.rounds();
        drop(others);
        (measured, keeper.join().unwrap_or_else(|_| Err(Error::Internal("a checkpoint".into()))))
    });
    let cost = context.cost();
    let mut run_state = context.run_state.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    run_state.cost = cost;
    measured?;
    if session.is_over() {
        kept?;
        return Err(interrupted(&run_state, plan));
    }
    // A last checkpoint that failed is not an error here: the tables are written next, to the same disk.
    Ok(run_state)
}

fn no_thread(why: &std::io::Error) -> Error {
    Error::Refused(format!(
        "the thread that writes checkpoints cannot be started: {why}; raise the limit of processes or of memory (ulimit \
         -u, ulimit -v), or give fewer --threads"
    ))
}

/// The tables of a run_state in which nothing is missing.
pub fn tables(campaign: &Campaign, plan: &Plan, run_state: RunState) -> (Vec<Measured>, Cost) {
    let cost = run_state.cost(plan);
    let RunState { tables, digests, .. } = run_state;
    let digests: Vec<u8> = digests.into_iter().flatten().flatten().collect();
    let patch_digest = if digests.is_empty() { String::new() } else { files::sha256_hex(&digests) };
    let finished = tables.finished().into_iter();
    (finished.flat_map(|table| assemble(campaign, plan, &table, &patch_digest)).collect(), cost)
}

/// A measurement under way.
struct RunRounds<'a> {
    context: &'a Context<'a>,
    patches: &'a Patches,
    /// Patches that are looked at again in a further round, by realisation.
    mounted: BTreeMap<u64, PreparedPatch>,
}

impl RunRounds<'_> {
    /// All rounds that are not over yet.
    fn rounds(&mut self) -> Result<()> {
        let Context { campaign, plan, session, run_state, .. } = self.context;
        for round in stopping::rounds(&campaign.stop, plan.blocks) {
            if locked(run_state).tables.all_ended() {
                break;
            }
            if locked(run_state).tables.is_judged(round.end) {
                continue;
            }
            let clock = Instant::now();
            self.round(&round)?;
            if session.is_over() {
                break;
            }
            let mut run_state = locked(run_state);
            run_state.tables.judge(campaign, plan, round.end);
            // A further round would take about as long as this one.
            let spent = self.context.cost().wall_s + clock.elapsed().as_secs_f64();
            if campaign.stop.seconds.is_some_and(|budget| spent > budget) {
                run_state.tables.time_is_over();
            }
        }
        Ok(())
    }

    /// The blocks of one round, for all open incidences of all realisations.
    fn round(&mut self, blocks: &Range<u64>) -> Result<()> {
        let Context { plan, session, run_state, .. } = self.context;
        let wanted: Vec<u64> = {
            let run_state = locked(run_state);
            (0..u64::from(plan.realisations)).filter(|&k| run_state.tables.misses(k, blocks)).collect()
        };
        // As many patches in memory as there are threads to make them.
        for group in wanted.chunks(rayon::current_num_threads()) {
            if session.is_over() {
                break;
            }
            let missing: Vec<u64> = group.iter().copied().filter(|k| !self.mounted.contains_key(k)).collect();
            self.mount(&missing)?;
            self.trace(group, blocks)?;
            if blocks.end == plan.blocks {
                group.iter().for_each(|k| drop(self.mounted.remove(k)));
            }
        }
        Ok(())
    }

    /// Makes patches and lays them out.
    fn mount(&mut self, realisations: &[u64]) -> Result<()> {
        if let (Some(first), Some(last)) = (realisations.first(), realisations.last()) {
            let all = self.context.plan.realisations;
            let which = if first == last {
                format!("patch {}", first + 1)
            } else {
                format!("patches {} to {}", first + 1, last + 1)
            };
            (self.context.session.stage)(&format!("making {which} of {all}"));
        }
        let clock = Instant::now();
        let made = realisations.par_iter().map(|&k| self.patches.realisation(k));
        let made = made.collect::<Result<Vec<Specimen>>>()?;
        let digest = |(&k, made): (&u64, &Specimen)| {
            if k == 0 {
                (self.context.session.first_specimen)(made);
            }
            made.digest()
        };
        let digests: Vec<_> = realisations.par_iter().zip(&made).map(digest).collect();
        for (&k, digest) in realisations.iter().zip(digests) {
            self.context.note_digest(k, digest)?;
        }
        let cpu = cpu_seconds();
        let mount = |made: Specimen| PreparedPatch::new(made, self.context.campaign, self.context.plan);
        let mounted: Vec<PreparedPatch> = made.into_par_iter().map(mount).collect();
        self.mounted.extend(realisations.iter().copied().zip(mounted));
        let (wall_s, cpu_s) = (clock.elapsed().as_secs_f64(), cpu_seconds() - cpu);
        locked(&self.context.clocks).made_patches(wall_s, cpu_s);
        (self.context.session.stage)("");
        Ok(())
    }

    fn trace(&self, realisations: &[u64], blocks: &Range<u64>) -> Result<()> {
        let context = self.context;
        locked(&context.clocks).tracing_begins();
        let tables = locked(&context.run_state).tables.count();
        let on_stage: Vec<_> = realisations.iter().filter_map(|k| Some((*k, self.mounted.get(k)?))).collect();
        let traced = (0..tables).try_for_each(|table| {
            on_stage.par_iter().try_for_each(|&(k, mounted)| context.pass(mounted, (table, k), blocks))
        });
        locked(&context.clocks).tracing_ends();
        traced
    }
}
