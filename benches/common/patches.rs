//! Patches to time on, and a clock of processor time: other programs' work does not count.

// Each bench uses its own part.
#![allow(dead_code)]

use std::fs;
use std::time::Duration;

use criterion::Criterion;
use criterion::measurement::{Measurement, ValueFormatter, WallTime};
use glam::DVec3;
use gonio::rng::{self, Purpose, StreamId};
use gonio::sphere;
use gonio::surface::{Heightfield, SlopeLaw, Synthesiser};
use rand_pcg::Pcg64Dxsm;

/// Processor time of this thread.
pub struct ProcessorTime(WallTime);

impl Measurement for ProcessorTime {
    type Intermediate = u64;
    type Value = Duration;

    fn start(&self) -> u64 {
        nanoseconds()
    }

    fn end(&self, begin: u64) -> Duration {
        Duration::from_nanos(nanoseconds() - begin)
    }

    fn add(&self, a: &Duration, b: &Duration) -> Duration {
        *a + *b
    }

    fn zero(&self) -> Duration {
        Duration::ZERO
    }

    fn to_f64(&self, value: &Duration) -> f64 {
        self.0.to_f64(value)
    }

    fn formatter(&self) -> &dyn ValueFormatter {
        self.0.formatter()
    }
}

/// First number of the scheduler's account: nanoseconds on the processor.
fn nanoseconds() -> u64 {
    let text = fs::read_to_string("/proc/thread-self/schedstat").expect("Linux accounts for threads");
    text.split(' ').next().and_then(|first| first.parse().ok()).expect("a number of nanoseconds")
}

/// Few samples: each takes milliseconds.
pub fn criterion() -> Criterion<ProcessorTime> {
    let criterion = Criterion::default().with_measurement(ProcessorTime(WallTime));
    let (warm, timed) = (Duration::from_millis(300), Duration::from_secs(2));
    criterion.sample_size(20).warm_up_time(warm).measurement_time(timed).without_plots()
}

/// A stream of numbers.
pub fn numbers(seed: u64) -> Pcg64Dxsm {
    rng::stream(StreamId { seed, purpose: Purpose::Test, realisation: 0, incidence: 0, block: 0 })
}

/// A GGX patch of correlation length 8 cells.
pub fn patch(cells: usize) -> Heightfield {
    Synthesiser::new(SlopeLaw::Ggx, cells, 8.0).patch(&mut numbers(cells as u64))
}

/// A canonical direction at zenith angle `theta_deg` over a surface of roughness `alpha`.
pub fn light(theta_deg: f64, phi_deg: f64, alpha: f64) -> DVec3 {
    let w = sphere::direction_deg(theta_deg, phi_deg);
    DVec3::new(alpha * w.x, alpha * w.y, w.z)
}
