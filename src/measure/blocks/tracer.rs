//! Traces the surface samples of blocks of one incidence, one by one or in waves through the lanes, and tallies them in
//! their order.

use std::time::{Duration, Instant};

use glam::DVec2;
use rand_pcg::Pcg64Dxsm;

use super::arms::BlockArms;
use super::ray_counts::RayCounts;
use crate::measure::accumulate::fresnel_sums::path_weights::PathWeights;
use crate::measure::accumulate::tally::{Tally, to_units};
use crate::measure::context::Context;
use crate::measure::optics::{FacetWay, PathLight};
use crate::measure::prepared_patch::PatchSampler;
use crate::optics::FacetKind;
use crate::rng::PathDraws;
use crate::trace::{Outcome, PathEnd, SmithWalk, Traced};

/// Blocks that have taken longer than this when the run is asked to end are not waited for.
const GRACE: Duration = Duration::from_millis(200);

/// What a path brings to where it ends.
#[derive(Clone, Copy)]
pub(super) struct Carried {
    /// Flux, as a fraction of the incident flux.
    pub(super) flux: f64,
    /// The same in the tally's units.
    pub(super) units: u128,
    /// What of it goes into a bin: a half where the mirrored arrival has the other half.
    pub(super) part: f64,
    pub(super) part_units: u128,
}

impl Carried {
    pub(super) fn new(flux: f64, part: f64) -> Self {
        Carried { flux, units: to_units(flux), part, part_units: to_units(part) }
    }
}

/// One block among those that are followed together. All of its samples carry the same flux.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    pub(super) arms: BlockArms,
    /// What each path carries.
    pub(super) carried: Carried,
    /// The light's azimuth in the field, a unit vector; `None` before the first start.
    pub(super) along: Option<DVec2>,
    /// Starts that were followed.
    pub(super) started: u64,
}

/// The address of some blocks, and the surface that they are measured on.
pub(in crate::measure) struct Work<'a> {
    pub sampler: &'a PatchSampler<'a>,
    /// How paths are followed from each surface sample.
    pub ways: &'a [FacetWay],
    pub incidence: usize,
    pub realisation: u64,
    pub blocks: &'a [u64],
}

/// What the paths of some blocks of an incidence add to.
pub(super) struct BlockTracer<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) incidence: usize,
    pub(super) ways: &'a [FacetWay],
    pub(super) tally: &'a mut Tally,
    pub(super) turns: Vec<Turn>,
    /// The turn of the path at hand.
    pub(super) at: usize,
    /// Paths that were counted.
    pub(super) counted: u64,
    /// When the blocks began.
    pub(super) begin: Instant,
    /// Whether they are given up: no further start is followed.
    pub(super) given_up: bool,
    pub(super) rays: RayCounts,
    pub(super) weights: PathWeights,
}

impl<'a> BlockTracer<'a> {
    /// Of an incidence, without blocks yet.
    pub fn new(context: &'a Context<'a>, work: &Work<'a>, tally: &'a mut Tally) -> Self {
        let (rays, weights) = (RayCounts::default(), PathWeights::default());
        let begin = Instant::now();
        let (turns, given_up) = (Vec::new(), false);
        let Work { incidence, ways, .. } = *work;
        BlockTracer {
            context,
            incidence,
            ways,
            tally,
            turns,
            at: 0,
            counted: 0,
            begin,
            given_up,
            rays,
            weights,
        }
    }

    /// One block whose paths carry `flux` each.
    pub fn one(
        context: &'a Context<'a>,
        work: &Work<'a>,
        arms: BlockArms,
        flux: f64,
        tally: &'a mut Tally,
    ) -> Self {
        let mut one = BlockTracer::new(context, work, tally);
        one.take(arms, flux);
        one
    }

    /// One block more: its paths carry `flux` each.
    pub fn take(&mut self, arms: BlockArms, flux: f64) {
        let part = if self.context.plan.folded[self.incidence] { 0.5 * flux } else { flux };
        self.turns.push(Turn { arms, carried: Carried::new(flux, part), along: None, started: 0 });
    }

    pub(super) fn turn(&self) -> &Turn {
        &self.turns[self.at]
    }

