//! Question: samples on grains, normals evenly, or rays from above: which takes less time for the same error?
//!
//! One patch, order 1, bins of 5 x 10 degrees, no plane. Blocks are measured by both ways again and again with draws of
//! their own, alternately: time and variance of a bin stand for the time to an equal error. The means of both must agree.
//! `cargo bench -p gonio-benches --bench grains`.

#[path = "common/blocks.rs"]
mod blocks;

use blocks::{Blocks, HEADING, compared};
use glam::{DVec2, DVec3};
use gonio::rng::{Purpose, StreamId, stream};
use gonio::sphere;
use gonio::surface::grains::{GrainField, usual_side};
use gonio::trace::{
    BLOCK, GrainSampler, Mirrors, Outcome, PatchSymmetry, PathEnd, RaysFromAbove, Traced, TracedGrains,
};
use rand_pcg::Pcg64Dxsm;

const REPLICATES: usize = 24;

/// Nothing is recorded of a bounce.
const UNSEEN: Mirrors<fn(DVec3, DVec3)> = Mirrors(|_, _| ());

fn numbers(block: u64) -> Pcg64Dxsm {
    stream(StreamId { seed: 1, purpose: Purpose::Bench, realisation: 0, incidence: 0, block })
}

fn main() {
    println!("coverage  theta_i  {HEADING}");
    for coverage in [0.2, 0.5, 0.9] {
        let field = GrainField::random(usual_side(coverage), coverage, false, &mut numbers(0));
        let sample = TracedGrains {
            field: &field,
            alpha: DVec2::splat(0.5),
            image: PatchSymmetry::default(),
            mirror_base: false,
        };
        for theta in [10.0, 30.0, 60.0, 80.0] {
            let wi = sphere::direction_deg(theta, 20.0);
            let light = sample.to_field(wi);
            let (mut on_grains, mut above) = (Blocks::default(), Blocks::default());
            for replicate in 0..REPLICATES as u64 {
                on_grains.add(|arrive| from_grains(&sample, wi, &mut numbers(1 + replicate), arrive));
                above.add(|arrive| from_above(&sample, (wi, light), &mut numbers(1001 + replicate), arrive));
            }
            println!("{coverage:>8}  {theta:>7}  {}", compared(&on_grains, &above));
        }
    }
}

fn from_grains(sample: &TracedGrains, wi: DVec3, rng: &mut Pcg64Dxsm, arrive: &mut dyn FnMut(DVec3, f64)) {
    let starts = GrainSampler::new(sample.field, sample.to_field(wi));
    let flux = starts.flux_fraction(BLOCK);
    starts.each(BLOCK, rng, |start| {
        if !start.is_buried(sample.field)
            && let PathEnd::Out { wo, .. } = sample.trace(start, wi, 1, &mut UNSEEN.clone())
        {
            arrive(wo, flux);
        }
    });
}

/// Rays from the level of the tops, at even places of the patch.
fn from_above(
    sample: &TracedGrains,
    (wi, light): (DVec3, DVec3),
    rng: &mut Pcg64Dxsm,
    arrive: &mut dyn FnMut(DVec3, f64),
) {
    RaysFromAbove { field: sample.field, light }.each(BLOCK, rng, |met| {
        let Outcome::Hit(place) = met else { return };
        if let PathEnd::Out { wo, .. } = sample.trace_lit(place, wi, (1, false), &mut UNSEEN.clone()) {
            arrive(wo, 1.0 / BLOCK as f64);
        }
    });
}
