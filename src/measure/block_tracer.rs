//! Traces the surface samples of blocks of one incidence, one by one or in waves through the lanes, and tallies them in
//! their order.

use std::cell::RefCell;
use std::time::{Duration, Instant};

use glam::{DVec2, DVec3};
use rand_pcg::Pcg64Dxsm;

use super::accumulate::fresnel_sums::PathWeights;
use super::accumulate::tally::{Tally, to_units};
use super::block_arms::BlockArms;
use super::context::Context;
use super::optics::{FacetWay, PathLight};
use super::prepared_patch::PatchSampler;
use crate::campaign::Campaign;
use crate::optics::FacetKind;
use crate::rng::PathDraws;
use crate::trace::{
    Outcome, PathEnd, PathWaves, SimdTraversal, SmithWalk, SplitEnd, SurfacePoint, Traced, View, Wave,
};

/// Samples that are followed together: their rays fit the cache of a core.
const WAVE: usize = 4096;
/// Blocks that have taken longer than this when the run is asked to end are not waited for.
const GRACE: Duration = Duration::from_millis(200);

thread_local! {
    static WAVES: RefCell<Vec<WaveMemory>> = RefCell::default();
}

/// Calls `work` with the thread's memory for the waves of `count` incidences at once.
pub(super) fn with_waves<T>(count: usize, work: impl FnOnce(&mut [WaveMemory]) -> T) -> T {
    WAVES.with_borrow_mut(|waves| {
        if waves.len() < count {
            waves.resize_with(count, WaveMemory::default);
        }
        work(&mut waves[..count])
    })
}

/// What a thread uses for one wave after another.
#[derive(Default)]
pub(super) struct WaveMemory {
    starts: Vec<SurfacePoint>,
    /// Which turn each surface sample belongs to, and its number there.
    turns: Vec<u16>,
    numbers: Vec<u64>,
    paths: PathWaves,
    lights: Vec<PathLight>,
    endings: Vec<PathEnd>,
    splits: Vec<SplitEnd>,
}

/// One block among those that are followed together. All of its samples carry the same flux.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    arms: BlockArms,
    /// Flux of a path, as a fraction of the incident flux.
    flux: f64,
    /// The same in the tally's units.
    units: u128,
    /// What of it goes into a bin: a half where the mirrored arrival has the other half.
    part: f64,
    part_units: u128,
    /// The light's azimuth in the field, a unit vector; `None` before the first start.
    along: Option<DVec2>,
    /// Starts that were followed.
    started: u64,
}

/// The address of some blocks, and the surface that they are measured on.
pub(super) struct Work<'a> {
    pub sampler: &'a PatchSampler<'a>,
    /// How paths are followed from each surface sample.
    pub ways: &'a [FacetWay],
    pub stop: usize,
    pub realisation: u64,
    pub blocks: &'a [u64],
}

/// What a path brings to where it ends.
struct Carried {
    /// Flux, as a fraction of the incident flux.
    flux: f64,
    /// The same in the tally's units.
    units: u128,
    /// What of it goes into a bin.
    part: f64,
    part_units: u128,
}

/// What the paths of some blocks of an incidence add to.
pub(super) struct BlockTracer<'a> {
    context: &'a Context<'a>,
    stop: usize,
    ways: &'a [FacetWay],
    tally: &'a mut Tally,
    turns: Vec<Turn>,
    /// The turn of the path at hand.
    at: usize,
    /// Samples that were counted.
    counted: u64,
    /// When the blocks began.
    begin: Instant,
    /// Whether they are given up: no further start is followed.
    given_up: bool,
    rays: RayCounts,
    weights: PathWeights,
}

