//! Normals of the upper half of a sphere: the canonical normals of GGX, and those of a grain.

use std::f64::consts::TAU;

use glam::DVec3;

/// A normal of the half-sphere in proportion to what it shows to `s` (unit vector, above or below the horizon), from two
/// numbers of [0, 1): a uniform point of the part of the disc across `s` that the half-sphere covers.
///
/// Source: Heitz 2018, "Sampling the GGX distribution of visible normals"; its warp holds below the horizon as well.
// Tested by `visible_normals_are_drawn_in_proportion_to_their_turned_area`.
pub fn visible_normal(s: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    let (t1, t2) = across(s);
    let (radius, turn) = (u.sqrt(), TAU * v);
    let (sin, cos) = turn.sin_cos();
    let (x, y) = (radius * cos, radius * sin);
    let half = 0.5 * (1.0 + s.z);
    let y = (1.0 - half) * (1.0 - x * x).sqrt() + half * y;
    // Rounding may put a point of the rim outside by 1e-16.
    let height = (1.0 - x * x - y * y).max(0.0).sqrt();
    x * t1 + y * t2 + height * s
}

/// Two unit vectors across `s`: a level one, and the one that points up.
fn across(s: DVec3) -> (DVec3, DVec3) {
    let horizontal = s.truncate().length();
    let level = if horizontal > 0.0 { DVec3::new(-s.y, s.x, 0.0) / horizontal } else { DVec3::X };
    (level, s.cross(level))
}
