//! One block of starts: followed one by one or in waves through the lanes, and tallied in the order of the starts.

use std::cell::RefCell;

use glam::DVec3;

use super::arms::BlockArms;
use super::optics::Light;
use super::run::Context;
use super::tally::{Tally, to_units};
use crate::campaign::Campaign;
use crate::trace::{Ending, LaneWalker, PathWaves, Place, Sample, Wave};

/// Starts that are followed together: their rays fit the cache of a core.
const WAVE: usize = 4096;

thread_local! {
    static WAVES: RefCell<WaveMemory> = RefCell::default();
}

/// What a thread uses for one wave after another.
#[derive(Default)]
struct WaveMemory {
    starts: Vec<Place>,
    paths: PathWaves,
    lights: Vec<Light>,
    endings: Vec<Ending>,
}

/// What the paths of one block add to.
pub(super) struct Block<'a> {
    pub context: &'a Context<'a>,
    pub arms: BlockArms,
    pub stop: usize,
    pub tally: &'a mut Tally,
    pub rays: Rays,
}

impl Block<'_> {
    /// Follows every start by itself.
    pub fn follow(&mut self, sample: &Sample, flux: f64, each: impl FnOnce(&mut dyn FnMut(Place))) {
        let (trace, wi) = (&self.context.campaign.trace, self.arms.wi);
        each(&mut |start| {
            let mut light = Light::new(self.context.f0);
            let ending = if trace.visibility {
                sample.trace(start, wi, trace.bounces, &mut light)
            } else {
                sample.trace_unobstructed(start, wi, &mut light)
            };
            self.end(ending, light, flux);
        });
    }

    /// Follows the starts in waves, through the lanes; they end in the order in which they start.
    pub fn follow_in_waves(
        &mut self,
        sample: &Sample,
        over: &LaneWalker,
        flux: f64,
        each: impl FnOnce(&mut dyn FnMut(Place)),
    ) {
        WAVES.with_borrow_mut(|memory| {
            each(&mut |start| {
                memory.starts.push(start);
                if memory.starts.len() == WAVE {
                    self.wave(sample, over, flux, memory);
                }
            });
            self.wave(sample, over, flux, memory);
        });
    }

    /// One wave: the starts that `memory` holds.
    fn wave(&mut self, sample: &Sample, over: &LaneWalker, flux: f64, memory: &mut WaveMemory) {
        let WaveMemory { starts, paths, lights, endings } = memory;
        lights.clear();
        lights.resize_with(starts.len(), || Light::new(self.context.f0));
        let bounces = self.context.campaign.trace.bounces;
        paths.trace(sample, over, &Wave { starts, wi: self.arms.wi, bounces }, lights, endings);
        for (&ending, &light) in endings.iter().zip(&*lights) {
            self.end(ending, light, flux);
        }
        starts.clear();
    }

    /// Counts a path that carried `flux`.
    pub fn end(&mut self, ending: Ending, light: Light, flux: f64) {
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
pub(super) struct Rays {
    pub traced: u64,
    pub skipped: u64,
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
