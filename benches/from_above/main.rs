//! Question: how much longer do rays from above, as other programs send them, take for the same error than samples on
//! the facets in the order of their slopes?
//!
//! One patch, light at four zenith angles, order 1, bins of 5 x 10 degrees. Blocks are measured by both ways again and
//! again with draws of their own, alternately: time and variance of a bin stand for the time to an equal error. The means
//! of both must agree. `cargo bench --bench from_above`.

mod beam;

#[path = "../common/patches.rs"]
mod patches;

use beam::FromAbove;
use glam::{DVec2, DVec3};
use gonio::measure::cost::cpu_seconds;
use gonio::sphere;
use gonio::trace::{
    BLOCK, BatchedStarts, Bounce, GridTraversal, Kernel, MaxPyramid, PatchSymmetry, PathEnd, PathWaves,
    SimdTraversal, SlopeIndex, SlopeSampler, SurfacePoint, TracedPatch, View, Wave,
};
use patches::{numbers, patch};

const CELLS: usize = 1024;
const ALPHA: f64 = 0.2;
const REPLICATES: usize = 24;
/// Rows of the polar angle and columns of the azimuth.
const BINS: (usize, usize) = (18, 36);
/// Bins below this fraction of the peak do not count.
const COUNTED_ABOVE: f64 = 0.01;

/// Nothing is recorded of a bounce.
#[derive(Clone, Copy)]
struct Unseen;

impl Bounce for Unseen {
    fn bounce(&mut self, _wi: DVec3, _wo: DVec3) {}
}

/// The flux in every bin that samples of this flux bring.
fn arrivals(over: &SimdTraversal, view: View, starts: &[SurfacePoint], flux: f64) -> Vec<f64> {
    let view_of = vec![0; starts.len()];
    let wave = Wave { surface_samples: starts, view_of: &view_of, views: &[view], bounces: 1 };
    let (mut seen, mut endings) = (vec![Unseen; starts.len()], Vec::new());
    PathWaves::default().trace(over, &wave, &mut seen, &mut endings);
    let mut bins = vec![0.0; BINS.0 * BINS.1];
    for ending in endings {
        if let PathEnd::Out { wo, .. } = ending {
            let (theta, phi) = (wo.z.acos().to_degrees(), wo.y.atan2(wo.x).to_degrees().rem_euclid(360.0));
            let row = ((theta / 90.0 * BINS.0 as f64) as usize).min(BINS.0 - 1);
            bins[row * BINS.1 + ((phi / 360.0 * BINS.1 as f64) as usize).min(BINS.1 - 1)] += flux;
        }
    }
    bins
}

/// Blocks by one way: seconds of processor time, and the bins of each.
#[derive(Default)]
struct Blocks {
    seconds: f64,
    bins: Vec<Vec<f64>>,
}

impl Blocks {
    fn add(&mut self, block: impl FnOnce() -> Vec<f64>) {
        let before = cpu_seconds();
        self.bins.push(block());
        self.seconds += cpu_seconds() - before;
    }

    fn mean_and_variance(&self, bin: usize) -> (f64, f64) {
        let count = self.bins.len() as f64;
        let mean = self.bins.iter().map(|block| block[bin]).sum::<f64>() / count;
        let squares: f64 = self.bins.iter().map(|block| (block[bin] - mean).powi(2)).sum();
        (mean, squares / (count - 1.0))
    }
}

fn main() {
    let field = patch(CELLS);
    let (index, lanes) = (SlopeIndex::new(&field).expect("periodic"), MaxPyramid::new(&field).expect("2^10"));
    let over = SimdTraversal::new(GridTraversal::new(&field), &lanes, Kernel::widest());
    let sample = TracedPatch {
        traversal: *over.traversal(),
        alpha: DVec2::splat(ALPHA),
        image: PatchSymmetry::default(),
    };
    println!("theta_i  bins  time  variance  time to an equal error  largest |t| of the means");
    for theta in [0.0, 30.0, 60.0, 75.0] {
        let wi = sphere::direction_deg(theta, 20.0);
        let (light, view) = (sample.to_field(wi), View { sample, wi });
        let (mut by_slope, mut above) = (Blocks::default(), Blocks::default());
        for replicate in 0..REPLICATES as u64 {
            let mut rng = numbers(replicate);
            by_slope.add(|| {
                let starts = SlopeSampler::new(&index, &field, light, &mut rng);
                let flux = starts.flux_fraction(BLOCK);
                let (mut together, mut places) = (BatchedStarts::default(), Vec::new());
                together.add(&starts, BLOCK, rng);
                together.each(&index, &field, |_, place| places.push(place));
                arrivals(&over, view, &places, flux)
            });
            above.add(|| {
                let mut places = Vec::new();
                let lost = FromAbove::new(over, light).each(BLOCK, &mut numbers(1000 + replicate), |place| {
                    places.push(place);
                });
                assert_eq!(lost, 0);
                arrivals(&over, view, &places, 1.0 / BLOCK as f64)
            });
        }
        report(theta, &by_slope, &above);
    }
}

fn report(theta: f64, by_slope: &Blocks, above: &Blocks) {
    let bins: Vec<[(f64, f64); 2]> = (0..BINS.0 * BINS.1)
        .map(|bin| [by_slope.mean_and_variance(bin), above.mean_and_variance(bin)])
        .collect();
    let peak = bins.iter().fold(0.0f64, |peak, [(mean, _), _]| peak.max(*mean));
    let counted: Vec<_> = bins.iter().filter(|[(mean, _), _]| *mean > COUNTED_ABOVE * peak).collect();
    let mut ratios: Vec<f64> = counted.iter().map(|[(_, slope), (_, above)]| above / slope).collect();
    ratios.sort_by(f64::total_cmp);
    let (time, variance) = (above.seconds / by_slope.seconds, ratios[ratios.len() / 2]);
    let t = |[(a, a_variance), (b, b_variance)]: &[(f64, f64); 2]| {
        ((a - b) / ((a_variance + b_variance) / REPLICATES as f64).sqrt()).abs()
    };
    let largest = counted.iter().map(|bin| t(bin)).fold(0.0, f64::max);
    println!(
        "{theta:>7}  {:>4}  {time:>4.2}  {variance:>8.2}  {:>22.2}  {largest:>24.2}",
        counted.len(),
        time * variance
    );
}
