//! Promise: rays in f32 lanes get the hits of the f64 walk, the same bits from every kernel, and none is lost.

use glam::{DVec2, DVec3};
use gonio::rng::uniform;
use gonio::sphere;
use gonio::surface::{Heightfield, SlopeLaw, Synthesiser};
use gonio::trace::{
    Facet, GridTraversal, HitBuffer, Kernel, LONGEST, MaxPyramid, Mirrors, Onward, Outcome, PatchSymmetry,
    PathEnd, PathWaves, RayBatch, RayOutcome, Scatter, SimdTraversal, SurfacePoint, Traced, TracedPatch,
    View, Wave, Waves,
};
use rand_pcg::Pcg64Dxsm;

use crate::support::measuring::{start, test_rng, whole};

type Ray = (SurfacePoint, DVec3);

fn patch(law: SlopeLaw, cells: usize, seed: u64) -> Heightfield {
    Synthesiser::new(law, cells, 8.0).patch(&mut test_rng(seed))
}

/// GGX and Beckmann patches, a rectangle of steps, a plain.
fn fields() -> Vec<Heightfield> {
    let steps = (0..8 * 32).map(|i| f64::from(i * 7919 % 13) / 4.0).collect();
    vec![
        patch(SlopeLaw::Ggx, 128, 1),
        patch(SlopeLaw::Beckmann, 128, 2),
        Heightfield::new(8, 32, true, steps),
        Heightfield::new(8, 8, true, vec![1.0; 64]),
    ]
}

/// Directions of the sphere that leave the start's facet; one in four along an axis or a diagonal.
fn rays(rng: &mut Pcg64Dxsm, field: &Heightfield, alpha: f64, count: usize) -> Vec<Ray> {
    let mut rays = Vec::new();
    while rays.len() < count {
        let place = start(rng, field);
        let theta = if whole(rng, 0, 4) == 0 { 180.0 } else { 89.0 } * uniform(rng);
        let phi = if whole(rng, 0, 4) == 0 { 45.0 * whole(rng, 0, 8) as f64 } else { 360.0 * uniform(rng) };
        let w = sphere::direction_deg(theta, phi);
        let d = DVec3::new(alpha * w.x, alpha * w.y, w.z);
        let corners = field.corners(place.facet.x, place.facet.y);
        let slope = if place.facet.upper { corners.upper_slope() } else { corners.lower_slope() };
        if d.z > d.truncate().dot(slope) {
            rays.push((place, d));
        }
    }
    rays
}

const ALPHAS: [f64; 5] = [1e-4, 0.1, 0.5, 1.0, 2.0];

#[test]
fn every_kernel_gives_the_same_bits() {
    let kernels: Vec<Kernel> = Kernel::ALL.into_iter().filter(|kernel| kernel.available()).collect();
    println!("{kernels:?}");
    let mut rng = test_rng(11);
    let (mut blocked, mut all) = (0, 0);
    for field in fields() {
        let lanes = MaxPyramid::new(&field).expect("lanes serve it");
        for alpha in ALPHAS {
            // Of no vector's width.
            let rays = rays(&mut rng, &field, alpha, 20_011);
            let mut batch = RayBatch::default();
            rays.iter().for_each(|(place, d)| batch.push(place, *d));
            let of = |kernel: Kernel| {
                let (mut any, mut closest) = (HitBuffer::default(), HitBuffer::default());
                kernel.any_hit(&lanes, &batch, &mut any);
                kernel.closest_hit(&lanes, &batch, &mut closest);
                assert_eq!(any.outcomes, closest.outcomes);
                closest
            };
            let expected = of(Kernel::Scalar);
            for &kernel in &kernels {
                // Parameters are finite: equal numbers are equal bits, but for the sign of zero.
                assert!(of(kernel) == expected, "{kernel:?}, alpha {alpha}");
            }
            blocked += expected.outcomes.iter().filter(|&&fate| fate == RayOutcome::Blocked).count();
            all += rays.len();
        }
    }
    assert!(blocked > all / 10 && blocked < all * 9 / 10, "{blocked} of {all}");
}

