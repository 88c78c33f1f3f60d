//! Question: how much longer do rays from above, as other programs send them, take for the same error than samples on
//! the facets in the order of their slopes?
//!
//! One patch, light at four zenith angles, order 1, bins of 5 x 10 degrees. Blocks are measured by both ways again and
//! again with draws of their own, alternately: time and variance of a bin stand for the time to an equal error. The means
//! of both must agree. `cargo bench -p gonio-benches --bench from_above`.

mod beam;

#[path = "../common/blocks.rs"]
mod blocks;
#[path = "../common/patches.rs"]
mod patches;

use beam::FromAbove;
use blocks::{Blocks, HEADING, compared};
use glam::{DVec2, DVec3};
use gonio::sphere;
use gonio::trace::{
    BLOCK, BatchedStarts, GridTraversal, Kernel, MaxPyramid, Mirrors, PatchSymmetry, PathEnd, PathWaves,
    SimdTraversal, SlopeIndex, SlopeSampler, SurfacePoint, TracedPatch, View, Wave,
};
use patches::{numbers, patch};

const CELLS: usize = 1024;
const ALPHA: f64 = 0.2;
const REPLICATES: usize = 24;

/// Nothing is recorded of a bounce.
const UNSEEN: Mirrors<fn(DVec3, DVec3)> = Mirrors(|_, _| ());

/// Calls `arrive` with every arrival of samples of this flux.
fn arrivals(
    over: &SimdTraversal,
    view: View,
    (starts, flux): (&[SurfacePoint], f64),
    arrive: &mut dyn FnMut(DVec3, f64),
) {
    let view_of = vec![0; starts.len()];
    let wave = Wave { surface_samples: starts, view_of: &view_of, views: &[view], bounces: 1 };
    PathWaves::default().trace(&[*over; 2], &wave, &mut vec![UNSEEN; starts.len()], |_, _, ending| {
        if let PathEnd::Out { wo, .. } = ending {
            arrive(wo, flux);
        }
    });
}

fn main() {
    let field = patch(CELLS);
    let (index, lanes) = (SlopeIndex::new(&field).expect("periodic"), MaxPyramid::new(&field).expect("2^10"));
    let over = SimdTraversal::new(GridTraversal::new(&field), &lanes, Kernel::widest());
    let sample = TracedPatch::opaque(*over.traversal(), DVec2::splat(ALPHA), PatchSymmetry::default());
    println!("theta_i  {HEADING}");
    for theta in [0.0, 30.0, 60.0, 75.0] {
        let wi = sphere::direction_deg(theta, 20.0);
        let (light, view) = (sample.to_field(wi), View { sample, wi });
        let (mut by_slope, mut above) = (Blocks::default(), Blocks::default());
        for replicate in 0..REPLICATES as u64 {
            let mut rng = numbers(replicate);
            by_slope.add(|arrive| {
                let starts = SlopeSampler::new(&index, &field, light, &mut rng);
                let flux = starts.flux_fraction(BLOCK);
                let (mut together, mut places) = (BatchedStarts::default(), Vec::new());
                together.add(&starts, BLOCK, rng);
                together.each(&index, &field, |facet| over.corners(facet), |_, place| places.push(place));
                arrivals(&over, view, (&places, flux), arrive);
            });
            above.add(|arrive| {
                let mut places = Vec::new();
                let lost = FromAbove::new(over, light).each(BLOCK, &mut numbers(1000 + replicate), |place| {
                    places.push(place);
                });
                assert_eq!(lost, 0);
                arrivals(&over, view, (&places, 1.0 / BLOCK as f64), arrive);
            });
        }
        println!("{theta:>7}  {}", compared(&by_slope, &above));
    }
}
