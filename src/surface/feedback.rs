//! What the slope remapping learns from round to round, so that the patch *after* the Poisson fit, not only its
//! target, has the wanted slope law.
//!
//! The fit moves every slope a little off its target, and in the mean always to the same side: median lengths by about
//! 0.4 per cent, azimuths towards the grid's diagonal (the two slopes of a facet share a corner). Two corrections
//! take that back: a gain on the wanted length by rank, and a turn of the slope's direction that restores the
//! azimuth harmonics of the Gaussian field that the patch started from, apart for short and for steep slopes. Those
//! have mean 0 and are not flattened further: patches stay independent draws of one law. Of the length error half is
//! taken back: the distance from the wanted law is then 4e-4 to 1.2e-3 (Kolmogorov-Smirnov) at correlations of 16 and 8
//! cells.

use glam::DVec2;

use super::slope_law::SlopeLaw;

/// Rank intervals of the length gain.
const KNOTS: usize = 64;
/// Classes of slope length that have an azimuth correction of their own.
const LENGTH_CLASSES: usize = 8;
/// Highest azimuth harmonic that is flattened.
const HARMONICS: usize = 4;

/// Mean of (cos k psi, sin k psi), k = 1, 2, ..., for each length class.
type Harmonics = [[DVec2; HARMONICS]; LENGTH_CLASSES];

/// The corrections, and what is being observed for the next ones.
pub struct Feedback {
    log_gain: [f64; KNOTS],
    log_length: [Mean; KNOTS],
    turn: Harmonics,
    /// Remembered part of `turn`: the drift that the fit adds in every round.
    drift: Harmonics,
    /// The harmonics of the Gaussian field that the patch started from.
    wanted_azimuth: Option<Harmonics>,
    azimuth: Harmonics,
    observed: [f64; LENGTH_CLASSES],
    rounds: usize,
}

impl Default for Feedback {
    fn default() -> Self {
        Feedback {
            log_gain: [0.0; KNOTS],
            log_length: [Mean::default(); KNOTS],
            turn: Default::default(),
            drift: Default::default(),
            wanted_azimuth: None,
            azimuth: Default::default(),
            observed: Default::default(),
            rounds: 0,
        }
    }
}

#[derive(Default, Clone, Copy)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Feedback {
    /// Notes one facet's slope before remapping; `u` in (0, 1) is the rank of its length.
    pub fn observe(&mut self, slope: DVec2, u: f64) {
        let length = slope.length();
        if length == 0.0 {
            return;
        }
        let knot = &mut self.log_length[(u * KNOTS as f64) as usize];
        knot.sum += length.ln();
        knot.count += 1.0;
        let class = (u * LENGTH_CLASSES as f64) as usize;
        let unit = slope / length;
        let mut power = unit;
        for harmonic in &mut self.azimuth[class] {
            *harmonic += power;
            power = unit.rotate(power);
        }
        self.observed[class] += 1.0;
    }

    /// Turns what was observed into the next corrections; the first time, keeps it as what is to be restored.
    pub fn learn(&mut self, law: SlopeLaw) {
        let azimuth = std::mem::take(&mut self.azimuth);
        let observed = std::mem::take(&mut self.observed);
        let log_length = std::mem::replace(&mut self.log_length, [Mean::default(); KNOTS]);
        let mean = |class: usize, k: usize| azimuth[class][k] / observed[class].max(1.0);
        let Some(wanted) = self.wanted_azimuth else {
            self.wanted_azimuth = Some(std::array::from_fn(|class| std::array::from_fn(|k| mean(class, k))));
            return;
        };
        for (knot, length) in log_length.iter().enumerate().filter(|(_, length)| length.count > 0.0) {
            let error = mean_log_length(law, knot) - length.sum / length.count;
            self.log_gain[knot] = 0.5 * (self.log_gain[knot] + error);
        }
        // The first harmonic is left alone: the mean slope of a torus is 0, and the fit resists.
        for (class, wanted) in wanted.iter().enumerate() {
            for (k, wanted) in wanted.iter().enumerate().skip(1) {
                let error = mean(class, k) - wanted;
                // The first error is what gathered over many rounds; the later ones are what one fit adds.
                if self.rounds > 0 {
                    self.drift[class][k] += 0.4 * error;
                }
                // A fit undoes about half of a turn: 1.6 times the error takes most of it back at once.
                self.turn[class][k] = 1.6 * error + self.drift[class][k];
            }
        }
        self.rounds += 1;
    }

    /// The slope that a facet should get: of length `wanted` (corrected), nearly in its own direction.
    ///
    /// A surplus density of azimuths 2 sum (c_k cos k psi + s_k sin k psi) vanishes, to first order, under
    /// psi -> psi + sum 2/k (c_k sin k psi - s_k cos k psi).
    pub fn target(&self, slope: DVec2, u: f64, wanted: f64) -> DVec2 {
        let length = slope.length();
        if length == 0.0 {
            return slope; // a level facet has no direction to keep
        }
        if self.rounds == 0 {
            return slope * (wanted / length);
        }
        let unit = slope / length;
        let mut power = unit;
        let mut angle = 0.0;
        for (k, c) in self.turn[(u * LENGTH_CLASSES as f64) as usize].iter().enumerate() {
            angle += 2.0 / (k + 1) as f64 * (c.x * power.y - c.y * power.x);
            power = unit.rotate(power);
        }
        DVec2::from_angle(angle).rotate(unit) * (wanted * self.gain(u).exp())
    }

    /// The logarithm of the length gain at rank `u`, linear between the middles of the intervals.
    fn gain(&self, u: f64) -> f64 {
        let place = (u * KNOTS as f64 - 0.5).clamp(0.0, (KNOTS - 1) as f64);
        let low = (place as usize).min(KNOTS - 2);
        let share = place - low as f64;
        self.log_gain[low] * (1.0 - share) + self.log_gain[low + 1] * share
    }
}

/// Mean of the logarithm of the wanted length over rank interval `knot`: the middle of 16 sub-intervals each.
fn mean_log_length(law: SlopeLaw, knot: usize) -> f64 {
    let parts = 16;
    let at =
        |j: usize| law.length_quantile((knot as f64 + (j as f64 + 0.5) / parts as f64) / KNOTS as f64).ln();
    (0..parts).map(at).sum::<f64>() / parts as f64
}