impl<'a> BlockTracer<'a> {
    /// Of an incidence, without blocks yet.
    pub fn new(context: &'a Context<'a>, work: &Work<'a>, tally: &'a mut Tally) -> Self {
        let (rays, weights) = (RayCounts::default(), PathWeights::default());
        let begin = Instant::now();
        let (turns, given_up) = (Vec::new(), false);
        let Work { stop, ways, .. } = *work;
        BlockTracer { context, stop, ways, tally, turns, at: 0, counted: 0, begin, given_up, rays, weights }
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
        let part = if self.context.plan.folded[self.stop] { 0.5 * flux } else { flux };
        let (units, part_units) = (to_units(flux), to_units(part));
        self.turns.push(Turn { arms, flux, units, part, part_units, along: None, started: 0 });
    }

    fn turn(&self) -> &Turn {
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
    fn draws(&mut self) -> PathDraws {
        let turn = &mut self.turns[self.at];
        turn.started += 1;
        PathDraws::new(turn.arms.facets_key, turn.started)
    }

    fn light(&self, way: FacetWay, draws: PathDraws) -> PathLight {
        PathLight::new(way, draws, self.context.plan.sums.needs_angles())
    }

    /// The index of clear facets where both parts of the light are followed: at order 1, without chance.
    fn split_eta(&self, way: FacetWay) -> Option<f64> {
        match way.kind {
            FacetKind::Clear { eta } if self.context.campaign.trace.bounces == 1 => Some(eta),
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
        self.tally.hidden.flux += self.turn().units * self.ways.len() as u128;
    }

    /// Paths that are counted for each start.
    fn paths(&self) -> u64 {
        let parts = |&way: &FacetWay| if self.split_eta(way).is_some() { 2 } else { 1 };
        self.ways.iter().map(parts).sum()
    }

    /// Takes a surface sample of a turn for the next wave, which is followed through the lanes when it is full; paths end in
    /// the order in which they start. `views` has one for each turn.
    pub fn follow_later(
        &mut self,
        views: &[View],
        over: &[SimdTraversal; 2],
        (turn, start): (usize, SurfacePoint),
        wave: &mut WaveMemory,
    ) {
        self.at = turn;
        let View { sample, wi } = &views[turn];
        if self.misses(|| Some(sample.reflected(*wi, &start))) {
            return self.leave_out(1);
        }
        self.turns[turn].started += 1;
        wave.starts.push(start);
        wave.turns.push(turn as u16);
        wave.numbers.push(self.turns[turn].started);
        if wave.starts.len() == WAVE {
            self.follow_wave(views, over, wave);
        }
    }

    /// Follows the samples that `memory` holds.
    pub fn follow_wave(&mut self, views: &[View], over: &[SimdTraversal; 2], memory: &mut WaveMemory) {
        if !self.is_given_up() {
            for (number, &way) in self.ways.iter().enumerate() {
                self.follow_way(views, over, (way, number == 0), memory);
            }
        }
        memory.starts.clear();
        memory.turns.clear();
        memory.numbers.clear();
    }

    /// The same in one way; in the `first` it is noted what the light sees.
    fn follow_way(
        &mut self,
        views: &[View],
        over: &[SimdTraversal; 2],
        (way, first): (FacetWay, bool),
        memory: &mut WaveMemory,
    ) {
        let WaveMemory { starts, turns, numbers, paths, lights, endings, splits } = memory;
        let of_path = |(&turn, &number): (&u16, &u64)| {
            let key = self.turns[usize::from(turn)].arms.facets_key;
            self.light(way, PathDraws::new(key, number))
        };
        lights.clear();
        lights.extend(turns.iter().zip(&*numbers).map(of_path));
        let bounces = self.context.campaign.trace.bounces;
        let wave = Wave { surface_samples: starts, view_of: turns, views, bounces };
        let split = self.split_eta(way);
        match split {
            Some(eta) => paths.trace_split(over, &wave, eta, splits),
            None => paths.trace(over, &wave, lights, endings),
        }
        for (k, ((start, &turn), light)) in starts.iter().zip(&*turns).zip(&*lights).enumerate() {
            self.at = usize::from(turn);
            let ending = if split.is_some() { splits[k].reflected } else { endings[k] };
            if first {
                let sample = &views[self.at].sample;
                self.look(|w| sample.to_field(w), sample.slope(start), ending);
            }
            match split {
                Some(_) => self.end_split(&splits[k], light),
                None => self.end(ending, light),
            }
        }
    }

    /// Notes whether the light sees the facet of a start, where facets of every slope are started on.
    fn look(&mut self, to_field: impl Fn(DVec3) -> DVec3, slope: DVec2, ending: PathEnd) {
        if !self.context.campaign.trace.visibility || self.context.plan.apertures_only {
            return;
        }
        let turn = &mut self.turns[self.at];
        let header = turn.arms.header;
        let along = *turn.along.get_or_insert_with(|| {
            let along = to_field(header).truncate();
            // A surface without an alpha is told by its slopes themselves, whatever unit its heights are in.
            if self.context.campaign.alphas()[0].is_some() { along / along.length() } else { along }
        });
        self.tally.seen.count(slope.dot(along), ending != PathEnd::Shadowed);
    }

    /// Whether nothing but apertures counts, and a start sends light into none: `reflected` is where it goes.
    fn misses(&self, reflected: impl Fn() -> Option<DVec3>) -> bool {
        if !self.context.plan.apertures_only {
            return false;
        }
        let Some(wo) = reflected().filter(|wo| wo.z > 0.0) else { return true };
        let arms = &self.turn().arms;
        let (sensor, wo) = (&self.context.sensor, arms.in_bins(wo));
        let folded = self.context.plan.folded[self.stop];
        let seen = sensor.sees(wo) || (folded && sensor.sees(arms.mirrored(wo)));
        !seen
    }

    /// Counts samples that send light into no aperture: they need no ray.
    fn leave_out(&mut self, starts: u64) {
        self.counted += starts;
        self.tally.outside.add_many(starts, self.turn().units);
        self.rays.skipped += 2 * starts;
    }

    /// Counts all samples of a block none of whose facets is facing the light: they carry nothing.
    pub fn all_turned_away(&mut self, starts: u64) {
        self.counted += starts;
        self.tally.hidden.add_many(starts * self.paths(), 0);
        self.rays.skipped += starts;
    }

    /// Counts what is missing of `starts` as starts that send light into no aperture.
    pub fn leave_out_up_to(&mut self, starts: u64) {
        if !self.given_up {
            self.leave_out(starts.saturating_sub(self.counted));
        }
    }

    /// Counts a path.
    fn end(&mut self, ending: PathEnd, light: &PathLight) {
        self.counted += 1;
        self.rays.count(&ending, self.context.campaign);
        let &Turn { flux, units, part, part_units, .. } = self.turn();
        self.end_with(ending, light, &Carried { flux, units, part, part_units });
    }

    /// Counts both parts of the light of a path, each with its share of the flux.
    fn end_split(&mut self, ends: &SplitEnd, light: &PathLight) {
        let campaign = self.context.campaign;
        self.counted += 1;
        self.rays.count(&ends.reflected, campaign);
        self.rays.count_further(&ends.refracted, campaign);
        let &Turn { flux, units, part, part_units, .. } = self.turn();
        let carried = |share: f64| {
            let (flux, part) = (share * flux, share * part);
            Carried { flux, units: to_units(flux), part, part_units: to_units(part) }
        };
        let up = carried(ends.reflectance);
        // Both parts are the whole, to the last unit.
        let down = Carried {
            units: units - up.units,
            part_units: part_units - up.part_units,
            ..carried(1.0 - ends.reflectance)
        };
        self.end_with(ends.reflected, light, &up);
        self.end_with(ends.refracted, light, &down);
    }

    fn end_with(&mut self, ending: PathEnd, light: &PathLight, carried: &Carried) {
        let units = carried.units;
        match ending {
            PathEnd::Out { wo, order } => self.arrive(wo, order, light, (carried, false)),
            PathEnd::Shadowed => self.tally.hidden.add(units),
            PathEnd::Truncated { .. } => self.tally.cut.add(units),
            PathEnd::LeftDomain { wo, order, further } => {
                self.tally.left_map.add(units);
                if further {
                    self.tally.left(&self.context.plan.sums).cut.add(units);
                }
                if let Some(wo) = wo {
                    self.arrive(wo, order, light, (carried, true));
                }
            }
            PathEnd::Absorbed { .. } => self.tally.absorbed.add(units),
            PathEnd::Lost => self.tally.lost += 1,
        }
    }

    /// A path that leaves: into its order, and into its bins, mirrored ones too where the incidence is folded. One that
    /// left an open map on its way goes into the sums of those.
    fn arrive(&mut self, wo: DVec3, order: u32, light: &PathLight, (carried, left_map): (&Carried, bool)) {
        let (context, weights) = (self.context, &mut self.weights);
        let tally = if left_map { self.tally.left(&context.plan.sums) } else { &mut *self.tally };
        let Carried { flux, units, part, part_units } = carried;
        let arms = &self.turns[self.at].arms;
        let hits_first = light.place() * context.plan.bins;
        context.plan.sums.weigh(light, order, weights);
        let orders = if wo.z > 0.0 { &mut tally.orders } else { &mut tally.through };
        let out = &mut orders[order as usize - 1];
        out.count += 1;
        out.flux += units;
        for (sum, weight) in out.weighted[weights.order_first..].iter_mut().zip(&weights.order) {
            *sum += to_units(flux * weight);
        }
        let share = |weight: &f64| to_units(part * weight);
        let into_bin = |bin: usize| {
            tally.hits[hits_first + bin] += 1;
            let sums = if order > 1 {
                &mut tally.multiple[weights.first..]
            } else {
                tally.single[bin] += part_units;
                &mut tally.first[weights.first..]
            };
            for (sums, weight) in sums.iter_mut().zip(&weights.bins) {
                sums[bin] += share(weight);
            }
        };
        let wo = arms.in_bins(wo);
        if context.plan.folded[self.stop] {
            context.sensor.each_bin_of_both(wo, arms.mirrored(wo), arms.mirror_deg, into_bin);
        } else {
            context.sensor.each_bin(wo, into_bin);
        }
    }
}

impl Drop for BlockTracer<'_> {
    /// Adds the blocks' rays to the run's.
    fn drop(&mut self) {
        self.context.add_rays(self.rays.traced, self.rays.skipped);
    }
}

/// Counts rays for the cost report.
#[derive(Default)]
struct RayCounts {
    traced: u64,
    skipped: u64,
}

impl RayCounts {
    /// The second part of split light: its ray alone.
    fn count_further(&mut self, ending: &PathEnd, campaign: &Campaign) {
        let traced = match ending {
            PathEnd::Shadowed | PathEnd::Lost | PathEnd::Absorbed { .. } => return,
            PathEnd::Truncated { down } => !down,
            PathEnd::Out { .. } | PathEnd::LeftDomain { .. } => true,
        };
        let traced = traced && campaign.trace.visibility;
        self.traced += u64::from(traced);
        self.skipped += u64::from(!traced);
    }

    fn count(&mut self, ending: &PathEnd, campaign: &Campaign) {
        let bounces = u64::from(campaign.trace.bounces);
        // The light's ray, and one after each bounce.
        let (traced, skipped) = match *ending {
            PathEnd::Out { order, .. } | PathEnd::LeftDomain { order, .. } | PathEnd::Absorbed { order } => {
                (1 + u64::from(order), 0)
            }
            PathEnd::Truncated { down } => (1 + bounces - u64::from(down), u64::from(down)),
            PathEnd::Shadowed | PathEnd::Lost => (1, 0),
        };
        if campaign.trace.visibility {
            self.traced += traced;
            self.skipped += skipped;
        } else {
            self.skipped += traced + skipped;
        }
    }
}