    /// Whether the run is to end and the blocks have taken so long that they are given up: the tally misses starts.
    pub fn is_given_up(&mut self) -> bool {
        if !self.given_up && self.context.session.is_over() && self.begin.elapsed() > GRACE {
            self.given_up = true;
        }
        self.given_up
    }

    /// Follows a surface sample of a turn by itself.
    pub fn follow<S: Traced>(&mut self, surface: &S, turn: usize, start: S::Point) {
        if self.is_given_up() {
            return;
        }
        self.at = turn;
        let (trace, wi) = (&self.context.campaign.trace, self.turn().arms.wi);
        if self.misses(|| surface.reflect(wi, &start)) {
            return self.leave_out(1);
        }
        let slope = surface.slope(&start);
        let draws = self.draws();
        for (number, &way) in self.ways.iter().enumerate() {
            let mut light = self.light(way, draws);
            let ending = match self.split_eta(way) {
                Some(eta) => {
                    let split = if trace.visibility {
                        surface.trace_split(&start, wi, eta)
                    } else {
                        surface.split_unobstructed(&start, wi, eta)
                    };
                    self.end_split(&split, &light);
                    split.reflected
                }
                None => {
                    let ending = if trace.visibility {
                        surface.trace(start, wi, trace.bounces, &mut light)
                    } else {
                        surface.trace_unobstructed(&start, wi, &mut light)
                    };
                    self.end(ending, &light);
                    ending
                }
            };
            if number == 0 {
                self.look(|w| surface.to_field(w), slope, ending);
            }
        }
    }

    /// Follows paths through a law, whose draws decide facets and heights.
    pub fn follow_law(&mut self, walk: &SmithWalk, rng: &mut Pcg64Dxsm) {
        let (bounces, wi) = (self.context.campaign.trace.bounces, self.turn().arms.wi);
        let draws = self.draws();
        for &way in self.ways {
            let mut light = self.light(way, draws);
            match self.split_eta(way) {
                Some(eta) => self.end_split(&walk.trace_split(wi, eta, rng), &light),
                None => {
                    let ending = walk.trace(wi, bounces, rng, &mut light);
                    self.end(ending, &light);
                }
            }
        }
    }

    /// The numbers that decide at the facets of the next path of the turn.
    pub(super) fn draws(&mut self) -> PathDraws {
        let turn = &mut self.turns[self.at];
        turn.started += 1;
        PathDraws::new(turn.arms.facets_key, turn.started)
    }

    pub(super) fn light(&self, way: FacetWay, draws: PathDraws) -> PathLight {
        PathLight::new(way, draws, self.context.plan.sums.kept())
    }

    /// The index of clear facets where both parts of the light are followed: at order 1, without chance.
    pub(super) fn split_eta(&self, way: FacetWay) -> Option<f64> {
        match way.kind {
            FacetKind::Dielectric { eta } if self.context.campaign.trace.bounces == 1 => Some(eta),
            _ => None,
        }
    }

    /// Follows what a ray from above met: a surface sample that the light sees.
    pub fn follow_lit<S: Traced>(&mut self, surface: &S, met: Outcome<S::Point>) {
        if self.is_given_up() {
            return;
        }
        let (bounces, wi) = (self.context.campaign.trace.bounces, self.turn().arms.wi);
        let draws = self.draws();
        for &way in self.ways {
            let mut light = self.light(way, draws);
            match (met, self.split_eta(way)) {
                (Outcome::Hit(start), Some(eta)) => {
                    self.end_split(&surface.split_lit(&start, wi, eta, false), &light);
                }
                (Outcome::Hit(start), None) => {
                    let ending = surface.trace_lit(start, wi, (bounces, false), &mut light);
                    self.end(ending, &light);
                }
                // Nothing lets a ray through.
                _ => self.end(PathEnd::Lost, &light),
            }
        }
    }

    /// Counts a surface sample that something else of the surface lies over.
    pub fn bury(&mut self) {
        self.counted += 1;
        self.rays.skipped += 1;
        let paths = self.paths();
        // Of both parts of split light one has it all.
        self.tally.hidden.count += paths;
        self.tally.hidden.flux += self.turn().carried.units * self.ways.len() as u128;
    }

    /// Paths that are counted for each start.
    pub(super) fn paths(&self) -> u64 {
        let parts = |&way: &FacetWay| if self.split_eta(way).is_some() { 2 } else { 1 };
        self.ways.iter().map(parts).sum()
    }
}
