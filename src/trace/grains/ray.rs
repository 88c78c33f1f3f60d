//! Rays among grains: from cell to cell of the patch, exact roots of each half-sphere's quadratic.
//!
//! A ray that starts on a grain never meets it again: a sphere is convex, and the grain is left out by its number.

use glam::{DVec2, DVec3};

use super::pits;
use super::point::GrainPoint;
use crate::surface::grains::GrainField;
use crate::trace::ray::surface_point::Outcome;

/// Cells that a ray crosses at most: one in a million million rises so slowly.
const MOST_CELLS: u32 = 1 << 26;

/// What a ray from `from` along `d` (canonical, any length, away from the surface) meets first; `up` is 1 among grains, -1
/// in pits.
///
/// - Of every grain that comes nearer than its radius, t = c/(-b + sqrt(a (1 - p^2))) with a = d.d, b = o.d, c = o.o - 1
///   and p the distance of the ray from the centre, o the start seen from there: no difference of near numbers. A start
///   inside by rounding, in a seam of two grains, meets the second one at once if it goes deeper, else leaves it.
/// - Below height 1 a ray that rises may meet grains up to there; one that sinks meets the plane.
// Tested by `hits_are_those_of_a_search_through_all_grains`, `no_ray_is_lost_in_a_seam`.
pub fn traverse(field: &GrainField, up: f64, from: &GrainPoint, d: DVec3) -> Outcome<GrainPoint> {
    if up < 0.0 {
        return pits::traverse(field, from, d);
    }
    // A level ray goes on until it meets a grain.
    let end = if d.z >= 0.0 { (1.0 - from.z) / d.z } else { from.z / -d.z };
    let own_centre = from.at - from.normal.truncate();
    let (size, inverse_square) = (field.cell_side(), 1.0 / d.length_squared());
    let mut x = CellSteps::new(from.at.x, d.x, size);
    let mut y = CellSteps::new(from.at.y, d.y, size);
    let mut nearest: Option<(f64, DVec2, u32)> = None;
    let mut reach = end;
    for _ in 0..MOST_CELLS {
        let (cell, shift) = field.wrapped(x.cell, y.cell);
        for placed in field.in_cell(cell) {
            let centre = placed.centre + shift;
            let o = (from.at - centre).extend(from.z);
            let b = o.dot(d);
            let nearest_point = o - (b * inverse_square) * d;
            let depth = 1.0 - nearest_point.length_squared();
            if b >= 0.0 || depth <= 0.0 {
                continue;
            }
            let own = from.grain == Some(placed.grain) && centre.distance_squared(own_centre) < 1.0;
            if own {
                continue;
            }
            let c = o.length_squared() - 1.0;
            let t = (c / ((depth / inverse_square).sqrt() - b)).max(0.0);
            if t < reach {
                reach = t;
                nearest = Some((t, centre, placed.grain));
            }
        }
        // What is met beyond this cell, the next one may know better.
        if x.next.min(y.next) >= reach {
            return outcome(field, from, d, nearest, end);
        }
        if x.next < y.next { x.step() } else { y.step() }
    }
    Outcome::Lost
}

fn outcome(
    field: &GrainField,
    from: &GrainPoint,
    d: DVec3,
    nearest: Option<(f64, DVec2, u32)>,
    end: f64,
) -> Outcome<GrainPoint> {
    let Some((t, centre, grain)) = nearest else {
        if d.z >= 0.0 {
            return Outcome::Escaped;
        }
        return Outcome::Hit(GrainPoint::on_plane(field.on_patch(from.at + end * d.truncate())));
    };
    let from_centre = (from.at - centre + t * d.truncate()).extend(from.z + t * d.z);
    // The root's rounding is taken off: the point lies on the sphere, above the plane.
    let normal = from_centre.with_z(from_centre.z.max(0.0)).normalize();
    Outcome::Hit(GrainPoint {
        at: field.on_patch(centre + normal.truncate()),
        z: normal.z,
        normal,
        grain: Some(grain),
    })
}

/// A ray's way along one axis, from cell to cell.
struct CellSteps {
    /// The present cell, on the endless plane.
    cell: i64,
    /// Ray parameter at which it leaves this cell.
    next: f64,
    start: f64,
    inverse: f64,
    size: f64,
    forward: bool,
}

impl CellSteps {
    fn new(start: f64, speed: f64, size: f64) -> Self {
        let cell = (start / size).floor() as i64;
        let mut steps =
            CellSteps { cell, next: 0.0, start, inverse: 1.0 / speed, size, forward: speed >= 0.0 };
        steps.find_next(speed == 0.0);
        steps
    }

    fn find_next(&mut self, never: bool) {
        let edge = self.cell + i64::from(self.forward);
        self.next = if never { f64::INFINITY } else { (edge as f64 * self.size - self.start) * self.inverse };
    }

    fn step(&mut self) {
        self.cell += if self.forward { 1 } else { -1 };
        self.find_next(false);
    }
}
