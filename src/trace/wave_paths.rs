//! Paths in waves: the meaning of `Sample::trace` for many starts at once, order by order.

use glam::DVec3;

use super::lane_kernel::Fate;
use super::path::{Bounce, Ending, Sample};
use super::walk::{Outcome, Place};
use super::waves::{LaneWalker, Waves};

/// A path under way: which one, where it is, and a direction.
#[derive(Debug, Clone, Copy)]
struct Step {
    path: usize,
    place: Place,
    direction: DVec3,
}

/// What a wave of paths has in common.
#[derive(Debug, Clone, Copy)]
pub struct Wave<'a> {
    /// Where each path starts.
    pub starts: &'a [Place],
    /// To the light, sample's frame.
    pub wi: DVec3,
    /// Whether it is known that the light sees every start.
    pub lit: bool,
    /// Highest order.
    pub bounces: u32,
}

/// Memory for waves of paths, to be used again.
#[derive(Debug, Default)]
pub struct PathWaves {
    waves: Waves,
    /// At a facet, with the direction back to where the light comes from.
    now: Vec<Step>,
    /// On the way from a facet.
    rays: Vec<Step>,
}

impl PathWaves {
    /// Follows a path from each start of `wave`; `endings` gets their ends in the order of the starts, `visits[k]` the
    /// bounces of path k in theirs.
    ///
    /// `over` is a lane walker over the field of `sample`. Directions are f64; only the question of what a ray meets
    /// is f32's.
    ///
    /// Held by: `tests/lanes.rs` against `Sample::trace`.
    pub fn trace<B: Bounce>(
        &mut self,
        sample: &Sample,
        over: &LaneWalker,
        wave: &Wave,
        visits: &mut [B],
        endings: &mut Vec<Ending>,
    ) {
        let bounces = wave.bounces;
        endings.clear();
        endings.resize(wave.starts.len(), Ending::Hidden);
        self.light(sample, over, wave, endings);
        for order in 1..=bounces {
            let last = order == bounces;
            self.reflect(sample, last, visits, endings);
            if last {
                self.leave(sample, over, order, endings);
            } else {
                self.go_on(sample, over, order, endings);
            }
        }
    }

    /// Keeps the starts that the light sees.
    fn light(&mut self, sample: &Sample, over: &LaneWalker, wave: &Wave, endings: &mut [Ending]) {
        let Wave { starts, wi, lit, .. } = *wave;
        self.now.clear();
        if lit {
            let steps = starts.iter().enumerate();
            self.now.extend(steps.map(|(path, &place)| Step { path, place, direction: wi }));
            return;
        }
        let light = sample.to_field(wi);
        let fates = self.waves.any_hit(over, starts.len(), |k| (&starts[k], light));
        for (path, (fate, &place)) in fates.iter().zip(starts).enumerate() {
            match fate {
                Fate::Escaped => self.now.push(Step { path, place, direction: wi }),
                Fate::Blocked => {}
                Fate::Beyond => endings[path] = Ending::Lost,
            }
        }
    }

    /// From every facet along its mirror direction.
    fn reflect<B: Bounce>(&mut self, sample: &Sample, last: bool, visits: &mut [B], endings: &mut [Ending]) {
        self.rays.clear();
        for &Step { path, place, direction } in &self.now {
            let wo = sample.reflected(direction, &place);
            visits[path].bounce(direction, wo);
            // A path that goes down must hit again: at the last order there is nothing left to find out.
            if last && wo.z <= 0.0 {
                endings[path] = Ending::Cut { down: true };
            } else {
                self.rays.push(Step { path, place, direction: wo });
            }
        }
    }

    /// The last order: only whether anything stops the rays.
    fn leave(&mut self, sample: &Sample, over: &LaneWalker, order: u32, endings: &mut [Ending]) {
        let rays = &self.rays;
        let ray = |k: usize| (&rays[k].place, sample.to_field(rays[k].direction));
        let fates = self.waves.any_hit(over, rays.len(), ray);
        for (step, fate) in rays.iter().zip(fates) {
            endings[step.path] = match fate {
                Fate::Escaped => Ending::Out { wo: step.direction, order },
                Fate::Blocked => Ending::Cut { down: false },
                Fate::Beyond => Ending::Lost,
            };
        }
    }

    /// An order with more to come: what the rays meet.
    fn go_on(&mut self, sample: &Sample, over: &LaneWalker, order: u32, endings: &mut [Ending]) {
        let (rays, now) = (&self.rays, &mut self.now);
        now.clear();
        let ray = |k: usize| (&rays[k].place, sample.to_field(rays[k].direction));
        self.waves.closest_hit(over, rays.len(), ray, |k, outcome| {
            let Step { path, direction, .. } = rays[k];
            match outcome {
                Outcome::Hit(place) => now.push(Step { path, place, direction: -direction }),
                Outcome::Escaped => endings[path] = Ending::Out { wo: direction, order },
                Outcome::LeftMap => endings[path] = Ending::LeftMap,
                Outcome::Lost => endings[path] = Ending::Lost,
            }
        });
    }
}
