//! Question: samples on grains, normals evenly, or rays from above: which takes less time for the same error?
//!
//! One patch, order 1, bins of 5 x 10 degrees, no plane. Blocks are measured by both ways again and again with draws of
//! their own, alternately: time and variance of a bin stand for the time to an equal error. The means of both must agree.
//! `cargo bench --bench grains`.

use glam::{DVec2, DVec3};
use gonio::measure::cost::cpu_seconds;
use gonio::rng::{Purpose, StreamId, stream};
use gonio::sphere;
use gonio::surface::grains::{GrainField, usual_side};
use gonio::trace::{
    BLOCK, Bounce, GrainSampler, Outcome, PatchSymmetry, PathEnd, RaysFromAbove, Traced, TracedGrains,
};
use rand_pcg::Pcg64Dxsm;

const REPLICATES: usize = 24;
const BINS: (usize, usize) = (18, 36);
/// Bins below this fraction of the peak do not count.
const COUNTED_ABOVE: f64 = 0.01;

struct Unseen;

impl Bounce for Unseen {
    fn bounce(&mut self, _wi: DVec3, _wo: DVec3) {}
}

fn numbers(block: u64) -> Pcg64Dxsm {
    stream(StreamId { seed: 1, purpose: Purpose::Bench, realisation: 0, stop: 0, block })
}

/// The bins that blocks of samples fill: seconds of processor time, and the flux of each block.
#[derive(Default)]
struct Blocks {
    seconds: f64,
    bins: Vec<Vec<f64>>,
}

impl Blocks {
    fn add(&mut self, block: impl FnOnce(&mut dyn FnMut(DVec3, f64))) {
        let mut bins = vec![0.0; BINS.0 * BINS.1];
        let before = cpu_seconds();
        block(&mut |wo, flux| {
            let (theta, phi) = (wo.z.acos().to_degrees(), wo.y.atan2(wo.x).to_degrees().rem_euclid(360.0));
            let row = ((theta / 90.0 * BINS.0 as f64) as usize).min(BINS.0 - 1);
            bins[row * BINS.1 + ((phi / 360.0 * BINS.1 as f64) as usize).min(BINS.1 - 1)] += flux;
        });
        self.seconds += cpu_seconds() - before;
        self.bins.push(bins);
    }

    fn mean_and_variance(&self, bin: usize) -> (f64, f64) {
        let count = self.bins.len() as f64;
        let mean = self.bins.iter().map(|block| block[bin]).sum::<f64>() / count;
        let squares: f64 = self.bins.iter().map(|block| (block[bin] - mean).powi(2)).sum();
        (mean, squares / (count - 1.0))
    }
}

fn main() {
    println!("coverage  theta_i  bins  time  variance  time to an equal error  largest |t| of the means");
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
            report(coverage, theta, &on_grains, &above);
        }
    }
}

fn from_grains(sample: &TracedGrains, wi: DVec3, rng: &mut Pcg64Dxsm, arrive: &mut dyn FnMut(DVec3, f64)) {
    let starts = GrainSampler::new(sample.field, sample.to_field(wi));
    let flux = starts.flux_fraction(BLOCK);
    starts.each(BLOCK, rng, |start| {
        if !start.is_buried(sample.field)
            && let PathEnd::Out { wo, .. } = sample.trace(start, wi, 1, &mut Unseen)
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
        if let PathEnd::Out { wo, .. } = sample.trace_lit(place, wi, (1, false), &mut Unseen) {
            arrive(wo, 1.0 / BLOCK as f64);
        }
    });
}

fn report(coverage: f64, theta: f64, on_grains: &Blocks, above: &Blocks) {
    let bins: Vec<[(f64, f64); 2]> = (0..BINS.0 * BINS.1)
        .map(|bin| [on_grains.mean_and_variance(bin), above.mean_and_variance(bin)])
        .collect();
    let peak = bins.iter().fold(0.0f64, |peak, [(mean, _), _]| peak.max(*mean));
    let counted: Vec<_> = bins.iter().filter(|[(mean, _), _]| *mean > COUNTED_ABOVE * peak).collect();
    let mut ratios: Vec<f64> = counted.iter().map(|[(_, grains), (_, above)]| above / grains).collect();
    ratios.sort_by(f64::total_cmp);
    let (time, variance) = (above.seconds / on_grains.seconds, ratios[ratios.len() / 2]);
    let t = |[(a, a_variance), (b, b_variance)]: &[(f64, f64); 2]| {
        ((a - b) / ((a_variance + b_variance) / REPLICATES as f64).sqrt()).abs()
    };
    let largest = counted.iter().map(|bin| t(bin)).fold(0.0, f64::max);
    println!(
        "{coverage:>8}  {theta:>7}  {:>4}  {time:>4.2}  {variance:>8.2}  {:>22.2}  {largest:>24.2}",
        counted.len(),
        time * variance
    );
}
