//! Paths in waves: the meaning of `TracedPatch::trace` for many surface samples at once, order by order.

use glam::DVec3;

use super::scatter::{Onward, PathEnd, Scatter, SplitEnd, left_domain, split_rays, upside_down_if};
use super::single::TracedPatch;
use crate::trace::ray::surface_point::{Outcome, SurfacePoint};
use crate::trace::simd::hit_buffer::RayOutcome;
use crate::trace::simd::traversal::{SimdTraversal, Waves};

/// A path under way: which one, and a direction, in the frame of the side that it is on.
#[derive(Debug, Clone, Copy)]
struct Step {
    path: u32,
    /// Whether it is at its surface sample, else at its place of `PathWaves`.
    at_sample: bool,
    below: bool,
    direction: DVec3,
}

impl Step {
    fn path(&self) -> usize {
        self.path as usize
    }
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

    /// Where a step is and its direction, seen from the field.
    #[inline]
    fn ray<'b>(&'b self, places: &'b [SurfacePoint], step: &Step) -> (&'b SurfacePoint, DVec3) {
        let place = &(if step.at_sample { self.surface_samples } else { places })[step.path()];
        (place, self.view(step.path()).sample.to_field(step.direction))
    }
}

/// Memory for waves of paths, to be used again.
#[derive(Debug, Default)]
pub struct PathWaves {
    waves: Waves,
    /// Where each path is that has left its surface sample, or its upper side, seen from the side that it is on.
    places: Vec<SurfacePoint>,
    /// At a facet, with the direction back to where the light comes from.
    now: Vec<Step>,
    /// On the way from a facet, above the surface and below it.
    rays: [Vec<Step>; 2],
}

impl PathWaves {
    /// Follows a path from each surface sample of `wave`; `facets[k]` stands for the facets that path k meets. Calls `end`
    /// once with each path, its facets and how it ends, those of low orders first.
    ///
    /// `over` are lane traversals of the field of all views, as it is and upside down. Directions are f64; only the question
    /// of what a ray meets is f32's.
    // Tested by `tests/it/trace/lanes.rs` against `TracedPatch::trace`.
    pub fn trace<B: Scatter>(
        &mut self,
        over: &[SimdTraversal; 2],
        wave: &Wave,
        facets: &mut [B],
        mut end: impl FnMut(usize, &B, PathEnd),
    ) {
        let bounces = wave.bounces;
        self.light(&over[0], wave, |path, ending| end(path, &facets[path], ending));
        for order in 1..=bounces {
            let last = order == bounces;
            self.scatter(wave, last, facets, &mut end);
            let mut end = |step: &Step, ending| end(step.path(), &facets[step.path()], ending);
            if last {
                self.leave(over, wave, order, end);
            } else {
                self.find_next_facets(over, wave, order, &mut end);
            }
        }
    }

    /// Both parts of the light of each surface sample at its own facet, a clear one of index `eta`.
    // Tested by `split_light_in_lanes_is_that_of_single_paths` (tests/it/trace/lanes.rs).
    pub fn trace_split(
        &mut self,
        over: &[SimdTraversal; 2],
        wave: &Wave,
        eta: f64,
        endings: &mut Vec<SplitEnd>,
    ) {
        endings.clear();
        endings.resize(wave.surface_samples.len(), SplitEnd::both(PathEnd::Shadowed));
        self.light(&over[0], wave, |path, ending| endings[path] = SplitEnd::both(ending));
        self.rays.iter_mut().for_each(Vec::clear);
        for step in &self.now {
            let (path, place) = (step.path(), &wave.surface_samples[step.path()]);
            let normal = wave.view(path).sample.facet_normal(place);
            let (reflectance, [up, down]) = split_rays(step.direction, normal, eta);
            let none = PathEnd::Truncated { down: true };
            endings[path] = SplitEnd { reflectance, reflected: none, refracted: none };
            self.places[path] = place.upside_down();
            self.rays[0].extend(up.map(|direction| Step { direction, ..*step }));
            self.rays[1].extend(down.map(|direction| Step {
                direction,
                at_sample: false,
                below: true,
                ..*step
            }));
        }
        self.leave(over, wave, 1, |step, end| {
            let ending = &mut endings[step.path()];
            *(if step.below { &mut ending.refracted } else { &mut ending.reflected }) = end;
        });
    }

