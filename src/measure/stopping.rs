//! When an incidence has enough: all its samples, the error that was asked for, as much as its patches can give, or the time.
//!
//! With `stop.relative_error` all realisations are looked at together after 1, 2, 4, 8, ... blocks: never a thread or
//! a shard by itself, so that neither changes where a run ends. The squared error is a/n + p^2: a the noise of n
//! blocks, p the patches' own spread, which no number of blocks takes down.

use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::accumulate::fresnel_sums::FresnelSums;
use super::accumulate::tally_flux::TallyFlux;
use crate::campaign::Stop;
use crate::stats;

/// What ended an incidence, or a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StoppedBy {
    /// `stop.samples` are measured.
    Samples,
    /// `stop.relative_error` is reached.
    RelativeError,
    /// The patches' own spread is larger than `stop.relative_error`, and noise is no more than they add.
    PatchLimited,
    /// `stop.seconds` are over.
    Seconds,
}

impl fmt::Display for StoppedBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// The blocks between one look at the errors, or at the clock, and the next.
///
// Tested by `rounds_end_after_1_2_4_8_blocks`.
pub fn rounds(stop: &Stop, blocks: u64) -> impl Iterator<Item = Range<u64>> + use<> {
    let (by_block, by_doubling) = (stop.seconds.is_some(), stop.relative_error.is_some());
    let end_after = move |start: u64| match start {
        _ if by_block => start + 1,
        _ if by_doubling => (2 * start).clamp(1, blocks),
        _ => blocks,
    };
    let next = move |round: &Range<u64>| (round.end < blocks).then(|| round.end..end_after(round.end));
    std::iter::successors(Some(0..end_after(0)), next)
}

/// Whether errors are looked at after so many blocks of `planned`, whatever rounds the clock asks for.
pub fn is_looked_at(blocks: u64, planned: u64) -> bool {
    blocks.is_power_of_two() || blocks == planned
}

/// Median over bins and colours of the relative standard error of the mean over the realisations; bins below 1 % of
/// the colour's peak are left out. `None` with one realisation or without light.
///
/// `sizes` are the bins' projected solid angles. Several materials count together: the pass ends when all have enough
/// light.
// Tested by `the_relative_error_is_that_of_the_bright_bins`.
pub fn relative_error(realisations: &[TallyFlux], sizes: &[f64], sums: &FresnelSums) -> Option<f64> {
    let mut errors = Vec::new();
    for colour in sums.all_colours() {
        let of = |bin: usize, size: f64| {
            let flux = realisations.iter().map(|r| r.single(colour, bin) + r.multiple(sums, colour, bin));
            let (mean, se) = stats::mean_and_se(flux);
            se.map(|se| (mean / size, se / size))
        };
        let bins: Vec<(f64, f64)> =
            sizes.iter().enumerate().map(|(bin, &size)| of(bin, size)).collect::<Option<_>>()?;
        let peak = bins.iter().fold(0.0f64, |peak, &(mean, _)| peak.max(mean));
        errors.extend(bins.iter().filter(|b| b.0 > stats::COUNTED_ABOVE * peak).map(|(mean, se)| se / mean));
    }
    stats::upper_median(&mut errors)
}

/// One incidence on its way to the end.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct IncidenceProgress {
    /// Blocks measured in each realisation.
    pub blocks: u64,
    /// What ended it.
    pub by: Option<StoppedBy>,
    /// The last relative error that was looked at.
    pub relative_error: Option<f64>,
    /// Where the patches are the limit: how many would reach the error.
    pub realisations_needed: Option<u64>,
    /// All looks so far.
    pub looks: Vec<Look>,
    /// The blocks at the last look.
    looked_at: u64,
}

/// One look at an incidence's error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Look {
    /// Blocks in each realisation.
    pub blocks: u64,
    /// The relative error then.
    pub relative_error: f64,
}

impl IncidenceProgress {
    /// After `blocks` blocks of `realisations` patches the relative error is `error`, `wanted` was asked for.
    ///
    /// The incidence ends where it is small enough, and at the knee: where halving the noise again would gain less than
    /// the patches' own spread, and that spread alone is too large.
    // Tested by `an_incidence_ends_at_its_error_or_at_the_knee`.
    pub fn judge(&mut self, blocks: u64, error: Option<f64>, wanted: f64, realisations: u32) {
        let before = self.relative_error.map(|before| (self.looked_at, before));
        (self.looked_at, self.relative_error) = (blocks, error);
        let Some(error) = error else { return };
        self.looks.push(Look { blocks, relative_error: error });
        if error <= wanted {
            self.by = Some(StoppedBy::RelativeError);
        } else if let Some((fewer, before)) = before {
            // From two looks: error^2 = a/n + p^2.
            let noise = (before * before - error * error) / (blocks as f64 / fewer as f64 - 1.0);
            let patches = error * error - noise;
            if patches > wanted * wanted && patches >= noise {
                let needed = f64::from(realisations) * (error / wanted).powi(2);
                self.by = Some(StoppedBy::PatchLimited);
                self.realisations_needed = Some(needed.ceil() as u64);
            }
        }
    }
}

