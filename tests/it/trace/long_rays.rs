//! Promise: a ray that is too long for the lanes gets the very answer of the plain f64 walk, whatever it was taken over.

use glam::DVec3;
use gonio::rng::uniform;
use gonio::sphere;
use gonio::surface::{Heightfield, SlopeLaw, Synthesiser};
use gonio::trace::{
    Facet, GridTraversal, Kernel, MaxPyramid, Outcome, SimdTraversal, SurfacePoint, TilePeaks,
};
use rand_pcg::Pcg64Dxsm;

use crate::support::measuring::{start, test_rng, whole};

/// Random patches, a rectangle of steps, needles on a plain (lone and in a row), a plain; and the patch again with
/// heights flatter and higher by a ratio of 10^4 (powers of two, so that f32 holds them). With each the factor by which
/// rays climb: grazing is relative to the surface's own slopes.
fn fields() -> Vec<(&'static str, Heightfield, f64)> {
    let patch = |law, seed| Synthesiser::new(law, 128, 8.0).patch(&mut test_rng(seed));
    let ggx = patch(SlopeLaw::Ggx, 1);
    let (low, high) = (2f64.powi(-13), 2f64.powi(13));
    let scaled = |by: f64| Heightfield::new(128, 128, true, ggx.heights().iter().map(|h| h * by).collect());
    let steps = (0..8 * 256).map(|i| f64::from(i * 7919 % 13) / 4.0).collect();
    let needles = |wanted: &dyn Fn(usize) -> bool| {
        let heights = (0..64 * 64).map(|i| if wanted(i) { 1000.0 } else { 0.0 }).collect();
        Heightfield::new(64, 64, true, heights)
    };
    vec![
        ("flat", scaled(low), low),
        ("high", scaled(high), high),
        ("steps", Heightfield::new(256, 8, true, steps), 1.0),
        ("needle", needles(&|i| i == 0), 10.0),
        ("fence", needles(&|i| i % 64 == 63), 10.0),
        ("plain", Heightfield::new(16, 16, true, vec![1.0; 256]), 1.0),
        ("beckmann", patch(SlopeLaw::Beckmann, 2), 1.0),
        ("ggx", ggx, 1.0),
    ]
}

/// A ray that leaves a random facet, often at a seam, in a corner or on an edge; from 50 to 89.99 degrees, upwards
/// more often than downwards, often along an axis or a diagonal.
fn ray(rng: &mut Pcg64Dxsm, field: &Heightfield, climb: f64) -> (SurfacePoint, DVec3) {
    loop {
        let (place, d) = any_ray(rng, field);
        let d = DVec3::new(d.x, d.y, d.z * climb);
        let slope = field.corners(place.facet.x, place.facet.y).slope(place.facet.upper);
        if d.z > d.truncate().dot(slope) {
            return (place, d);
        }
    }
}

fn any_ray(rng: &mut Pcg64Dxsm, field: &Heightfield) -> (SurfacePoint, DVec3) {
    let place = start(rng, field);
    let phi = if whole(rng, 0, 4) == 0 { 45.0 * whole(rng, 0, 8) as f64 } else { 360.0 * uniform(rng) };
    let below = 10f64.powf(-2.0 + 3.6 * uniform(rng));
    let theta = if whole(rng, 0, 8) == 0 { 90.0 + below } else { 90.0 - below };
    (place, sphere::direction_deg(theta, phi))
}

const RAYS: u64 = 3000;

#[test]
fn a_long_ray_ends_where_the_plain_walk_ends() {
    let mut rng = test_rng(31);
    for (name, field, climb) in &fields() {
        let lanes = MaxPyramid::new(field).expect("lanes serve it");
        let traversal = GridTraversal::new(field);
        let over = SimdTraversal::new(traversal, &lanes, Kernel::Scalar);
        let peaks = TilePeaks::new(field);
        let over_tiles = traversal.with_peaks(&peaks);
        let (mut escaped, mut hit, mut cells) = (0u32, 0u32, 0);
        for _ in 0..RAYS {
            let (place, d) = ray(&mut rng, field, *climb);
            let expected = traversal.traverse_counted(&place, d, &mut cells);
            // Every bit: where it is met, and that it is met at all.
            assert_eq!(over.traverse_long(&place, d), expected, "{name}: {place:?} along {d:?}");
            assert_eq!(over_tiles.traverse(&place, d), expected, "{name}: {place:?} along {d:?}");
            escaped += u32::from(expected == Outcome::Escaped);
            hit += u32::from(matches!(expected, Outcome::Hit(_)));
        }
        println!("{name}: {escaped} escape, {hit} hit, {} cells each", cells / RAYS);
        // Power: both ends are there, except over a plain, and rays are long.
        assert!(escaped > 100 && (hit > 100 || *name == "plain"), "{name}");
    }
}

