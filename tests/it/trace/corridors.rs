//! Promise: a ray that comes round a periodic field thousands of times beside a wall or along a groove gets the very
//! answer of the plain walk, at a cost that the cells of the field bound, whatever the heights.

use glam::DVec3;
use gonio::rng::uniform;
use gonio::surface::Heightfield;
use gonio::trace::{Facet, GridTraversal, Outcome, SurfacePoint, TilePeaks};
use rand_pcg::Pcg64Dxsm;

use crate::support::measuring::{start, test_rng, whole};

/// Walls along an axis, ridges along either diagonal, and a row of needles, 100 cells high over rough ground, with the
/// direction of their corridor: closed round the field, or with a seam where its sides are no multiples of 4.
fn fields() -> Vec<(&'static str, Heightfield, (f64, f64))> {
    let field = |nx: usize, ny: usize, is_high: &dyn Fn(usize, usize) -> bool| {
        let height = |i: usize| {
            let rough = 1e-3 * ((i * 7919) % 13) as f64;
            if is_high(i % nx, i / nx) { 100.0 + rough } else { rough }
        };
        Heightfield::new(nx, ny, true, (0..nx * ny).map(height).collect())
    };
    vec![
        ("wall along x", field(32, 32, &|_, y| y == 3), (1.0, 0.0)),
        ("wall along y", field(30, 17, &|x, _| x == 3), (0.0, 1.0)),
        ("ridges", field(32, 32, &|x, y| (x + y) % 4 == 0), (1.0, -1.0)),
        ("ridges across the cells", field(32, 16, &|x, y| (x + 3 * y) % 4 == 0), (1.0, 1.0)),
        ("ridges with a seam", field(33, 17, &|x, y| (x + y) % 4 == 0), (1.0, -1.0)),
        ("needles", field(32, 32, &|x, y| y == 5 && x % 4 == 0), (1.0, 0.0)),
    ]
}

/// A ray from a random facet, up or down along the corridor but for 10^-8 to 10^-1, which meets or clears everything
/// within some 10^5 cells.
fn ray(rng: &mut Pcg64Dxsm, field: &Heightfield, (x, y): (f64, f64)) -> (SurfacePoint, DVec3) {
    loop {
        let place = start(rng, field);
        let sign = |rng: &mut Pcg64Dxsm| if whole(rng, 0, 2) == 0 { 1.0 } else { -1.0 };
        let aside =
            if whole(rng, 0, 6) == 0 { 0.0 } else { sign(rng) * 10f64.powf(-8.0 + 7.0 * uniform(rng)) };
        let (along, climb) = (sign(rng), sign(rng) * 10f64.powf(-3.0 + 2.0 * uniform(rng)));
        let d = DVec3::new(along * x - aside * y, along * y + aside * x, climb);
        let slope = field.corners(place.facet.x, place.facet.y).slope(place.facet.upper);
        if d.z > d.truncate().dot(slope) {
            return (place, d);
        }
    }
}

#[test]
fn a_ray_along_a_corridor_ends_where_the_plain_walk_ends() {
    const RAYS: u64 = 1500;
    let mut rng = test_rng(41);
    for (name, field, corridor) in &fields() {
        let (traversal, peaks) = (GridTraversal::new(field), TilePeaks::new(field));
        let (mut cells, mut long, mut ends) = (0, 0, [0u32; 2]);
        for _ in 0..RAYS {
            let (place, d) = ray(&mut rng, field, *corridor);
            let before = cells;
            let expected = traversal.traverse_counted(&place, d, &mut cells);
            // Every bit: where it is met, and that it is met at all.
            assert_eq!(
                traversal.with_peaks(&peaks).traverse(&place, d),
                expected,
                "{name}: {place:?} along {d:?}"
            );
            // A hundred times round, and more.
            long += u32::from(cells - before > 3200);
            ends[usize::from(expected == Outcome::Escaped)] += 1;
        }
        println!("{name}: {ends:?} hit and escape, {long} are long, {} cells each", cells / RAYS);
        // Power: both ends are there; rays are long, but where something stands in the way of each pass.
        let open = ["wall along x", "wall along y", "ridges"].contains(name);
        assert!(
            ends.iter().all(|&end| end > 10) && (long > 100 || !open),
            "{name}: {ends:?}, {long} are long"
        );
    }
}

/// A wall a million cells high, from whose face rays go down at 89.9994 degrees, 10^9 cells along the wall and 100 away
/// from it. Cell by cell the 200 rays would take half an hour.
#[test]
fn a_ray_along_a_wall_of_any_height_takes_no_longer_than_its_field_is_large() {
    let (rows, high, climb, aside) = (128, 1e6, -1e-3, 1e-7);
    let heights = (0..16 * rows).map(|i| if i / 16 == 0 { high } else { 0.0 }).collect();
    let field = Heightfield::new(16, rows, true, heights);
    let (traversal, peaks) = (GridTraversal::new(&field), TilePeaks::new(&field));
    let mut rng = test_rng(42);
    for _ in 0..200 {
        let facet = Facet { x: whole(&mut rng, 0, 16) as usize, y: 0, upper: false };
        let v = uniform(&mut rng);
        let place = SurfacePoint::on(&field, facet, uniform(&mut rng) * (1.0 - v), v);
        let d = DVec3::new(1.0, aside, climb);
        let Outcome::Hit(end) = traversal.with_peaks(&peaks).traverse(&place, d) else {
            panic!("{place:?} meets nothing")
        };
        // Down on the plain, which begins a row from the wall; the face falls faster than the ray.
        let away = v + place.z / -climb * aside;
        let found = end.facet.y as f64 + end.v;
        // A place after 10^9 cells is rounded to some 2^-53 of that, the slope of the ray makes it 10^-10 rows.
        assert!(end.z == 0.0 && (found - away).abs() < 1e-6, "{found} rows away, not {away}");
    }
}
