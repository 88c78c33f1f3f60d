//! Many rays at once: the question of what they meet goes to the lanes, geometry stays in f64.
//!
//! Input: rays by index. Output: hits in the same order. A ray that is too long for f32 is followed
//! in further segments, each of which begins where f64 says; what is then still under way is traversed in f64.

use glam::DVec3;

use super::batch::RayBatch;
use super::hit_buffer::{HitBuffer, LONGEST, LaneHit, RayOutcome};
use super::max_pyramid::MaxPyramid;
use crate::lanes::Kernel;
use crate::surface::heightfield::Corners;
use crate::trace::ray::grid_traversal::GridTraversal;
use crate::trace::ray::surface_point::{Facet, Outcome, SurfacePoint};
use crate::trace::ray::tile_traversal;

/// A field that both the lanes and the f64 traversal know.
#[derive(Debug, Clone, Copy)]
pub struct SimdTraversal<'a> {
    traversal: GridTraversal<'a>,
    lanes: &'a MaxPyramid,
    kernel: Kernel,
}

impl<'a> SimdTraversal<'a> {
    /// Rays over one field: `lanes` is made of the field of `traversal`.
    pub fn new(traversal: GridTraversal<'a>, lanes: &'a MaxPyramid, kernel: Kernel) -> Self {
        SimdTraversal { traversal, lanes, kernel }
    }

    /// The f64 traversal.
    pub fn traversal(&self) -> &GridTraversal<'a> {
        &self.traversal
    }

    /// The f64 traversal of a ray that is too long for the lanes: the answer of `GridTraversal::traverse`, sooner.
    // Tested by `tests/it/trace/long_rays.rs`.
    pub fn traverse_long(&self, start: &SurfacePoint, d: DVec3) -> Outcome {
        tile_traversal::traverse(&self.traversal.over, self.lanes, start, d)
    }

    /// Whether a ray crosses more than one segment's edges before it is above everything.
    fn is_long(&self, start: &SurfacePoint, d: DVec3) -> bool {
        self.traversal.over.clear_at(start.z, d.z) * (d.x.abs() + d.y.abs()) > f64::from(LONGEST)
    }

    /// The point of a ray after about so many `edges`, over the facet there.
    fn further(&self, start: &SurfacePoint, d: DVec3, edges: f64) -> SurfacePoint {
        let t = edges / (d.x.abs() + d.y.abs());
        let field = self.traversal.field();
        let moved = |cell: usize, place: f64, d: f64, cells: usize| {
            let to = place + t * d;
            ((cell as i64 + to.floor() as i64).rem_euclid(cells as i64) as usize, to - to.floor())
        };
        let (x, u) = moved(start.facet.x, start.u, d.x, field.cells_x());
        let (y, v) = moved(start.facet.y, start.v, d.y, field.cells_y());
        let facet = Facet { x, y, upper: u + v > 1.0 };
        let slope = self.corners(&facet).slope(facet.upper);
        SurfacePoint { facet, u, v, z: start.z + t * d.z, slope }
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
    fn place(&self, start: &SurfacePoint, d: DVec3, hit: &LaneHit) -> SurfacePoint {
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
        SurfacePoint { facet, u, v, z: base + slope.x * u + slope.y * v, slope }
    }
}

/// Edges from the start of a segment to that of the next, which begins where the last one has seen that nothing is near.
const SEGMENT: f64 = LONGEST as f64 - 16.0;
/// Segments of a ray after its first, 2.6e5 edges: those of light from 89.7 degrees that crosses the whole height of a GGX
/// patch of 1024 x 1024 cells, alpha 1.
const FURTHER_SEGMENTS: u32 = 64;

/// Memory for batches of rays, to be used again.
#[derive(Debug, Default)]
pub struct Waves {
    rays: RayBatch,
    hits: HitBuffer,
    /// Rays that are under way, and what became of their last segment.
    under_way: Vec<usize>,
    segment: HitBuffer,
}

