//! Promise: rays among grains meet what a search through all of them finds, none is lost, and paths start where grains show
//! themselves to the light.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use gonio::rng::{Purpose, StreamId, stream, uniform};
use gonio::surface::grains::{GrainField, PlacedGrain, usual_side};
use gonio::trace::grains::ray::traverse;
use gonio::trace::{GrainPoint, GrainSampler, Outcome};
use rand_pcg::Pcg64Dxsm;

fn draws(realisation: u64) -> Pcg64Dxsm {
    stream(StreamId { seed: 11, purpose: Purpose::Test, realisation, incidence: 0, block: 0 })
}

fn patch(coverage: f64, realisation: u64) -> GrainField {
    GrainField::random(usual_side(coverage), coverage, false, &mut draws(realisation))
}

/// A direction on the upper half of the sphere, evenly.
fn upwards(rng: &mut Pcg64Dxsm) -> DVec3 {
    let (z, turn) = (uniform(rng), 2.0 * PI * uniform(rng));
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * turn.cos(), across * turn.sin(), z)
}

/// A point that no grain buries.
fn start(field: &GrainField, rng: &mut Pcg64Dxsm) -> GrainPoint {
    loop {
        let grain = (uniform(rng) * field.centres().len() as f64) as u32;
        let point = GrainPoint::on_grain(field, grain, upwards(rng));
        if !point.is_buried(field) {
            return point;
        }
    }
}

/// The nearest grain along a ray by the quadratic of every copy within three patches; `None`: none above the plane.
fn searched(field: &GrainField, from: &GrainPoint, d: DVec3) -> Option<(f64, u32)> {
    let own = from.at - from.normal.truncate();
    let mut nearest: Option<(f64, u32)> = None;
    for (grain, centre) in field.centres().iter().enumerate() {
        for copy in 0..49 {
            let shift = DVec2::new(f64::from(copy % 7 - 3), f64::from(copy / 7 - 3)) * field.side();
            let o = (from.at - *centre - shift).extend(from.z);
            let is_own = from.grain == Some(grain as u32) && (*centre + shift).distance(own) < 0.5;
            let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - 1.0);
            let root = b * b - a * c;
            if is_own || root <= 0.0 || b >= 0.0 {
                continue;
            }
            let t = (-b - root.sqrt()) / a;
            if from.z + t * d.z >= 0.0 && nearest.is_none_or(|(known, _)| t < known) {
                nearest = Some((t, grain as u32));
            }
        }
    }
    nearest
}

#[test]
fn hits_are_those_of_a_search_through_all_grains() {
    let mut rng = draws(100);
    let (mut hits, mut escapes, mut planes) = (0, 0, 0);
    for coverage in [0.05, 0.5, 0.99] {
        let field = patch(coverage, 1);
        for _ in 0..400 {
            let from = start(&field, &mut rng);
            let up = upwards(&mut rng);
            let d = if uniform(&mut rng) < 0.3 { DVec3::new(up.x, up.y, -up.z) } else { up };
            // A ray leaves its own grain.
            if from.normal.dot(d) <= 0.0 {
                continue;
            }
            match (traverse(&field, field.up(), &from, d), searched(&field, &from, d)) {
                (Outcome::Hit(GrainPoint { grain: Some(found), .. }), Some((t, wanted))) => {
                    assert_eq!(found, wanted, "{from:?} {d} after {t}");
                    hits += 1;
                }
                (Outcome::Hit(GrainPoint { grain: None, at, .. }), None) => {
                    assert!(d.z < 0.0 && field.height(at) == 0.0, "{from:?} {d}");
                    planes += 1;
                }
                (Outcome::Escaped, None) => escapes += 1,
                (found, wanted) => panic!("{from:?} {d}: {found:?}, searched {wanted:?}"),
            }
        }
    }
    assert!(hits > 50 && escapes > 50 && planes > 20, "{hits} {escapes} {planes}");
}

/// A point of a seam of two grains: on both spheres, as far as numbers can say.
fn in_a_seam(field: &GrainField, rng: &mut Pcg64Dxsm) -> Option<GrainPoint> {
    let grain = (uniform(rng) * field.centres().len() as f64) as usize;
    let centre = field.centres()[grain];
    let near = field.near(centre).iter().find(|near| near.grain as usize != grain)?;
    let half = 0.5 * (near.centre - centre);
    if half.length() >= 1.0 {
        return None;
    }
    // The circle that both spheres have, at a random turn of its upper half.
    let (radius, turn) = ((1.0 - half.length_squared()).sqrt(), PI * uniform(rng));
    let across = half.perp().normalize() * (radius * turn.cos());
    let normal = (half + across).extend(radius * turn.sin()).normalize();
    Some(GrainPoint::on_grain(field, grain as u32, normal))
}

