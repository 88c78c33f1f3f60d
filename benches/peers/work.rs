//! The workloads of a scene: batches of rays through the lanes, and the same rays through the f64 walk.

use glam::DVec3;
use gonio::surface::heightfield::Corners;
use gonio::trace::{GridTraversal, Outcome, RayOutcome, SimdTraversal, SurfacePoint, Waves};

use super::scene::{Workload, start_of};

/// Rays in a batch.
const BATCH: usize = 4096;
/// Mirrors that a path meets at most.
const MOST_BOUNCES: usize = 10;
/// Bins of the arrivals' histogram: cosine, azimuth.
const BINS: (usize, usize) = (32, 128);

/// What a workload found.
#[derive(Debug, Clone, Default)]
pub struct Tracing {
    /// Rays traced.
    pub rays: u64,
    /// Samples that escape.
    pub escaped: u64,
    /// For each sample of w0 and w1, whether it is blocked.
    blocked: Vec<bool>,
    /// Arrivals of w2 and w3.
    bins: Vec<u32>,
}

impl Tracing {
    /// Rays answered otherwise, or arrivals elsewhere.
    pub fn differences(&self, other: &Tracing) -> u64 {
        let rays = self.blocked.iter().zip(&other.blocked).filter(|(a, b)| a != b).count() as u64;
        rays + self.bins.iter().zip(&other.bins).map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>()
    }

    fn of(work: Workload, samples: usize) -> Self {
        let flags = matches!(work, Workload::Mask | Workload::Shadow);
        Tracing {
            blocked: Vec::with_capacity(if flags { samples } else { 0 }),
            bins: vec![0; if flags { 0 } else { BINS.0 * BINS.1 }],
            ..Tracing::default()
        }
    }

    /// A path that leaves along `d`.
    fn arrive(&mut self, d: DVec3) {
        self.escaped += 1;
        let row = (d.z.max(0.0) * BINS.0 as f64) as usize;
        // Monotone in the azimuth, in [0, 4).
        let across = d.x / (d.x.abs() + d.y.abs() + 1e-20);
        let turn = if d.y >= 0.0 { 1.0 - across } else { 3.0 + across };
        let column = (turn * 0.25 * BINS.1 as f64) as usize;
        self.bins[row.min(BINS.0 - 1) * BINS.1 + column.min(BINS.1 - 1)] += 1;
    }
}

/// A path under way.
type Ray = (SurfacePoint, DVec3);

/// Traces a workload in the lanes.
pub fn trace(work: Workload, over: &SimdTraversal, rays: &[[f32; 6]]) -> Tracing {
    let mut found = Tracing::of(work, rays.len());
    let mut waves = Waves::default();
    let mut now: Vec<Ray> = Vec::new();
    let mut next: Vec<Ray> = Vec::new();
    let field = over.traversal().field();
    for batch in rays.chunks(BATCH) {
        now.clear();
        now.extend(batch.iter().map(|ray| start_of(field, ray)));
        if matches!(work, Workload::Mask | Workload::Shadow) {
            let fates = waves.any_hit(over, now.len(), |k| (&now[k].0, now[k].1));
            found.blocked.extend(fates.iter().map(|&fate| fate == RayOutcome::Blocked));
            found.rays += now.len() as u64;
            continue;
        }
        let bounces = if work == Workload::Full { 1 } else { MOST_BOUNCES };
        for bounce in 0..=bounces {
            found.rays += now.len() as u64;
            if work == Workload::Full && bounce == 1 {
                let fates = waves.any_hit(over, now.len(), |k| (&now[k].0, now[k].1));
                let left = now.iter().zip(fates).filter(|(_, fate)| **fate == RayOutcome::Escaped);
                left.for_each(|((_, d), _)| found.arrive(*d));
                break;
            }
            next.clear();
            waves.closest_hit(
                over,
                now.len(),
                |k| (&now[k].0, now[k].1),
                |k, outcome| match outcome {
                    Outcome::Hit(place) => {
                        next.push((place, mirrored(&over.corners(&place.facet), &place, now[k].1)));
                    }
                    _ if bounce > 0 => found.arrive(now[k].1),
                    _ => {}
                },
            );
            std::mem::swap(&mut now, &mut next);
        }
    }
    found.escaped += found.blocked.iter().filter(|&&blocked| !blocked).count() as u64;
    found
}

/// Traces a workload ray by ray in f64.
pub fn trace_by_walk(work: Workload, traversal: &GridTraversal, rays: &[[f32; 6]]) -> Tracing {
    let mut found = Tracing::of(work, rays.len());
    let field = traversal.field();
    for ray in rays {
        let (mut place, mut d) = start_of(field, ray);
        if matches!(work, Workload::Mask | Workload::Shadow) {
            found.blocked.push(matches!(traversal.traverse(&place, d), Outcome::Hit(_)));
            continue;
        }
        let bounces = if work == Workload::Full { 1 } else { MOST_BOUNCES };
        for bounce in 0..=bounces {
            match traversal.traverse(&place, d) {
                Outcome::Hit(hit) => {
                    (place, d) = (hit, mirrored(&field.corners(hit.facet.x, hit.facet.y), &hit, d))
                }
                _ if bounce > 0 => {
                    found.arrive(d);
                    break;
                }
                _ => break,
            }
        }
    }
    found
}

/// The direction of a ray along `d` after its bounce.
#[inline]
fn mirrored(corners: &Corners, place: &SurfacePoint, d: DVec3) -> DVec3 {
    let slope = if place.facet.upper { corners.upper_slope() } else { corners.lower_slope() };
    let normal = DVec3::new(-slope.x, -slope.y, 1.0);
    d - (2.0 * d.dot(normal) / normal.length_squared()) * normal
}
