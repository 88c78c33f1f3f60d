//! Promise: a line sweep sees what rays see, starts in proportion to the area turned to the light, and is unbiased.

use std::array;

use glam::{DVec2, DVec3};
use gonio::rng;
use gonio::sphere;
use gonio::stats::{chi_square_p, mean_and_se, sidak};
use gonio::surface::{Heightfield, SlopeLaw, Synthesiser};
use gonio::trace::{Layout, Outcome, Place, Starts, Sweep, Walker, Window};

use crate::support::measuring::test_rng;

fn ggx(cells: usize) -> Heightfield {
    Synthesiser::new(SlopeLaw::Ggx, cells, 2.0).patch(&mut test_rng(1))
}

/// Unrelated heights in [0, 3).
fn rough(nx: usize, ny: usize) -> Heightfield {
    let mut rng = test_rng(7);
    Heightfield::new(nx, ny, true, (0..nx * ny).map(|_| 3.0 * rng::uniform(&mut rng)).collect())
}

/// The canonical light at `theta_deg` over `heading`.
fn over(heading: DVec2, theta_deg: f64) -> DVec3 {
    let (sin, cos) = sphere::sin_cos_deg(theta_deg);
    (sin * heading.normalize()).extend(cos)
}

/// Axes, diagonals and some others.
fn headings() -> Vec<DVec2> {
    let round = (0..8).map(|k| DVec2::from_angle(f64::from(k) * 45f64.to_radians()).round());
    round.chain((0..7).map(|k| DVec2::from_angle(0.3 + f64::from(k)))).collect()
}

/// Everything is turned to the light and lit.
#[test]
fn a_flat_patch_is_seen_whole() {
    let field = Heightfield::new(10, 24, true, vec![1.0; 240]);
    let layout = Layout::new(&field).expect("periodic");
    for heading in headings().into_iter().chain([DVec2::ZERO]) {
        for theta in [0.0, 45.0, 89.0] {
            let light = if heading == DVec2::ZERO { DVec3::Z } else { over(heading, theta) };
            let sweep = Sweep::new(&layout, heading, &[light], 0.3);
            // A thousand roundings of a sum.
            let rounding = 1000.0 * f64::EPSILON * 240.0;
            assert!((sweep.visible()[0] - 240.0 * light.z).abs() < rounding);
            assert!((sweep.turned(0) - 240.0 * light.z).abs() < rounding);
            assert!((sweep.share(0, 100) - 0.01).abs() < rounding);
            let (mut all, mut lit) = (0, 0);
            sweep.each(100, &[0.5], |_, _, sees| (all, lit) = (all + 1, lit + u64::from(sees)));
            assert_eq!((all, lit), (100, 100));
        }
    }
}

/// Ridges along y, slopes +-1: a pair of facets turns max(0, z - x) + max(0, z + x) to the light, and 2 z of it is
/// lit while x >= z.
#[test]
fn a_v_groove_is_seen_as_its_closed_form_says() {
    let field = Heightfield::new(8, 12, true, (0..96).map(|k| f64::from(k % 2)).collect());
    let layout = Layout::new(&field).expect("periodic");
    for (theta, phi) in [(30.0, 0.0), (60.0, 0.0), (60.0, 180.0), (80.0, 30.0), (89.0, 70.0), (60.0, 90.0)] {
        let light = sphere::direction_deg(theta, phi);
        let sweep = Sweep::new(&layout, light.truncate(), &[light], 0.6);
        let turned = 48.0 * ((light.z - light.x).max(0.0) + (light.z + light.x).max(0.0));
        // A thousand roundings of a sum below 200.
        assert!((sweep.turned(0) - turned).abs() < 1000.0 * f64::EPSILON * 200.0, "{theta} {phi}");
        // Lines that do not close differ by their ends: depths up to reach x height range, on 12 lines at most.
        let ends = if phi % 90.0 == 0.0 { 1e-9 } else { 12.0 };
        assert!((sweep.visible()[0] - 96.0 * light.z).abs() < ends, "{theta} {phi}");
    }
}

