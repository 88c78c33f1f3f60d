//! Paths in waves: the meaning of `TracedPatch::trace` for many surface samples at once, order by order.

use glam::DVec3;

use super::single::{Bounce, PathEnd, TracedPatch, left_domain};
use crate::trace::ray::surface_point::{Outcome, SurfacePoint};
use crate::trace::simd::hit_buffer::RayOutcome;
use crate::trace::simd::traversal::{SimdTraversal, Waves};

/// A path under way: which one, where it is, and a direction.
#[derive(Debug, Clone, Copy)]
struct Step {
    path: usize,
    place: SurfacePoint,
    direction: DVec3,
}

/// A sample under its light: what the paths of one block have in common.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The field as it lies there, the same one for all views of a wave.
    pub sample: TracedPatch<'a>,
    /// To the light, sample's frame.
    pub wi: DVec3,
}

/// Paths that are followed together.
#[derive(Debug, Clone, Copy)]
pub struct Wave<'a> {
    /// Where each path begins.
    pub surface_samples: &'a [SurfacePoint],
    /// Which view each path belongs to.
    pub view_of: &'a [u16],
    /// The views.
    pub views: &'a [View<'a>],
    /// Highest order.
    pub bounces: u32,
}

impl<'a> Wave<'a> {
    fn view(&self, path: usize) -> &View<'a> {
        &self.views[usize::from(self.view_of[path])]
    }

    /// The direction of a step, seen from the field.
    fn ray(&self, step: &Step) -> DVec3 {
        self.view(step.path).sample.to_field(step.direction)
    }
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
    /// Follows a path from each surface sample of `wave`; `endings` gets their ends in the order of the samples,
    /// `visits[k]` the bounces of path k in theirs.
    ///
    /// `over` is a lane traversal over the field of all views. Directions are f64; only the question of what a ray meets
    /// is f32's.
    // Tested by `tests/it/trace/lanes.rs` against `TracedPatch::trace`.
    pub fn trace<B: Bounce>(
        &mut self,
        over: &SimdTraversal,
        wave: &Wave,
        visits: &mut [B],
        endings: &mut Vec<PathEnd>,
    ) {
        let bounces = wave.bounces;
        endings.clear();
        endings.resize(wave.surface_samples.len(), PathEnd::Shadowed);
        self.light(over, wave, endings);
        for order in 1..=bounces {
            let last = order == bounces;
            self.reflect(wave, last, visits, endings);
            if last {
                self.leave(over, wave, order, endings);
            } else {
                self.find_next_facets(over, wave, order, endings);
            }
        }
    }

    /// Keeps the samples that the light sees.
    fn light(&mut self, over: &SimdTraversal, wave: &Wave, endings: &mut [PathEnd]) {
        let at_sample = |(path, &place): (usize, &SurfacePoint)| {
            let direction = wave.view(path).wi;
            Step { path, place, direction }
        };
        let samples = wave.surface_samples.iter().enumerate().map(at_sample);
        self.now.clear();
        let ray = |k: usize| {
            let View { sample, wi } = wave.view(k);
            (&wave.surface_samples[k], sample.to_field(*wi))
        };
        let outcomes = self.waves.any_hit(over, wave.surface_samples.len(), ray);
        for (outcome, step) in outcomes.iter().zip(samples) {
            match outcome {
                RayOutcome::Escaped => self.now.push(step),
                RayOutcome::Blocked => {}
                RayOutcome::Beyond => endings[step.path] = PathEnd::Lost,
            }
        }
    }

    /// From every facet along its mirror direction.
    fn reflect<B: Bounce>(&mut self, wave: &Wave, last: bool, visits: &mut [B], endings: &mut [PathEnd]) {
        self.rays.clear();
        for &Step { path, place, direction } in &self.now {
            let wo = wave.view(path).sample.reflected(direction, &place);
            visits[path].bounce(direction, wo);
            // A path that goes down must hit again: at the last order there is nothing left to find out.
            if last && wo.z <= 0.0 {
                endings[path] = PathEnd::Truncated { down: true };
            } else {
                self.rays.push(Step { path, place, direction: wo });
            }
        }
    }

    /// The last order: only whether anything blocks the rays.
    fn leave(&mut self, over: &SimdTraversal, wave: &Wave, order: u32, endings: &mut [PathEnd]) {
        let rays = &self.rays;
        let ray = |k: usize| (&rays[k].place, wave.ray(&rays[k]));
        let outcomes = self.waves.any_hit(over, rays.len(), ray);
        for (step, outcome) in rays.iter().zip(outcomes) {
            endings[step.path] = match outcome {
                RayOutcome::Escaped => PathEnd::Out { wo: step.direction, order },
                RayOutcome::Blocked => PathEnd::Truncated { down: false },
                RayOutcome::Beyond => PathEnd::Lost,
            };
        }
    }

    /// An order with more to come: what the rays meet.
    fn find_next_facets(&mut self, over: &SimdTraversal, wave: &Wave, order: u32, endings: &mut [PathEnd]) {
        let (rays, now) = (&self.rays, &mut self.now);
        now.clear();
        let ray = |k: usize| (&rays[k].place, wave.ray(&rays[k]));
        self.waves.closest_hit(over, rays.len(), ray, |k, outcome| {
            let Step { path, direction, .. } = rays[k];
            match outcome {
                Outcome::Hit(place) => now.push(Step { path, place, direction: -direction }),
                Outcome::Escaped => endings[path] = PathEnd::Out { wo: direction, order },
                // Lanes hold periodic fields alone; what else there is ends as one path by itself does.
                Outcome::LeftDomain => endings[path] = left_domain(direction, order, order + 1),
                Outcome::Lost => endings[path] = PathEnd::Lost,
            }
        });
    }
}