impl IncidenceProgress {
    /// Takes back what was decided after more than `blocks` blocks, or because they were all.
    pub(super) fn rewind(&mut self, blocks: u64) {
        self.looks.retain(|look| look.blocks <= blocks);
        let last = self.looks.last();
        (self.looked_at, self.relative_error) =
            last.map_or((0, None), |look| (look.blocks, Some(look.relative_error)));
        (self.blocks, self.by, self.realisations_needed) = (blocks, None, None);
    }
}

/// What ended a run, from what ended its incidences: the limit that the user can do something about comes first.
pub fn of_run(incidences: impl Iterator<Item = StoppedBy> + Clone) -> StoppedBy {
    let order = [StoppedBy::Seconds, StoppedBy::PatchLimited, StoppedBy::Samples];
    order
        .into_iter()
        .find(|&by| incidences.clone().any(|stop| stop == by))
        .unwrap_or(StoppedBy::RelativeError)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::campaign;
    use crate::measure::accumulate::tally::{Tally, to_units};

    #[test]
    fn rounds_end_after_1_2_4_8_blocks() {
        let stop = |relative_error, seconds| Stop { samples: 1, relative_error, seconds };
        let ends = |stop: Stop, blocks| rounds(&stop, blocks).map(|r| r.end).collect::<Vec<_>>();
        assert_eq!(ends(stop(Some(0.1), None), 11), [1, 2, 4, 8, 11]);
        assert_eq!(ends(stop(Some(0.1), None), 8), [1, 2, 4, 8]);
        assert_eq!(ends(stop(Some(0.1), None), 1), [1]);
        assert_eq!(ends(stop(None, None), 11), [11]);
        assert_eq!(ends(stop(Some(0.1), Some(9.0)), 4), [1, 2, 3, 4]);
        let all: Vec<_> = rounds(&stop(Some(0.1), None), 11).collect();
        assert!(all[0].start == 0 && all.windows(2).all(|w| w[0].end == w[1].start));
    }

    /// Two patches: bin means 0.5, 0.2 and 0.0015, of which the last is below 1 % of the peak; relative errors 0.1/0.5 and
    /// 0, whose upper median is the first.
    #[test]
    fn the_relative_error_is_that_of_the_bright_bins() {
        let text = "name = \"bright\"\nseed = 1\n[surface]\nrealisations = 2\n[surface.mirror]\n[light]\n\
                    theta_i_deg = [0]\nphi_i_deg = [0]\n[sensor.hemisphere]\n[stop]\nsamples = 1\n";
        let campaign = campaign::parse(text, "bright", Path::new("")).expect("a campaign").campaign;
        let sums = FresnelSums::of(&campaign);
        let tally = |flux: [f64; 3]| Tally { single: flux.map(to_units).to_vec(), ..Tally::new(3, &sums) };
        let tallies = [tally([0.4, 0.2, 0.001]), tally([0.6, 0.2, 0.002])];
        let flux = tallies.each_ref().map(|tally| TallyFlux::new(tally, 1));
        let error = relative_error(&flux, &[1.0; 3], &sums).expect("two patches");
        // A handful of roundings.
        assert!((error - 0.2).abs() < 10.0 * f64::EPSILON, "{error}");
        assert_eq!(relative_error(&flux[..1], &[1.0; 3], &sums), None);
    }

    /// Looks at an incidence of 16 patches after 1, 2, 4, ... blocks whose squared error is a/n + p2.
    fn looked_at(a: f64, p2: f64, wanted: f64, looks: u32) -> IncidenceProgress {
        let mut stop = IncidenceProgress::default();
        for blocks in (0..looks).map(|k| 1u64 << k) {
            stop.judge(blocks, Some((a / blocks as f64 + p2).sqrt()), wanted, 16);
            if stop.by.is_some() {
                break;
            }
        }
        stop
    }

    #[test]
    fn an_incidence_ends_at_its_error_or_at_the_knee() {
        // 1/n <= 0.01 from 100 blocks on: after 128.
        let noisy = looked_at(1.0, 0.0, 0.1, 20);
        assert_eq!((noisy.by, noisy.looked_at), (Some(StoppedBy::RelativeError), 128));
        // p^2 = 0.04 is four times too much; 1/n falls below it after 25 blocks: the knee is seen after 32.
        let limited = looked_at(1.0, 0.04, 0.1, 20);
        assert_eq!((limited.by, limited.looked_at), (Some(StoppedBy::PatchLimited), 32));
        // 16 x (1/32 + 0.04)/0.01 = 114.
        assert_eq!(limited.realisations_needed, Some(114));
        assert_eq!(looked_at(1.0, 0.04, 0.1, 3).by, None);
    }

    #[test]
    fn the_run_says_what_the_user_can_change() {
        let of = |all: &[StoppedBy]| of_run(all.iter().copied());
        use StoppedBy::{PatchLimited, RelativeError, Samples, Seconds};
        assert_eq!(of(&[RelativeError, RelativeError]), RelativeError);
        assert_eq!(of(&[RelativeError, Samples]), Samples);
        assert_eq!(of(&[PatchLimited, Samples]), PatchLimited);
        assert_eq!(of(&[Seconds, PatchLimited]), Seconds);
    }
}