/// Rays that f32 and f64 answer otherwise: the position of a ray after t edges is known to t 2^-23 cells, its height
/// to about 2^-22 of the heights' range (100): together some 1e-5 cells after 100 edges. Facets are met at random, so
/// that this is about the share that differs, ten times as many for starts put on edges and rays along them, where
/// either answer is as good. Bound: 1e-4 for points inside facets and 1e-3 over all.
#[test]
fn lanes_answer_as_the_f64_walk() {
    let mut rng = test_rng(12);
    let mut waves = Waves::default();
    let (mut inside, mut inside_differ, mut all, mut differ) = (0, 0, 0, 0);
    for field in &fields()[..2] {
        let lanes = MaxPyramid::new(field).expect("lanes serve it");
        let traversal = GridTraversal::new(field);
        let over = SimdTraversal::new(traversal, &lanes, Kernel::widest());
        for alpha in ALPHAS {
            let rays = rays(&mut rng, field, alpha, 100_000);
            waves.closest_hit(
                &over,
                rays.len(),
                |k| (&rays[k].0, rays[k].1),
                |k, outcome| {
                    let (place, d) = rays[k];
                    // A ray that goes down meets a torus; none is lost.
                    assert!(matches!(outcome, Outcome::Hit(_)) || d.z > 0.0 && outcome == Outcome::Escaped);
                    let same = match (outcome, traversal.traverse(&place, d)) {
                        (Outcome::Hit(a), Outcome::Hit(b)) => {
                            let near = (a.u - b.u).abs().max((a.v - b.v).abs()) < 1e-2;
                            a.facet == b.facet && near || same_point(field, &a, &b)
                        }
                        (a, b) => a == b,
                    };
                    let interior = place.u.min(place.v) > 0.0
                        && (place.u + place.v - 1.0).abs() > 1e-12
                        && place.u.max(place.v) < 1.0
                        && d.x.abs().min(d.y.abs()) > 1e-9 * d.length()
                        && (d.x.abs() - d.y.abs()).abs() > 1e-9 * d.length();
                    inside += usize::from(interior);
                    inside_differ += usize::from(interior && !same);
                    all += 1;
                    differ += usize::from(!same);
                },
            );
        }
    }
    println!("{differ} of {all} rays differ, {inside_differ} of {inside} inside");
    // 1,000,000 rays: 100 are allowed; a true share of 1.4e-4 would be seen with probability 0.999.
    assert!(inside > 400_000 && inside_differ as f64 <= 1e-4 * inside as f64);
    assert!(differ as f64 <= 1e-3 * all as f64);
}

/// Whether two hits on either side of an edge are one point.
fn same_point(field: &Heightfield, a: &SurfacePoint, b: &SurfacePoint) -> bool {
    let apart = |i: usize, u: f64, j: usize, v: f64, n: usize| {
        let d = (i as f64 + u - j as f64 - v).rem_euclid(n as f64);
        d.min(n as f64 - d)
    };
    let x = apart(a.facet.x, a.u, b.facet.x, b.u, field.cells_x());
    let y = apart(a.facet.y, a.v, b.facet.y, b.v, field.cells_y());
    x.max(y) < 1e-3
}

/// The bounces of one path.
#[derive(Default, Clone)]
struct Bounces(Vec<(DVec3, DVec3)>);

impl Scatter for Bounces {
    fn scatter(&mut self, back: DVec3, normal: DVec3, below: bool) -> Onward {
        Mirrors(|wi, wo| self.0.push((wi, wo))).scatter(back, normal, below)
    }
}

/// Paths in waves end as those followed one by one, in the same order, but for a share of 1e-3: one ray in 1e4 may
/// differ, and paths here have up to five.
#[test]
fn paths_in_waves_are_paths() {
    let mut rng = test_rng(13);
    let field = patch(SlopeLaw::Ggx, 128, 3);
    let lanes = MaxPyramid::new(&field).expect("lanes serve it");
    let traversal = GridTraversal::new(&field);
    let over = [SimdTraversal::new(traversal, &lanes, Kernel::widest()); 2];
    let mut paths = PathWaves::default();
    for (alpha, theta, bounces) in [(0.5, 60.0, 1), (0.5, 60.0, 4), (1.0, 30.0, 4)] {
        let sample = TracedPatch::opaque(traversal, DVec2::splat(alpha), PatchSymmetry::nth(5));
        let wi = sphere::direction_deg(theta, 77.0);
        let starts = lit_inside(&mut rng, &field, sample.to_field(wi), 30_000);
        let mut visits = vec![Bounces::default(); starts.len()];
        let mut endings = vec![PathEnd::Lost; starts.len()];
        paths.trace(
            &over,
            &Wave {
                surface_samples: &starts,
                view_of: &vec![0; starts.len()],
                views: &[View { sample, wi }],
                bounces,
            },
            &mut visits,
            |path, _, ending| endings[path] = ending,
        );
        let mut differ = 0;
        for ((&place, ending), visit) in starts.iter().zip(&endings).zip(&visits) {
            let mut alone = Bounces::default();
            let expected = sample.trace(place, wi, bounces, &mut alone);
            assert_ne!(*ending, PathEnd::Lost);
            // The mirror direction of a facet does not depend on where it is met.
            differ += usize::from(*ending != expected || visit.0 != alone.0);
        }
        println!("{differ} of {} paths differ", starts.len());
        assert!(differ <= starts.len() / 1000, "alpha {alpha}: {differ}");
    }
}