    /// Keeps the samples that the light sees.
    fn light(&mut self, over: &SimdTraversal, wave: &Wave, mut end: impl FnMut(usize, PathEnd)) {
        self.now.clear();
        if self.places.len() < wave.surface_samples.len() {
            self.places = wave.surface_samples.to_vec();
        }
        let lights: Vec<DVec3> = wave.views.iter().map(|View { sample, wi }| sample.to_field(*wi)).collect();
        let ray = |k: usize| (&wave.surface_samples[k], lights[usize::from(wave.view_of[k])]);
        let outcomes = self.waves.any_hit(over, wave.surface_samples.len(), ray);
        for (path, outcome) in outcomes.iter().enumerate() {
            match outcome {
                RayOutcome::Escaped => {
                    let direction = wave.view(path).wi;
                    self.now.push(Step { path: path as u32, at_sample: true, below: false, direction });
                }
                RayOutcome::Blocked => end(path, PathEnd::Shadowed),
                RayOutcome::Beyond => end(path, PathEnd::Lost),
            }
        }
    }

    /// From every facet onwards.
    fn scatter<B: Scatter>(
        &mut self,
        wave: &Wave,
        last: bool,
        facets: &mut [B],
        mut end: impl FnMut(usize, &B, PathEnd),
    ) {
        let PathWaves { places, now, rays, .. } = self;
        rays.iter_mut().for_each(Vec::clear);
        for step in now {
            let path = step.path();
            let place = if step.at_sample { &wave.surface_samples[path] } else { &places[path] };
            let normal = wave.view(path).sample.facet_normal(place);
            let Onward { to, through } = facets[path].scatter(step.direction, normal, step.below);
            let (direction, below) = (upside_down_if(through, to), step.below != through);
            // A path that goes down must hit again: at the last order there is nothing left to find out.
            if last && direction.z <= 0.0 {
                end(path, &facets[path], PathEnd::Truncated { down: true });
                continue;
            }
            if through {
                places[path] = place.upside_down();
            }
            let at_sample = step.at_sample && !through;
            rays[usize::from(below)].push(Step { path: step.path, at_sample, below, direction });
        }
    }

    /// The last order: only whether anything blocks the rays.
    fn leave(
        &mut self,
        over: &[SimdTraversal; 2],
        wave: &Wave,
        order: u32,
        mut end: impl FnMut(&Step, PathEnd),
    ) {
        let PathWaves { waves, places, rays, .. } = self;
        for (rays, over) in rays.iter().zip(over) {
            let outcomes = waves.any_hit(over, rays.len(), |k| wave.ray(places, &rays[k]));
            for (step, outcome) in rays.iter().zip(outcomes) {
                let ending = match outcome {
                    RayOutcome::Escaped => {
                        PathEnd::Out { wo: upside_down_if(step.below, step.direction), order }
                    }
                    RayOutcome::Blocked => PathEnd::Truncated { down: false },
                    RayOutcome::Beyond => PathEnd::Lost,
                };
                end(step, ending);
            }
        }
    }

    /// An order with more to come: what the rays meet.
    fn find_next_facets(
        &mut self,
        over: &[SimdTraversal; 2],
        wave: &Wave,
        order: u32,
        mut end: impl FnMut(&Step, PathEnd),
    ) {
        let PathWaves { waves, places, now, rays } = self;
        now.clear();
        for (rays, over) in rays.iter().zip(over) {
            waves.find_hits(over, rays.len(), |k| wave.ray(places, &rays[k]));
            for (k, step) in rays.iter().enumerate() {
                let outcome = waves.met(over, k, || wave.ray(places, step));
                let Step { direction, below, .. } = *step;
                let seen = upside_down_if(below, direction);
                match outcome {
                    Outcome::Hit(place) => {
                        places[step.path()] = place;
                        now.push(Step { at_sample: false, direction: -direction, ..*step });
                    }
                    Outcome::Escaped => end(step, PathEnd::Out { wo: seen, order }),
                    // Lanes hold periodic fields alone; what else there is ends as one path by itself does.
                    Outcome::LeftDomain => end(step, left_domain(direction, seen, order, order + 1)),
                    Outcome::Lost => end(step, PathEnd::Lost),
                }
            }
        }
    }
}
