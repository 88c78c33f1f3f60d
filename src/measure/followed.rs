//! One block of starts: followed one by one or in waves through the lanes, and tallied in the order of the starts.

use std::cell::RefCell;

use glam::{DVec2, DVec3};

use super::arms::BlockArms;
use super::optics::Light;
use super::run::Context;
use super::tally::{Tally, to_units};
use super::weighing::PathWeights;
use crate::campaign::Campaign;
use crate::trace::{Ending, LaneWalker, PathWaves, Place, Sample, Wave};

/// Starts that are followed together: their rays fit the cache of a core.
const WAVE: usize = 4096;

thread_local! {
    static WAVES: RefCell<Vec<WaveMemory>> = RefCell::default();
}

/// Calls `work` with the thread's memory for the waves of `count` stops at once.
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
    starts: Vec<Place>,
    paths: PathWaves,
    lights: Vec<Light>,
    endings: Vec<Ending>,
}

/// What the paths of one block add to. All of its starts carry the same flux.
pub(super) struct Block<'a> {
    context: &'a Context<'a>,
    arms: BlockArms,
    stop: usize,
    tally: &'a mut Tally,
    /// Flux of a path, as a share of the incident flux.
    flux: f64,
    /// The same in the tally's units.
    units: u128,
    /// What of it goes into a bin: a half where the mirrored arrival has the other half.
    part: f64,
    part_units: u128,
    /// Whether the starts are known to see the light.
    lit: bool,
    /// The light's azimuth in the field, a unit vector; `None` before the first start.
    along: Option<DVec2>,
    /// Starts that were counted.
    counted: u64,
    rays: Rays,
    weights: PathWeights,
}

impl<'a> Block<'a> {
    /// A block of `stop` whose paths carry `flux` each; `lit` where only those that the light sees are followed.
    pub fn new(
        context: &'a Context<'a>,
        arms: BlockArms,
        stop: usize,
        flux: f64,
        lit: bool,
        tally: &'a mut Tally,
    ) -> Self {
        let part = if context.plan.folded[stop] { 0.5 * flux } else { flux };
        let (units, part_units) = (to_units(flux), to_units(part));
        Block {
            context,
            arms,
            stop,
            tally,
            flux,
            units,
            part,
            part_units,
            lit,
            along: None,
            counted: 0,
            rays: Rays::default(),
            weights: PathWeights::default(),
        }
    }

    /// Follows every start by itself.
    pub fn follow(&mut self, sample: &Sample, start: Place) {
        if self.misses(sample, &start) {
            return self.leave_out(1);
        }
        let (trace, wi) = (&self.context.campaign.trace, self.arms.wi);
        let mut light = Light::new(self.context.plan.weighing.needs_angles());
        let ending = if trace.visibility {
            sample.trace(start, wi, trace.bounces, &mut light)
        } else {
            sample.trace_unobstructed(start, wi, &mut light)
        };
        self.look(sample, &start, ending);
        self.end(ending, &light);
    }

    /// Takes a start for the next wave, which is followed through the lanes when it is full; paths end in the order
    /// in which they start.
    pub fn follow_later(&mut self, sample: &Sample, over: &LaneWalker, start: Place, wave: &mut WaveMemory) {
        if self.misses(sample, &start) {
            return self.leave_out(1);
        }
        wave.starts.push(start);
        if wave.starts.len() == WAVE {
            self.follow_wave(sample, over, wave);
        }
    }

    /// Follows the starts that `memory` holds.
    pub fn follow_wave(&mut self, sample: &Sample, over: &LaneWalker, memory: &mut WaveMemory) {
        let WaveMemory { starts, paths, lights, endings } = memory;
        let weighed = self.context.plan.weighing.needs_angles();
        lights.clear();
        lights.resize_with(starts.len(), || Light::new(weighed));
        let bounces = self.context.campaign.trace.bounces;
        let wave = Wave { starts, wi: self.arms.wi, lit: self.lit, bounces };
        paths.trace(sample, over, &wave, lights, endings);
        for ((start, &ending), light) in starts.iter().zip(&*endings).zip(&*lights) {
            self.look(sample, start, ending);
            self.end(ending, light);
        }
        starts.clear();
    }

    /// Counts a start that the light does not see.
    pub fn hide(&mut self, sample: &Sample, start: &Place) {
        if self.misses(sample, start) {
            self.leave_out(1);
        } else {
            self.look(sample, start, Ending::Hidden);
            self.end(Ending::Hidden, &Light::new(false));
        }
    }