/// Flux by direction: `BINS` of equal projected solid angle, and the whole.
const BINS: (usize, usize) = (16, 36);

fn bin(wo: DVec3) -> usize {
    // z^2 and the azimuth are uniform in projected solid angle.
    let row = (wo.z * wo.z * BINS.0 as f64) as usize;
    let turn = wo.y.atan2(wo.x) / std::f64::consts::TAU + 0.5;
    row.min(BINS.0 - 1) * BINS.1 + ((turn * BINS.1 as f64) as usize).min(BINS.1 - 1)
}

/// A table made through the lanes against one of the same starts made by the f64 walk: their summed absolute
/// difference over the flux. Starts are inside facets, where a ray is answered otherwise with a share below 1e-4
/// (`lanes_answer_as_the_f64_walk`). Here a path asks one question of its light and one after each bounce, up to 4: a
/// share below 5e-4 of the starts ends elsewhere, and each of those takes its flux out of one bin and puts it into
/// another: 1e-3 of the starts. The whole flux changes by 5e-4 at most.
#[test]
fn tables_by_lanes_are_those_of_the_f64_walk() {
    let mut rng = test_rng(14);
    let field = patch(SlopeLaw::Ggx, 128, 4);
    let lanes = MaxPyramid::new(&field).expect("lanes serve it");
    let traversal = GridTraversal::new(&field);
    let over = [SimdTraversal::new(traversal, &lanes, Kernel::widest()); 2];
    let mut paths = PathWaves::default();
    // The last two lights are far beyond what f32 follows to its end, were it not for the f64 walk.
    for (alpha, theta) in [(0.2, 30.0), (0.5, 60.0), (1.0, 75.0), (0.8, 85.0), (0.8, 89.0)] {
        let sample = TracedPatch::opaque(traversal, DVec2::splat(alpha), PatchSymmetry::nth(3));
        let wi = sphere::direction_deg(theta, 131.0);
        let starts = lit_inside(&mut rng, &field, sample.to_field(wi), 100_000);
        let mut visits = vec![Bounces::default(); starts.len()];
        let mut endings = vec![PathEnd::Lost; starts.len()];
        paths.trace(
            &over,
            &Wave {
                surface_samples: &starts,
                view_of: &vec![0; starts.len()],
                views: &[View { sample, wi }],
                bounces: 4,
            },
            &mut visits,
            |path, _, ending| endings[path] = ending,
        );
        let mut tables = [[0i64; BINS.0 * BINS.1]; 2];
        for (&place, ending) in starts.iter().zip(&endings) {
            let alone = sample.trace(place, wi, 4, &mut Bounces::default());
            for (table, ending) in tables.iter_mut().zip([*ending, alone]) {
                if let PathEnd::Out { wo, .. } = ending {
                    table[bin(wo)] += 1;
                }
            }
        }
        let [flux, expected] = tables.map(|table| table.iter().sum::<i64>());
        let apart: i64 = tables[0].iter().zip(&tables[1]).map(|(a, b)| (a - b).abs()).sum();
        println!("alpha {alpha}: {apart} of {expected} apart, flux {:+}", flux - expected);
        // A cell has wi.z of light, and turns some 2 wi.z + alpha to it: there is a table to speak of.
        assert!(expected as f64 > 0.25 * wi.z * starts.len() as f64);
        assert!(apart as f64 <= 1e-3 * starts.len() as f64, "alpha {alpha}: {apart}");
        assert!((flux - expected).abs() as f64 <= 5e-4 * starts.len() as f64, "alpha {alpha}: {flux}");
    }
}