/// A million paths that begin in seams, order after order until they leave.
#[test]
fn no_ray_is_lost_in_a_seam() {
    let paths = 500_000u32;
    let mut rng = draws(101);
    for coverage in [0.5, 0.99] {
        let field = patch(coverage, 2);
        let (mut followed, mut bounces) = (0, 0u64);
        while followed < paths {
            let Some(mut at) = in_a_seam(&field, &mut rng) else { continue };
            followed += 1;
            let mut d = -upwards(&mut rng);
            for order in 0.. {
                let n = at.normal;
                d -= 2.0 * d.dot(n).min(0.0) * n;
                if d.dot(n) <= 0.0 && order == 0 {
                    break;
                }
                bounces += 1;
                match traverse(&field, field.up(), &at, d) {
                    Outcome::Escaped => break,
                    Outcome::Hit(next) => {
                        assert!(next.z >= 0.0 && next.normal.is_normalized(), "{next:?}");
                        at = next;
                    }
                    lost => panic!("{coverage}: {at:?} {d}: {lost:?}"),
                }
                assert!(order < 10_000, "{coverage}: {at:?} {d} goes on for ever");
            }
        }
        assert!(bounces > u64::from(paths), "{bounces}");
    }
}

/// Whether a point of the canonical frame is air over pits: above the plane, or in the ball of a pit.
fn is_air(field: &GrainField, at: DVec2, z: f64, slack: f64) -> bool {
    let holds = |grain: &PlacedGrain| at.distance_squared(grain.centre) + z * z < 1.0 + slack;
    z >= -slack || field.near(at).iter().any(holds)
}

/// All the way is air, and the end is wall: on a ball, in no other.
#[test]
fn rays_in_pits_end_on_their_walls() {
    let mut rng = draws(103);
    let (mut hits, mut escapes) = (0, 0);
    for coverage in [0.3, 0.9, 0.99] {
        let field = GrainField::random(usual_side(coverage), coverage, true, &mut draws(5));
        for _ in 0..2000 {
            let grain = (uniform(&mut rng) * field.centres().len() as f64) as u32;
            let from = GrainPoint::on_grain(&field, grain, upwards(&mut rng));
            let d = upwards(&mut rng);
            let d = if uniform(&mut rng) < 0.4 { d.with_z(-d.z) } else { d };
            if from.is_buried(&field) || from.normal.dot(d) <= 0.0 {
                continue;
            }
            // How far the ray goes: to its end, or up to the plane.
            let (end, reach) = match traverse(&field, field.up(), &from, d) {
                Outcome::Escaped => (None, -from.z / d.z),
                Outcome::Hit(end) => {
                    let apart = end.at - from.at;
                    let apart = apart - field.side() * (apart / field.side()).round();
                    (Some(end), apart.extend(end.z - from.z).length() / d.length())
                }
                other => panic!("{from:?} {d}: {other:?}"),
            };
            for k in 1..50 {
                let t = reach * f64::from(k) / 50.0;
                let at = field.on_patch(from.at + t * d.truncate());
                // Places round at the size of the patch, 60 radii.
                assert!(is_air(&field, at, from.z + t * d.z, 1e-12), "{from:?} {d}: wall at {t} of {reach}");
            }
            match end {
                None => escapes += 1,
                Some(end) => {
                    assert!(!end.is_buried(&field) && end.z <= 0.0 && end.normal.z >= 0.0, "{end:?}");
                    assert!(end.normal.dot(d) < 1e-9, "{end:?} is met from behind along {d}");
                    hits += 1;
                }
            }
        }
    }
    assert!(hits > 500 && escapes > 500, "{hits} {escapes}");
}

#[test]
fn samples_lie_on_grains_in_proportion_to_what_they_show() {
    let field = patch(0.5, 3);
    let light = DVec3::new(0.8, -0.3, 0.6);
    let sampler = GrainSampler::new(&field, light);
    let count = 100_000;
    let (mut on_plane, mut cosines, mut by_grain) = (0u64, 0.0, vec![0u32; field.centres().len()]);
    sampler.each(count, &mut draws(102), |point| match point.grain {
        None => on_plane += 1,
        Some(grain) => {
            by_grain[grain as usize] += 1;
            cosines += point.normal.dot(light.normalize());
        }
    });
    let grain = 0.5 * PI * (light.length() + light.z);
    let plane = field.side().powi(2) * light.z;
    let total = plane + grain * field.centres().len() as f64;
    // Equal steps: one more or less.
    assert!((on_plane as f64 - count as f64 * plane / total).abs() <= 1.0, "{on_plane}");
    let each = count as f64 * grain / total;
    assert!(by_grain.iter().all(|&n| (f64::from(n) - each).abs() <= 1.0), "{each}");
    // An even sequence of 1e5 points, and the midpoint rule: both far better than 1e-3.
    let mean = cosines / by_grain.iter().map(|&n| f64::from(n)).sum::<f64>();
    let expected = mean_cosine(light.normalize());
    assert!((mean - expected).abs() < 1e-3, "{mean} {expected}");
    assert!((sampler.flux_fraction(count) * count as f64 - total / plane).abs() < 1e-12 * total / plane);
}

/// The mean of s.m over the half-sphere's normals in proportion to s.m, by the midpoint rule.
fn mean_cosine(s: DVec3) -> f64 {
    let (n, m) = (1000, 1000);
    let (mut top, mut bottom) = (0.0, 0.0);
    for i in 0..n {
        let z = (f64::from(i) + 0.5) / f64::from(n);
        for j in 0..m {
            let turn = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(m);
            let across = (1.0 - z * z).sqrt();
            let turned = DVec3::new(across * turn.cos(), across * turn.sin(), z).dot(s).max(0.0);
            top += turned * turned;
            bottom += turned;
        }
    }
    top / bottom
}