/// Torus closure: where the lines end on each other's begins, what they see is cos(theta) of the patch, exactly.
#[test]
fn closed_lines_see_the_cosine_of_the_patch() {
    for (nx, ny) in [(24, 24), (10, 24), (24, 10), (130, 20), (3, 300)] {
        let field = rough(nx, ny);
        let layout = Layout::new(&field).expect("periodic");
        let (long, across) = (nx as f64, ny as f64);
        let shifts = [-1.0, -0.5, -0.1, 0.0, 0.3, 0.9, 1.0];
        // Heading (n, m) cells: after n columns each line is m cells across, on another line.
        let along_x = shifts.map(|shift| DVec2::new(long, (shift * long).trunc()));
        let along_y = shifts.map(|shift| DVec2::new((shift * across).trunc(), across));
        for heading in along_x.into_iter().chain(along_y).flat_map(|heading| [heading, -heading]) {
            for theta in [0.0, 30.0, 60.0, 85.0, 89.0] {
                let light = over(heading, theta);
                let visible = Sweep::new(&layout, heading, &[light], 0.4).visible()[0];
                let wanted = light.z * long * across;
                // Depths are carried over some thousand steps with roundings of heights below 3.
                let rounding = 1e4 * f64::EPSILON * 3.0 * (nx * ny) as f64;
                assert!(
                    (visible - wanted).abs() < rounding,
                    "{nx} {ny} {heading} {theta}: {visible} {wanted}"
                );
            }
        }
    }
}

/// Any other azimuth: the lines' ends leave at most the depth of a shadow, |d| x height range per line.
#[test]
fn lines_that_do_not_close_see_it_up_to_their_ends() {
    let field = ggx(64);
    let layout = Layout::new(&field).expect("periodic");
    let (low, high) = field.range();
    for heading in headings() {
        for theta in [30.0, 60.0, 85.0] {
            let light = over(heading, theta);
            let visible = Sweep::new(&layout, heading, &[light], 0.4).visible()[0];
            let ends = 64.0 * (high - low) * sphere::sin_cos_deg(theta).0;
            assert!((visible - light.z * 4096.0).abs() < ends, "{heading} {theta}");
        }
    }
}

/// Every start against the reference walk. A start is undecided where its depth below the light is rounding, some
/// 1e-12 of the measure between two starts: none of 200,000.
#[test]
fn the_sweep_and_the_walk_agree_on_every_start() {
    let (mut starts, mut seen) = (0u64, 0u64);
    let grooves = Heightfield::new(8, 12, true, (0..96).map(|k| f64::from(k % 2)).collect());
    for field in [ggx(64), ggx(150), rough(10, 24), rough(24, 10), rough(2, 300), grooves] {
        let layout = Layout::new(&field).expect("periodic");
        let walker = Walker::new(&field);
        for heading in headings() {
            let lights = [0.0, 30.0, 60.0, 85.0, 89.0].map(|theta| over(heading, theta));
            let sweep = Sweep::new(&layout, heading, &lights, 0.123);
            let offsets = [0.9, 0.1, 0.2, 0.5, 0.77];
            sweep.each(500, &offsets, |light, place, lit| {
                let found = walker.walk(&place, lights[light]);
                assert!(matches!(found, Outcome::Escaped | Outcome::Hit(_)));
                assert_eq!(lit, found == Outcome::Escaped, "{heading} {light} {place:?}");
                let plane = Place::on(&field, place.facet, place.u, place.v);
                // Heights below 200, a dozen roundings.
                assert!((plane.z - place.z).abs() < 12.0 * 200.0 * f64::EPSILON, "{place:?} {plane:?}");
                starts += 1;
                seen += u64::from(lit);
            });
        }
    }
    assert_eq!(starts, 6 * 15 * 5 * 500);
    assert!(seen > starts / 10 && seen < starts * 9 / 10, "{seen}");
}