/// Points inside facets that face `light`.
fn lit_inside(rng: &mut Pcg64Dxsm, field: &Heightfield, light: DVec3, count: usize) -> Vec<SurfacePoint> {
    std::iter::repeat_with(|| start(rng, field))
        .filter(|place| {
            let corners = field.corners(place.facet.x, place.facet.y);
            let slope = if place.facet.upper { corners.upper_slope() } else { corners.lower_slope() };
            light.z > light.truncate().dot(slope)
                && place.u.min(place.v) > 0.0
                && place.u.max(place.v) < 1.0
                && (place.u + place.v - 1.0).abs() > 1e-12
        })
        .take(count)
        .collect()
}

/// Rays of up to a hundred legs, and longer ones that the f64 walk takes over, end as the plain walk says, but for a share
/// of 1e-4 for each leg, as any ray (`lanes_answer_as_the_f64_walk`): of some thousand rays, one where it should be none.
#[test]
fn rays_of_many_legs_end_as_in_one_walk() {
    let mut rng = test_rng(15);
    let field = patch(SlopeLaw::Ggx, 128, 5);
    let lanes = MaxPyramid::new(&field).expect("lanes serve it");
    let over = SimdTraversal::new(GridTraversal::new(&field), &lanes, Kernel::widest());
    let (mut waves, mut first) = (Waves::default(), HitBuffer::default());
    for (rise, count) in [(0.008, 5_000), (0.002, 5_000), (0.0002, 2_000)] {
        let ray = |rng: &mut Pcg64Dxsm| {
            let (sin, cos) = (std::f64::consts::TAU * uniform(rng)).sin_cos();
            // Anywhere above the surface: from the surface itself hardly one comes so far.
            let place = start(rng, &field);
            let z = place.z + uniform(rng) * (over.traversal().range().1 - place.z);
            (SurfacePoint { z, ..place }, DVec3::new(cos, sin, rise))
        };
        let rays: Vec<(SurfacePoint, DVec3)> = std::iter::repeat_with(|| ray(&mut rng)).take(count).collect();
        let mut batch = RayBatch::default();
        rays.iter().for_each(|(place, d)| batch.push(place, *d));
        Kernel::widest().any_hit(&lanes, &batch, &mut first);
        let fates = waves.any_hit(&over, count, |k| (&rays[k].0, rays[k].1));
        let long = (0..count).filter(|&k| first.outcomes[k] == RayOutcome::Beyond);
        let (mut long, mut differ): (Vec<usize>, usize) = (long.collect(), 0);
        long.truncate(400);
        for &k in &long {
            let escapes = over.traversal().traverse(&rays[k].0, rays[k].1) == Outcome::Escaped;
            differ +=
                usize::from(fates[k] != if escapes { RayOutcome::Escaped } else { RayOutcome::Blocked });
        }
        println!("rise {rise}: {differ} of {} long rays differ", long.len());
        assert!(long.len() > 20 && differ <= 1, "rise {rise}: {differ} of {}", long.len());
    }
}

/// Rays too long for f32 are said to be so, and the f64 walk hits in their stead.
#[test]
fn very_long_rays_are_left_to_the_f64_walk() {
    let mut heights = vec![0.0; 64];
    heights[0] = 1024.0;
    let field = Heightfield::new(8, 8, true, heights);
    let lanes = MaxPyramid::new(&field).expect("lanes serve it");
    let traversal = GridTraversal::new(&field);
    // Between the needles, along y, for 1e6 cells: nothing is met before the ray is above them.
    let place = SurfacePoint::on(&field, Facet { x: 4, y: 4, upper: false }, 0.25, 0.25);
    let d = DVec3::new(0.0, 1.0, 1e-3);
    assert!(1024.0 / d.z > f64::from(LONGEST));
    let mut batch = RayBatch::default();
    batch.push(&place, d);
    // A vertical ray, and one that f32 cannot scale.
    batch.push(&place, DVec3::Z);
    batch.push(&place, DVec3::new(1e-30, 0.0, 1.0));
    for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.available()) {
        let mut hits = HitBuffer::default();
        kernel.any_hit(&lanes, &batch, &mut hits);
        assert_eq!(
            hits.outcomes,
            [RayOutcome::Beyond, RayOutcome::Escaped, RayOutcome::Escaped],
            "{kernel:?}"
        );
        let over = SimdTraversal::new(traversal, &lanes, kernel);
        assert_eq!(Waves::default().any_hit(&over, 1, |_| (&place, d)), [RayOutcome::Escaped]);
    }
}
