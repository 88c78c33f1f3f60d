//! Many rays at once: the question of what they meet goes to the lanes, geometry stays in f64.
//!
//! Enters: rays by index. Leaves: answers in the same order. A ray that is too long for f32 is walked in f64.

use glam::DVec3;

use super::lane_field::LaneField;
use super::lane_kernel::{Answers, Fate, LaneHit};
use super::lane_rays::LaneRays;
use super::lanes::Kernel;
use super::long_walk;
use super::walk::{Facet, Outcome, Place, Walker};
use crate::surface::heightfield::Corners;

/// A field that both the lanes and the f64 walk know.
#[derive(Debug, Clone, Copy)]
pub struct LaneWalker<'a> {
    walker: Walker<'a>,
    lanes: &'a LaneField,
    kernel: Kernel,
}

impl<'a> LaneWalker<'a> {
    /// Rays over one field: `lanes` is made of the field of `walker`.
    pub fn new(walker: Walker<'a>, lanes: &'a LaneField, kernel: Kernel) -> Self {
        LaneWalker { walker, lanes, kernel }
    }

    /// The f64 walk.
    pub fn walker(&self) -> &Walker<'a> {
        &self.walker
    }

    /// The f64 walk of a ray that is too long for the lanes: the answer of `Walker::walk`, sooner.
    ///
    /// Held by: `tests/long_rays.rs`.
    pub fn walk_long(&self, start: &Place, d: DVec3) -> Outcome {
        long_walk::walk(&self.walker, self.lanes, start, d)
    }

    /// Bytes of the lanes' tables.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.lanes.heights) + size_of_val(&*self.lanes.maxima)
    }

    /// The corner heights of a cell: those of the field, from the lanes' smaller copy.
    #[inline]
    pub fn corners(&self, facet: &Facet) -> Corners {
        self.lanes.corners(facet.x, facet.y)
    }

    /// Where a ray from `start` along `d` meets the facet of `hit`: on the facet's plane, within its stretch.
    #[inline]
    fn place(&self, start: &Place, d: DVec3, hit: &LaneHit) -> Place {
        let (x, y) = self.lanes.cell(start.facet.x, start.facet.y, hit);
        let facet = Facet { x, y, upper: hit.upper };
        let corners = self.lanes.corners(x, y);
        let (u, v) = (start.u - f64::from(hit.cells_x), start.v - f64::from(hit.cells_y));
        let (slope, base) = if hit.upper {
            let slope = corners.upper_slope();
            (slope, corners.h11 - slope.x - slope.y)
        } else {
            (corners.lower_slope(), corners.h00)
        };
        let above = start.z - (base + slope.x * u + slope.y * v);
        let length = d.x.abs() + d.y.abs();
        let t = above / (slope.x * d.x + slope.y * d.y - d.z);
        // The stretch was found in f32, for |dx| + |dy| = 1; the plane is met at one of its ends if not inside.
        let scale = 1.0 / length;
        let (from, to) = (f64::from(hit.from) * scale, f64::from(hit.to) * scale);
        let t = if t > from { t.min(to) } else { from };
        // The ends are known to 2^-23 of the ray's length: a point of the facet's edge may come out beyond it.
        let (u, v) = ((u + t * d.x).clamp(0.0, 1.0), (v + t * d.y).clamp(0.0, 1.0));
        Place { facet, u, v, z: base + slope.x * u + slope.y * v }
    }
}

/// Memory for batches of rays, to be used again.
#[derive(Debug, Default)]
pub struct Waves {
    rays: LaneRays,
    answers: Answers,
}

impl Waves {
    /// Whether each of `count` rays is blocked, in order; `Beyond` is left for rays that even the f64 walk loses.
    ///
    /// Held by: `tests/lanes.rs`.
    pub fn any_hit<'p>(
        &mut self,
        over: &LaneWalker,
        count: usize,
        ray: impl Fn(usize) -> (&'p Place, DVec3),
    ) -> &[Fate] {
        self.load(count, &ray);
        over.lanes.any_hit(over.kernel, &self.rays, &mut self.answers);
        for (index, fate) in self.answers.fates.iter_mut().enumerate() {
            if *fate == Fate::Beyond {
                let (start, d) = ray(index);
                *fate = match over.walk_long(start, d) {
                    Outcome::Escaped => Fate::Escaped,
                    Outcome::Hit(_) => Fate::Blocked,
                    Outcome::LeftMap | Outcome::Lost => Fate::Beyond,
                };
            }
        }
        &self.answers.fates
    }

    /// What each of `count` rays meets first: calls `visit` with index and outcome, in order.
    ///
    /// Held by: `tests/lanes.rs`.
    pub fn closest_hit<'p>(
        &mut self,
        over: &LaneWalker,
        count: usize,
        ray: impl Fn(usize) -> (&'p Place, DVec3),
        mut visit: impl FnMut(usize, Outcome),
    ) {
        self.load(count, &ray);
        over.lanes.closest_hit(over.kernel, &self.rays, &mut self.answers);
        for (index, (fate, hit)) in self.answers.fates.iter().zip(&self.answers.hits).enumerate() {
            let outcome = match fate {
                Fate::Escaped => Outcome::Escaped,
                Fate::Blocked => {
                    let (start, d) = ray(index);
                    Outcome::Hit(over.place(start, d, hit))
                }
                Fate::Beyond => {
                    let (start, d) = ray(index);
                    over.walk_long(start, d)
                }
            };
            visit(index, outcome);
        }
    }

    fn load<'p>(&mut self, count: usize, ray: &impl Fn(usize) -> (&'p Place, DVec3)) {
        self.rays.clear();
        for index in 0..count {
            let (start, d) = ray(index);
            self.rays.push(start, d);
        }
    }
}