#[test]
fn zenith_angles_in_one_pass_are_each_alone() {
    let field = ggx(150);
    let layout = Layout::new(&field).expect("periodic");
    for heading in headings() {
        let lights: Vec<DVec3> =
            [0.0, 30.0, 60.0, 75.0, 89.0].iter().map(|&theta| over(heading, theta)).collect();
        let offsets = [0.9, 0.1, 0.2, 0.5, 0.77];
        let mut together = vec![Vec::new(); lights.len()];
        let sweep = Sweep::new(&layout, heading, &lights, 0.3);
        sweep.each(1000, &offsets, |light, place, lit| together[light].push((bits(&place), lit)));
        let visible = sweep.visible();
        for (k, together) in together.iter().enumerate() {
            let alone = Sweep::new(&layout, heading, &lights[k..=k], 0.3);
            let mut starts = Vec::new();
            alone.each(1000, &offsets[k..=k], |_, place, lit| starts.push((bits(&place), lit)));
            assert_eq!(*together, starts);
            assert_eq!(starts.len(), 1000);
            assert_eq!(alone.visible()[0].to_bits(), visible[k].to_bits());
            assert_eq!(alone.share(0, 1).to_bits(), sweep.share(k, 1).to_bits());
        }
    }
}

fn bits(place: &Place) -> (usize, usize, bool, [u64; 3]) {
    let facet = place.facet;
    (facet.x, facet.y, facet.upper, [place.u, place.v, place.z].map(f64::to_bits))
}

/// One start from each of 60,000 sweeps, weighted with what its lines turned, against max(0, wi.m) A by the
/// corners' cross product: per facet, and per small triangle that lines at multiples of 1/4 cut facets into.
/// Largest |z| at a family level of 1 %, mean square of z near 1: a facet of mean weight (170 starts) that is off by
/// a third fails, and the mean over facets finds 4 % of scatter.
#[test]
fn over_sweeps_every_facet_and_every_part_of_it_gets_its_share() {
    let field = ggx(16);
    let layout = Layout::new(&field).expect("periodic");
    let light = sphere::direction_deg(60.0, 200.0);
    let mut rng = test_rng(3);
    let blocks = 60_000;
    let (mut facets, mut parts) = (vec![Moments::default(); 512], vec![Moments::default(); 32]);
    for _ in 0..blocks {
        let (across, step) = (rng::uniform(&mut rng), rng::uniform(&mut rng));
        let sweep = Sweep::new(&layout, light.truncate(), &[light], across);
        sweep.each(1, &[step], |_, place, _| {
            facets[2 * (place.facet.y * 16 + place.facet.x) + usize::from(place.facet.upper)]
                .add(sweep.turned(0));
            parts[part(&place)].add(sweep.turned(0));
        });
    }
    let areas: Vec<f64> = (0..512).map(|k| turned_area(&field, k, light)).collect();
    let in_kind = |kind| areas.iter().skip(kind).step_by(2).sum::<f64>();
    let parts_expected: Vec<f64> = (0..32).map(|k| in_kind(k / 16) / 16.0).collect();
    for (found, expected) in [(facets, areas), (parts, parts_expected)] {
        let mut squares = Vec::new();
        for (found, expected) in found.iter().zip(&expected) {
            assert!(*expected > 0.0 || found.count == 0);
            // Fewer than 30 starts are no normal law.
            if found.count >= 30 {
                squares.push(found.z(blocks, *expected).powi(2));
            }
        }
        let largest = squares.iter().copied().fold(0.0, f64::max);
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        println!("{} classes: mean square of z {mean:.2}, largest {:.2}", squares.len(), largest.sqrt());
        assert!(chi_square_p(largest, 1) > sidak(0.01, squares.len()), "{largest}");
        // Standard deviation of the mean square sqrt(2/n); four of them.
        let spread = 4.0 * (2.0 / squares.len() as f64).sqrt();
        assert!((mean - 1.0).abs() < spread, "{mean} {spread}");
    }
}

/// Sum and sum of squares of weights.
#[derive(Clone, Default)]
struct Moments {
    count: u64,
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, weight: f64) {
        self.count += 1;
        self.sum += weight;
        self.squares += weight * weight;
    }

    /// (mean - expected)/standard error over `blocks`, those without a start counting 0.
    fn z(&self, blocks: u64, expected: f64) -> f64 {
        let blocks = blocks as f64;
        let mean = self.sum / blocks;
        (mean - expected) / ((self.squares / blocks - mean * mean) / blocks).sqrt()
    }
}