/// Fields that no lanes serve: open ones, sides that are no powers of two, heights that f32 rounds; with a needle, a wall
/// along each axis, and pits.
#[test]
fn tiles_of_any_field_change_no_answer() {
    let mut rng = test_rng(32);
    for (nx, ny, periodic) in [(30usize, 30usize, true), (200, 9, true), (70, 100, false), (257, 64, false)] {
        let columns = nx + usize::from(!periodic);
        let rows = ny + usize::from(!periodic);
        let shapes: [&dyn Fn(usize, usize) -> f64; 4] = [
            &|x, y| if (x, y) == (5, 6) { 300.1 } else { 0.0 },
            &|x, _| if x == 5 { 300.1 } else { 0.0 },
            &|_, y| if y == 6 { 300.1 } else { 0.0 },
            &|x, y| if (x * y) % 7 == 3 { -300.1 } else { 0.0 },
        ];
        for (shape, extra) in shapes.into_iter().enumerate() {
            let height = |i: usize| extra(i % columns, i / columns) + 0.1 * ((i * 7919) % 13) as f64;
            let field = Heightfield::new(nx, ny, periodic, (0..columns * rows).map(height).collect());
            let (traversal, peaks) = (GridTraversal::new(&field), TilePeaks::new(&field));
            let (mut plain, mut counted, mut ends) = (0, 0, [0u32; 3]);
            for _ in 0..RAYS {
                let (place, d) = ray(&mut rng, &field, 3.0);
                let expected = traversal.traverse_counted(&place, d, &mut plain);
                let found = traversal.with_peaks(&peaks).traverse_counted(&place, d, &mut counted);
                assert_eq!(found, expected, "{nx} x {ny}, shape {shape}: {place:?} along {d:?}");
                let end = match expected {
                    Outcome::Escaped => 0,
                    Outcome::Hit(_) => 1,
                    Outcome::LeftDomain | Outcome::Lost => 2,
                };
                ends[end] += 1;
            }
            println!(
                "{nx} x {ny}, shape {shape}: {ends:?}, {plain} cells, {counted} of them one by one first"
            );
            // Power: rays escape, hit, and of an open field leave; some are longer than what is followed one by one.
            assert!(ends[1] > 100 && (periodic || ends[2] > 100) && counted < plain, "{ends:?}");
            assert!(!periodic || ends[0] > 100, "{ends:?}");
        }
    }
}

/// A ray between needles for 10^6 cells is above them in the end: of each crossing of the field the plain walk looks at
/// every cell.
#[test]
fn a_ray_between_needles_finds_its_way_out() {
    let mut heights = vec![0.0; 64 * 64];
    heights[0] = 1024.0;
    let field = Heightfield::new(64, 64, true, heights);
    let lanes = MaxPyramid::new(&field).expect("lanes serve it");
    let traversal = GridTraversal::new(&field);
    let over = SimdTraversal::new(traversal, &lanes, Kernel::Scalar);
    let place = SurfacePoint::on(&field, Facet { x: 32, y: 32, upper: false }, 0.25, 0.25);
    for (d, expected) in [
        (DVec3::new(0.0, 1.0, 1e-3), Outcome::Escaped),
        (DVec3::new(-1.0, 0.0, 1e-3), Outcome::Escaped),
        (DVec3::Z, Outcome::Escaped),
        (DVec3::new(1e-30, 0.0, 1.0), Outcome::Escaped),
    ] {
        assert_eq!(traversal.traverse(&place, d), expected);
        assert_eq!(over.traverse_long(&place, d), expected);
    }
}
