//! Blocks measured by two ways, and what they say of time and variance.

use glam::DVec3;
use gonio::measure::cost::cpu_seconds;

/// Rows of the polar angle and columns of the azimuth.
const BINS: (usize, usize) = (18, 36);
/// Bins below this fraction of the peak do not count.
const COUNTED_ABOVE: f64 = 0.01;

/// The bins that blocks of samples fill: seconds of processor time, and the flux of each block.
#[derive(Default)]
pub struct Blocks {
    seconds: f64,
    bins: Vec<Vec<f64>>,
}

impl Blocks {
    /// One more block: `block` calls its argument with every arrival, a direction and its flux.
    pub fn add(&mut self, block: impl FnOnce(&mut dyn FnMut(DVec3, f64))) {
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

/// The heading of what [`compared`] says.
pub const HEADING: &str = "bins  time  variance  time to an equal error  largest |t| of the means";

/// Time and median variance of the second way over those of the first.
pub fn compared(first: &Blocks, second: &Blocks) -> String {
    let replicates = first.bins.len() as f64;
    let bins: Vec<[(f64, f64); 2]> = (0..BINS.0 * BINS.1)
        .map(|bin| [first.mean_and_variance(bin), second.mean_and_variance(bin)])
        .collect();
    let peak = bins.iter().fold(0.0f64, |peak, [(mean, _), _]| peak.max(*mean));
    let counted: Vec<_> = bins.iter().filter(|[(mean, _), _]| *mean > COUNTED_ABOVE * peak).collect();
    let mut ratios: Vec<f64> = counted.iter().map(|[(_, first), (_, second)]| second / first).collect();
    ratios.sort_by(f64::total_cmp);
    let (time, variance) = (second.seconds / first.seconds, ratios[ratios.len() / 2]);
    let t = |[(a, a_variance), (b, b_variance)]: &[(f64, f64); 2]| {
        ((a - b) / ((a_variance + b_variance) / replicates).sqrt()).abs()
    };
    let largest = counted.iter().map(|bin| t(bin)).fold(0.0, f64::max);
    let product = time * variance;
    format!("{:>4}  {time:>4.2}  {variance:>8.2}  {product:>22.2}  {largest:>24.2}", counted.len())
}