    /// Notes whether the light sees the facet of `start`, where facets of every slope are started on.
    fn look(&mut self, sample: &Sample, start: &Place, ending: Ending) {
        if !self.context.campaign.trace.visibility || self.context.plan.apertures_only {
            return;
        }
        let heading = self.arms.heading;
        let along = *self.along.get_or_insert_with(|| {
            let along = sample.to_field(heading).truncate();
            // A surface without an alpha is told by its slopes themselves, whatever unit its heights are in.
            if self.context.campaign.alphas()[0].is_some() { along / along.length() } else { along }
        });
        let corners = sample.walker.field().corners(start.facet.x, start.facet.y);
        let slope = corners.slope(start.facet.upper).dot(along);
        self.tally.seen.count(slope, ending != Ending::Hidden);
    }

    /// Whether nothing but apertures counts, and the facet of `start` sends light into none.
    fn misses(&self, sample: &Sample, start: &Place) -> bool {
        if !self.context.plan.apertures_only {
            return false;
        }
        let wo = sample.reflected(self.arms.wi, start);
        if wo.z <= 0.0 {
            return true;
        }
        let (sensor, wo) = (&self.context.sensor, self.arms.in_bins(wo));
        let folded = self.context.plan.folded[self.stop];
        let seen = sensor.sees(wo) || (folded && sensor.sees(self.arms.mirrored(wo)));
        !seen
    }

    /// Counts starts that send light into no aperture: they need no ray.
    fn leave_out(&mut self, starts: u64) {
        self.counted += starts;
        self.tally.outside.add_many(starts, self.units);
        self.rays.skipped += 2 * starts;
    }

    /// Counts what is missing of `starts` as starts that send light into no aperture.
    pub fn leave_out_up_to(&mut self, starts: u64) {
        self.leave_out(starts.saturating_sub(self.counted));
    }

    /// Counts the rays that went ahead of the starts, and those of them that found none.
    pub fn end_primaries(&mut self, rays: u64, lost: u64) {
        self.rays.traced += rays;
        self.tally.lost += lost;
    }

    /// Counts a path.
    pub fn end(&mut self, ending: Ending, light: &Light) {
        self.counted += 1;
        self.rays.count(&ending, self.context.campaign, self.lit);
        match ending {
            Ending::Out { wo, order } => self.arrive(wo, order, light),
            Ending::Hidden => self.tally.hidden.add(self.units),
            Ending::Cut { .. } => self.tally.cut.add(self.units),
            Ending::LeftMap => self.tally.left_map.add(self.units),
            Ending::Lost => self.tally.lost += 1,
        }
    }

    /// A path that leaves: into its order, and into its bins, mirrored ones too where the stop is folded.
    fn arrive(&mut self, wo: DVec3, order: u32, light: &Light) {
        let (context, tally, weights) = (self.context, &mut *self.tally, &mut self.weights);
        context.plan.weighing.weigh(light.angles(), order, weights);
        let out = &mut tally.orders[order as usize - 1];
        out.count += 1;
        out.flux += self.units;
        for (sum, weight) in out.weighted.iter_mut().zip(&weights.order) {
            *sum += to_units(self.flux * weight);
        }
        let share = |weight: &f64| to_units(self.part * weight);
        let mut into_bins = |direction: DVec3| {
            context.sensor.each_bin(direction, |bin| {
                tally.hits[bin] += 1;
                let sums = if order > 1 {
                    &mut tally.multiple[weights.first..]
                } else {
                    tally.single[bin] += self.part_units;
                    &mut tally.first[..]
                };
                for (sums, weight) in sums.iter_mut().zip(&weights.bins) {
                    sums[bin] += share(weight);
                }
            });
        };
        let wo = self.arms.in_bins(wo);
        into_bins(wo);
        if context.plan.folded[self.stop] {
            into_bins(self.arms.mirrored(wo));
        }
    }
}

impl Drop for Block<'_> {
    /// Adds the block's rays to the run's.
    fn drop(&mut self) {
        self.context.add_rays(self.rays.traced, self.rays.skipped);
    }
}

/// Counts rays for the cost report.
#[derive(Default)]
struct Rays {
    traced: u64,
    skipped: u64,
}

impl Rays {
    fn count(&mut self, ending: &Ending, campaign: &Campaign, lit: bool) {
        let bounces = u64::from(campaign.trace.bounces);
        // The light's ray, which a sweep replaces, and one after each bounce.
        let (light, swept) = if lit { (0, 1) } else { (1, 0) };
        let (traced, skipped) = match *ending {
            Ending::Out { order, .. } => (light + u64::from(order), swept),
            Ending::Cut { down } => (light + bounces - u64::from(down), swept + u64::from(down)),
            Ending::Hidden | Ending::LeftMap | Ending::Lost => (light, swept),
        };
        if campaign.trace.visibility {
            self.traced += traced;
            self.skipped += skipped;
        } else {
            self.skipped += traced + skipped;
        }
    }
}
