//! What light has met within a sphere of clear material before it comes to the eye's side: the smooth far side.
//!
//! The sphere is rough where the eye looks at it (the table) and smooth elsewhere. A ray that has entered at `p` meets the sphere
//! again under the same angle c at every turn: the share (1 - F) of what it sees lies outside, F of it goes on within.

use glam::DVec3;

use super::sky::Sky;
use crate::interchange::Colour;
use crate::optics::facet;

/// Meetings with the smooth side that are followed; what goes on within is left out.
pub const TURNS: usize = 3;

/// L/n^2 of the sky that arrives at `p` of the unit sphere from within, against the direction `w`, which points into the sphere.
/// `eta`: index of the sphere over that around it.
// Tested by `a_clear_sphere_takes_no_light_away`.
pub fn seen_inside(sky: &Sky, p: DVec3, w: DVec3, eta: f64) -> Colour {
    let (mut place, mut along, mut share, mut sum) = (p, w, 1.0, [0.0; 3]);
    for _ in 0..TURNS {
        let cos = -place.dot(along);
        place = (place + 2.0 * cos * along).normalize();
        // Seen from within, its normal points to the middle of the sphere.
        let split = facet::split(-along, -place, 1.0 / eta);
        if let Some(out) = split.refracted {
            let light = sky.radiance(out.normalize());
            (0..3).for_each(|c| sum[c] += share * (1.0 - split.reflectance) * light[c]);
        }
        share *= split.reflectance;
        along = (along - 2.0 * along.dot(place) * place).normalize();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction_deg;

    #[test]
    fn a_clear_sphere_takes_no_light_away() {
        // In an even light of 1: all but what is still within after the turns, F^TURNS.
        let even = Sky::even([1.0; 3]);
        for angle in [0.0, 20.0, 40.0] {
            let p = DVec3::Z;
            let w = direction_deg(180.0 - angle, 0.0);
            let f = facet::split(-w, DVec3::Z, 1.0 / 1.5).reflectance;
            let found = seen_inside(&even, p, w, 1.5);
            // A few roundings of numbers of about 1 at every turn.
            assert!((found[0] - (1.0 - f.powi(TURNS as i32))).abs() < 1e-12, "{angle}: {found:?}");
        }
        // Beyond the critical angle (41.8 degrees) nothing comes in.
        assert_eq!(seen_inside(&even, DVec3::Z, direction_deg(135.0, 0.0), 1.5), [0.0; 3]);
    }

    #[test]
    fn straight_through_the_middle_one_sees_what_is_behind() {
        let step = crate::render::sky::SoftStep {
            axis: [0.0, 0.0, -1.0],
            centre: 0.0,
            width: 0.01,
            colour: [1.0; 3],
        };
        let sky = Sky { base: [0.0; 3], steps: vec![step] };
        // F = ((n - 1)/(n + 1))^2 = 0.04 at normal incidence; what is seen after an even number of turns lies in front.
        let found = seen_inside(&sky, DVec3::Z, -DVec3::Z, 1.5);
        assert!((found[0] - 0.96 * (1.0 + 0.04 * 0.04)).abs() < 1e-12, "{found:?}");
    }
}
