//! Report, not a promise: how often the light sees a facet of given slope on an explicit surface, beside Smith's masking,
//! which says that all facets turned to the light are seen equally often. Nothing makes a continuous surface do so.

use glam::DVec2;
use gonio::sphere;
use gonio::surface::{SlopeLaw, Synthesiser};
use gonio::theory::{ArmSide, Ndf};
use gonio::trace::{AreaSampler, BLOCK, GridTraversal, Outcome, PatchSymmetry, TracedPatch, Window};

use crate::support::measuring::test_rng;

/// Slopes along the light, in units of alpha: negative ones fall towards it.
const EDGES: [f64; 8] = [-4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0];

#[test]
#[ignore = "a report: cargo test --release --test it masking_given_the_normal -- --ignored --nocapture"]
fn a_smooth_surface_masks_facets_by_their_slope() {
    let alpha = 0.5;
    let field = Synthesiser::new(SlopeLaw::Ggx, 512, 8.0).patch(&mut test_rng(31));
    let traversal = GridTraversal::new(&field);
    let sample = TracedPatch::opaque(traversal, DVec2::splat(alpha), PatchSymmetry::nth(0));
    for theta_deg in [30.0, 60.0, 75.0] {
        let (mut seen, mut all) = ([0_u64; EDGES.len() + 1], [0_u64; EDGES.len() + 1]);
        for turn in 0..16 {
            let phi_deg = 22.5 * f64::from(turn) + 5.0;
            let light = sample.to_field(sphere::direction_deg(theta_deg, phi_deg));
            let along = light.truncate().normalize();
            let starts = AreaSampler::new(&field, Window::all(&field), light);
            starts.each(BLOCK, &mut test_rng(32 + turn as u64), |place| {
                let corners = field.corners(place.facet.x, place.facet.y);
                let slope = if place.facet.upper { corners.upper_slope() } else { corners.lower_slope() };
                let class = EDGES.partition_point(|&edge| edge <= slope.dot(along));
                all[class] += 1;
                seen[class] += u64::from(traversal.traverse(&place, light) == Outcome::Escaped);
            });
        }
        let smith = ArmSide::new(Ndf::Ggx, sphere::direction_deg(theta_deg, 0.0), alpha, alpha).g1();
        println!("alpha {alpha} theta {theta_deg}: Smith's G1 {smith:.4}");
        for class in (0..all.len()).filter(|&class| all[class] > 0) {
            let share = seen[class] as f64 / all[class] as f64;
            // Binomial: the patch's own share adds to it.
            let error = (share * (1.0 - share) / all[class] as f64).sqrt();
            let low = if class == 0 { f64::NEG_INFINITY } else { EDGES[class - 1] };
            println!("  slope from {low:>5}: {share:.4} +- {error:.4} of {} starts", all[class]);
        }
        // Over all slopes the seen area is the projected one: on a torus exactly, and Smith's by construction.
        let share = seen.iter().sum::<u64>() as f64 / all.iter().sum::<u64>() as f64;
        println!("  all slopes: {share:.4}");
    }
}
