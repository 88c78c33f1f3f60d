//! Rays in pits: the air is the union of half-balls below the plane. A ray goes on from ball to ball, and meets the surface
//! where it leaves one and is in no other.

use glam::{DVec2, DVec3};

use super::point::GrainPoint;
use crate::surface::grains::{GrainField, PlacedGrain};
use crate::trace::ray::surface_point::Outcome;

/// Balls that a ray goes through at most.
const MOST_BALLS: u32 = 1 << 20;

/// As `ray::traverse`, on pits. A ray from above begins at height 0.
// Tested by `rays_in_pits_end_on_their_walls`.
pub(super) fn traverse(field: &GrainField, from: &GrainPoint, d: DVec3) -> Outcome<GrainPoint> {
    let (mut at, mut z) = (from.at, from.z);
    // A ray from the plane rises for good; one from above goes down into whatever pit is there.
    let ball = match from.grain {
        Some(grain) => Some((from.at + from.normal.truncate(), grain)),
        None if d.z > 0.0 => return Outcome::Escaped,
        None => other_ball(field, at, z, None),
    };
    let Some(mut inside) = ball else { return Outcome::Hit(GrainPoint::on_plane(at)) };
    for _ in 0..MOST_BALLS {
        let (centre, grain) = inside;
        let o = (at - centre).extend(z);
        let (a, b, c) = (d.length_squared(), o.dot(d), (o.length_squared() - 1.0).min(0.0));
        // The far root; both terms have one sign.
        let root = (b * b - a * c).sqrt();
        let t = if b < 0.0 { (root - b) / a } else { -c / (b + root) };
        if d.z > 0.0 && z + t * d.z >= 0.0 {
            return Outcome::Escaped;
        }
        let on_wall = (o + t * d).normalize();
        let (place, height) = (field.on_patch(centre + on_wall.truncate()), on_wall.z.min(0.0));
        // In a seam, where numbers do not move on, the wall is reached.
        let moved = place != at || height != z;
        match other_ball(field, place, height, Some(grain)) {
            Some(next) if moved => (at, z, inside) = (place, height, next),
            _ => {
                let normal = -on_wall.with_z(height);
                return Outcome::Hit(GrainPoint { at: place, z: height, normal, grain: Some(grain) });
            }
        }
    }
    Outcome::Lost
}

/// A ball other than `own` that holds a point: where its copy lies, and its number.
fn other_ball(field: &GrainField, at: DVec2, z: f64, own: Option<u32>) -> Option<(DVec2, u32)> {
    let holds =
        |placed: &&PlacedGrain| Some(placed.grain) != own && at.distance_squared(placed.centre) + z * z < 1.0;
    field.near(at).iter().find(holds).map(|placed| (placed.centre, placed.grain))
}