impl Waves {
    /// Whether each of `count` rays is blocked, in order; `Beyond` is left for rays that even the f64 traversal loses.
    // Tested by `tests/it/trace/lanes.rs`.
    pub fn any_hit<'p>(
        &mut self,
        over: &SimdTraversal,
        count: usize,
        ray: impl Fn(usize) -> (&'p SurfacePoint, DVec3),
    ) -> &[RayOutcome] {
        self.load(count, &ray);
        over.kernel.any_hit(over.lanes, &self.rays, &mut self.hits);
        self.follow_further(over, &ray);
        &self.hits.outcomes
    }

    /// Follows the rays that are too long for one segment.
    fn follow_further<'p>(
        &mut self,
        over: &SimdTraversal,
        ray: &impl Fn(usize) -> (&'p SurfacePoint, DVec3),
    ) {
        let Waves { rays, hits: HitBuffer { outcomes, .. }, under_way, segment } = self;
        let too_long = |&(index, outcome): &(usize, &RayOutcome)| {
            *outcome == RayOutcome::Beyond && {
                let (start, d) = ray(index);
                over.is_long(start, d)
            }
        };
        under_way.clear();
        under_way.extend(outcomes.iter().enumerate().filter(too_long).map(|(index, _)| index));
        for number in 1..=FURTHER_SEGMENTS {
            if under_way.is_empty() {
                break;
            }
            rays.clear();
            for &index in &*under_way {
                let (start, d) = ray(index);
                rays.push(&over.further(start, d, f64::from(number) * SEGMENT), d);
            }
            over.kernel.any_hit(over.lanes, rays, segment);
            for (&index, &outcome) in under_way.iter().zip(&segment.outcomes) {
                outcomes[index] = outcome;
            }
            under_way.retain(|&index| outcomes[index] == RayOutcome::Beyond);
        }
        for (index, outcome) in
            outcomes.iter_mut().enumerate().filter(|(_, outcome)| **outcome == RayOutcome::Beyond)
        {
            let (start, d) = ray(index);
            *outcome = match over.traverse_long(start, d) {
                Outcome::Escaped => RayOutcome::Escaped,
                Outcome::Hit(_) => RayOutcome::Blocked,
                Outcome::LeftDomain | Outcome::Lost => RayOutcome::Beyond,
            };
        }
    }

    /// What each of `count` rays meets first: calls `visit` with index and outcome, in order.
    // Tested by `tests/it/trace/lanes.rs`.
    pub fn closest_hit<'p>(
        &mut self,
        over: &SimdTraversal,
        count: usize,
        ray: impl Fn(usize) -> (&'p SurfacePoint, DVec3),
        mut visit: impl FnMut(usize, Outcome),
    ) {
        self.find_hits(over, count, &ray);
        for index in 0..count {
            visit(index, self.met(over, index, || ray(index)));
        }
    }

    /// Finds what each of `count` rays meets first, for `met`.
    pub(crate) fn find_hits<'p>(
        &mut self,
        over: &SimdTraversal,
        count: usize,
        ray: impl Fn(usize) -> (&'p SurfacePoint, DVec3),
    ) {
        self.load(count, &ray);
        over.kernel.closest_hit(over.lanes, &self.rays, &mut self.hits);
    }

    /// What `ray`, number `index` of those that hits were found for, meets.
    pub(crate) fn met<'p>(
        &self,
        over: &SimdTraversal,
        index: usize,
        ray: impl FnOnce() -> (&'p SurfacePoint, DVec3),
    ) -> Outcome {
        match self.hits.outcomes[index] {
            RayOutcome::Escaped => Outcome::Escaped,
            RayOutcome::Blocked => {
                let (start, d) = ray();
                Outcome::Hit(over.place(start, d, &self.hits.hits[index]))
            }
            RayOutcome::Beyond => {
                let (start, d) = ray();
                over.traverse_long(start, d)
            }
        }
    }

    fn load<'p>(&mut self, count: usize, ray: &impl Fn(usize) -> (&'p SurfacePoint, DVec3)) {
        self.rays.clear();
        for index in 0..count {
            let (start, d) = ray(index);
            self.rays.push(start, d);
        }
    }
}
