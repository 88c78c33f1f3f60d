//! Promise: paths start on the facets in proportion to the area that they turn to the light, evenly within each.

use glam::{DVec2, DVec3};
use gonio::sphere;
use gonio::stats::{chi_square_p, mean, sidak};
use gonio::surface::{Heightfield, SlopeLaw, Synthesiser};
use gonio::trace::{AreaSampler, SurfacePoint, Window};

use crate::support::measuring::test_rng;

const CELLS: usize = 16;
const FACETS: usize = 2 * CELLS * CELLS;

fn patch() -> Heightfield {
    Synthesiser::new(SlopeLaw::Ggx, CELLS, 2.0).patch(&mut test_rng(1))
}

fn light() -> DVec3 {
    sphere::direction_deg(60.0, 200.0)
}

fn index(place: &SurfacePoint) -> usize {
    2 * (place.facet.y * CELLS + place.facet.x) + usize::from(place.facet.upper)
}

/// Share of the lit area of each facet: area times the positive part of (wi.m), from the corners' cross product.
fn shares(field: &Heightfield) -> Vec<f64> {
    let areas: Vec<f64> = (0..FACETS)
        .map(|k| {
            let c = field.corners(k / 2 % CELLS, k / 2 / CELLS);
            let (a, b) = if k % 2 == 0 {
                (DVec3::new(1.0, 0.0, c.h10 - c.h00), DVec3::new(0.0, 1.0, c.h01 - c.h00))
            } else {
                (DVec3::new(-1.0, 0.0, c.h01 - c.h11), DVec3::new(0.0, -1.0, c.h10 - c.h11))
            };
            0.5 * a.cross(b).dot(light()).max(0.0)
        })
        .collect();
    let total: f64 = areas.iter().sum();
    areas.iter().map(|area| area / total).collect()
}

/// Systematic steps: each facet gets its share of the starts, rounded down or up. No statistics.
#[test]
fn every_facet_gets_its_share_of_a_block_rounded_down_or_up() {
    let field = patch();
    let starts = AreaSampler::new(&field, Window::all(&field), light());
    for count in [1, 7, 1000, 65_536] {
        let mut counts = vec![0u64; FACETS];
        starts.each(count, &mut test_rng(2), |place| counts[index(&place)] += 1);
        assert_eq!(counts.iter().sum::<u64>(), count);
        for (found, share) in counts.iter().zip(shares(&field)) {
            // Rounding of a running sum of 512 terms, in starts.
            let rounding = 512.0 * f64::EPSILON * count as f64;
            assert!(
                (*found as f64 - share * count as f64).abs() < 1.0 + rounding,
                "{found} {}",
                share * count as f64
            );
        }
    }
}

/// Over blocks of 5 starts the offset decides who gets the odd start: a facet's count is Bernoulli of its expected
/// number's fractional part. Largest |z| at a family level of 1 %; mean square of z near 1.
/// Power: with some 350 lit facets a share is 0.014 of a start, z = 1 is 37 of 100,000 blocks. One facet is seen to be
/// wrong by a fifth of its share (limit 4.2 and three more), all of them by 3 %: 1400 0.03^2 = 1.3 more in the mean.
#[test]
fn over_blocks_every_facet_gets_exactly_its_share() {
    let field = patch();
    let starts = AreaSampler::new(&field, Window::all(&field), light());
    let (blocks, count) = (100_000, 5);
    let mut counts = vec![0u64; FACETS];
    let mut rng = test_rng(3);
    for _ in 0..blocks {
        starts.each(count, &mut rng, |place| counts[index(&place)] += 1);
    }
    let mut squares = Vec::new();
    for (&found, share) in counts.iter().zip(shares(&field)) {
        let expected = share * count as f64;
        if share == 0.0 {
            assert_eq!(found, 0);
            continue;
        }
        let odd = expected.fract();
        let sigma = (f64::from(blocks) * odd * (1.0 - odd)).sqrt();
        squares.push(((found as f64 - f64::from(blocks) * expected) / sigma).powi(2));
    }
    let largest = squares.iter().copied().fold(0.0, f64::max);
    println!(
        "{} lit facets: mean square of z {:.2}, largest {:.2}",
        squares.len(),
        mean(&squares),
        largest.sqrt()
    );
    let level = sidak(0.01, squares.len());
    assert!(chi_square_p(largest, 1) > level, "{largest}");
    // Mean of some 350 squares, weakly dependent: standard deviation 0.08; more than five of them.
    assert!((0.5..1.5).contains(&mean(&squares)), "{}", mean(&squares));
}

/// Chi-square over the 64 small triangles that lines at multiples of 1/8 cut a facet into, lower and upper facets
/// apart; level 0.001 in both tails. Power: half a million starts in 64 triangles that are uneven by d (root mean
/// square) add n d^2 to chi-square: d = 1.4 % adds 100 and is seen with probability 0.999.
#[test]
fn starts_are_even_within_a_facet() {
    let field = patch();
    let starts = AreaSampler::new(&field, Window::all(&field), light());
    let mut counts = [[0u64; 128]; 2];
    starts.each(1 << 20, &mut test_rng(4), |place| {
        let [u, v] = if place.facet.upper { [1.0 - place.u, 1.0 - place.v] } else { [place.u, place.v] };
        assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + f64::EPSILON);
        let at = DVec2::new(8.0 * u, 8.0 * v);
        let (cell, within) = (at.floor(), at.fract());
        let half = usize::from(within.x + within.y > 1.0);
        counts[usize::from(place.facet.upper)][2 * (8 * cell.y as usize + cell.x as usize) + half] += 1;
        // The height is that of the plane, seen from the other corners.
        let c = field.corners(place.facet.x, place.facet.y);
        let z = if place.facet.upper {
            c.h01 * (1.0 - place.u) + c.h10 * (1.0 - place.v) + c.h11 * (place.u + place.v - 1.0)
        } else {
            c.h10 * place.u + c.h01 * place.v + c.h00 * (1.0 - place.u - place.v)
        };
        // A dozen roundings of heights below 100.
        assert!((place.z - z).abs() < 12.0 * 100.0 * f64::EPSILON, "{} {z}", place.z);
    });
    for counts in counts {
        let total: u64 = counts.iter().sum();
        let expected = total as f64 / 64.0;
        let filled: Vec<u64> = counts.into_iter().filter(|&n| n > 0).collect();
        assert_eq!(filled.len(), 64);
        let chi2: f64 = filled.iter().map(|&n| (n as f64 - expected).powi(2) / expected).sum();
        let p = chi_square_p(chi2, 63);
        println!("{total} starts: chi-square {chi2:.1} of 63, p = {p:.3}");
        assert!((0.001..0.999).contains(&p), "{p}");
    }
}