fn turned_area(field: &Heightfield, facet: usize, light: DVec3) -> f64 {
    let c = field.corners(facet / 2 % 16, facet / 32);
    let (a, b) = if facet.is_multiple_of(2) {
        (DVec3::new(1.0, 0.0, c.h10 - c.h00), DVec3::new(0.0, 1.0, c.h01 - c.h00))
    } else {
        (DVec3::new(-1.0, 0.0, c.h01 - c.h11), DVec3::new(0.0, -1.0, c.h10 - c.h11))
    };
    0.5 * a.cross(b).dot(light).max(0.0)
}

/// Which of the 16 small triangles of its facet a place lies in; those of upper facets from 16 on.
fn part(place: &Place) -> usize {
    let upper = place.facet.upper;
    let [u, v] = if upper { [1.0 - place.u, 1.0 - place.v] } else { [place.u, place.v] };
    let at = DVec2::new(4.0 * u, 4.0 * v).clamp(DVec2::ZERO, DVec2::splat(3.999_999));
    let (cell, within) = (at.floor(), at.fract());
    let (row, column) = (cell.y as usize, cell.x as usize);
    // Row r has 4 - r lower triangles and one less of the others.
    let before: usize = (0..row).map(|row| 7 - 2 * row).sum();
    let in_row = (2 * column + usize::from(within.x + within.y > 1.0)).min(6 - 2 * row);
    16 * usize::from(upper) + before + in_row
}

/// Lit flux by the facet's slope, in 8 sectors and below or above the median slope, over 300 blocks each way:
/// sum of z^2 of the differences is chi-square of 16; level 0.001.
#[test]
fn sweeps_and_starts_with_rays_have_the_same_mean() {
    let field = ggx(64);
    let layout = Layout::new(&field).expect("periodic");
    let walker = Walker::new(&field);
    let light = sphere::direction_deg(60.0, 33.0);
    let (blocks, count) = (300, 256);
    let mut rng = test_rng(5);
    let by_rays: Vec<[f64; 16]> = (0..blocks)
        .map(|_| {
            let starts = Starts::new(&field, Window::all(&field), light);
            let mut flux = [0.0; 16];
            starts.each(count, &mut rng, |place| {
                let lit = walker.walk(&place, light) == Outcome::Escaped;
                flux[class(&field, &place)] += if lit { starts.share(count) } else { 0.0 };
            });
            flux
        })
        .collect();
    let by_sweep: Vec<[f64; 16]> = (0..blocks)
        .map(|_| {
            let sweep = Sweep::new(&layout, light.truncate(), &[light], rng::uniform(&mut rng));
            let mut flux = [0.0; 16];
            sweep.each(count, &[rng::uniform(&mut rng)], |_, place, lit| {
                flux[class(&field, &place)] += if lit { sweep.share(0, count) } else { 0.0 };
            });
            flux
        })
        .collect();
    let of = |flux: &[[f64; 16]], k: usize| {
        let (mean, se) = mean_and_se(flux.iter().map(|flux| flux[k]));
        (mean, se.expect("several blocks"))
    };
    let z: [f64; 16] = array::from_fn(|k| {
        let ((a, sa), (b, sb)) = (of(&by_rays, k), of(&by_sweep, k));
        if a == b { 0.0 } else { (a - b) / sa.hypot(sb) }
    });
    let chi2: f64 = z.iter().map(|z| z * z).sum();
    println!("chi-square {chi2:.1} of 16: {z:.2?}");
    assert!(chi_square_p(chi2, 16) > 0.001, "{chi2}");
}

fn class(field: &Heightfield, place: &Place) -> usize {
    let corners = field.corners(place.facet.x, place.facet.y);
    let slope = if place.facet.upper { corners.upper_slope() } else { corners.lower_slope() };
    let sector = (slope.to_angle() / 45f64.to_radians()).rem_euclid(8.0) as usize % 8;
    2 * sector + usize::from(slope.length() > 1.0)
}

#[test]
fn an_open_field_has_no_layout() {
    assert!(Layout::new(&Heightfield::new(1, 1, false, vec![0.0; 4])).is_none());
}
