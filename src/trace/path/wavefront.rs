//! Paths in waves: the meaning of `TracedPatch::trace` for many surface samples at once, order by order.

use glam::DVec3;

use super::scatter::{Onward, PathEnd, Scatter, SplitEnd, left_domain, split_rays, upside_down_if};
use super::single::TracedPatch;
use crate::trace::ray::surface_point::{Outcome, SurfacePoint};
use crate::trace::simd::hit_buffer::RayOutcome;
use crate::trace::simd::traversal::{SimdTraversal, Waves};

/// A path under way: which one, where it is, and a direction, in the frame of the side that it is on.
#[derive(Debug, Clone, Copy)]
struct Step {
    path: usize,
    place: SurfacePoint,
    direction: DVec3,
    below: bool,
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
    /// On the way from a facet, above the surface and below it.
    rays: [Vec<Step>; 2],
}

impl PathWaves {
    /// Follows a path from each surface sample of `wave`; `endings` gets their ends in the order of the samples, `facets[k]`
    /// stands for those that path k meets.
    ///
    /// `over` are lane traversals of the field of all views, as it is and upside down. Directions are f64; only the question
    /// of what a ray meets is f32's.
    // Tested by `tests/it/trace/lanes.rs` against `TracedPatch::trace`.
    pub fn trace<B: Scatter>(
        &mut self,
        over: &[SimdTraversal; 2],
        wave: &Wave,
        facets: &mut [B],
        endings: &mut Vec<PathEnd>,
    ) {
        let bounces = wave.bounces;
        endings.clear();
        endings.resize(wave.surface_samples.len(), PathEnd::Shadowed);
        self.light(&over[0], wave, |path| endings[path] = PathEnd::Lost);
        for order in 1..=bounces {
            let last = order == bounces;
            self.scatter(wave, last, facets, endings);
            if last {
                self.leave(over, wave, order, |step, end| endings[step.path] = end);
            } else {
                self.find_next_facets(over, wave, order, endings);
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
        self.light(&over[0], wave, |path| endings[path] = SplitEnd::both(PathEnd::Lost));
        self.rays.iter_mut().for_each(Vec::clear);
        for &Step { path, place, direction, .. } in &self.now {
            let normal = wave.view(path).sample.facet_normal(&place, false);
            let (reflectance, [up, down]) = split_rays(direction, normal, eta);
            let none = PathEnd::Truncated { down: true };
            endings[path] = SplitEnd { reflectance, reflected: none, refracted: none };
            let ray = |place, direction, below| Step { path, place, direction, below };
            self.rays[0].extend(up.map(|w| ray(place, w, false)));
            self.rays[1].extend(down.map(|w| ray(place.upside_down(), w, true)));
        }
        self.leave(over, wave, 1, |step, end| {
            let ending = &mut endings[step.path];
            *(if step.below { &mut ending.refracted } else { &mut ending.reflected }) = end;
        });
    }

    /// Keeps the samples that the light sees.
    fn light(&mut self, over: &SimdTraversal, wave: &Wave, mut lost: impl FnMut(usize)) {
        let at_sample = |(path, &place): (usize, &SurfacePoint)| {
            let direction = wave.view(path).wi;
            Step { path, place, direction, below: false }
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
                RayOutcome::Beyond => lost(step.path),
            }
        }
    }

    /// From every facet onwards.
    fn scatter<B: Scatter>(&mut self, wave: &Wave, last: bool, facets: &mut [B], endings: &mut [PathEnd]) {
        self.rays.iter_mut().for_each(Vec::clear);
        for &Step { path, place, direction, below } in &self.now {
            let normal = wave.view(path).sample.facet_normal(&place, below);
            let Onward { to, through } = facets[path].scatter(direction, normal, below);
            let (wo, below) = (upside_down_if(through, to), below != through);
            // A path that goes down must hit again: at the last order there is nothing left to find out.
            if last && wo.z <= 0.0 {
                endings[path] = PathEnd::Truncated { down: true };
            } else {
                let place = if through { place.upside_down() } else { place };
                self.rays[usize::from(below)].push(Step { path, place, direction: wo, below });
            }
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
        for (rays, over) in self.rays.iter().zip(over) {
            let ray = |k: usize| (&rays[k].place, wave.ray(&rays[k]));
            let outcomes = self.waves.any_hit(over, rays.len(), ray);
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
        endings: &mut [PathEnd],
    ) {
        let (all, now) = (&self.rays, &mut self.now);
        now.clear();
        for (rays, over) in all.iter().zip(over) {
            let ray = |k: usize| (&rays[k].place, wave.ray(&rays[k]));
            self.waves.closest_hit(over, rays.len(), ray, |k, outcome| {
                let Step { path, direction, below, .. } = rays[k];
                let seen = upside_down_if(below, direction);
                match outcome {
                    Outcome::Hit(place) => now.push(Step { path, place, direction: -direction, below }),
                    Outcome::Escaped => endings[path] = PathEnd::Out { wo: seen, order },
                    // Lanes hold periodic fields alone; what else there is ends as one path by itself does.
                    Outcome::LeftDomain => endings[path] = left_domain(direction, seen, order, order + 1),
                    Outcome::Lost => endings[path] = PathEnd::Lost,
                }
            });
        }
    }
}
