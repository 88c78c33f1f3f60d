//! The measures of a difference, and how they are shown.

use serde::Serialize;

use crate::validate::model_distance::Estimate;

/// The measures of a difference; null what is not available.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct DifferenceFigures {
    /// Flux-weighted L1 distance relative to B.
    pub l1: Option<f64>,
    /// What noise alone would show.
    pub l1_noise: Option<f64>,
    /// The distance without noise, by the realisations: 0 on average where the tables agree, and so often below 0; null
    /// where neither table has 4 realisations.
    pub l1_difference: Option<f64>,
    /// Below this, `l1_difference` cannot be distinguished from 0: where the tables agree, 95 % of the values are below.
    pub l1_difference_floor: Option<f64>,
    /// Its standard error.
    pub l1_difference_se: Option<f64>,
    /// Lower end of its 95 % interval, its largest bias included. Without realisations l1 - l1_noise: |d| is never larger
    /// than the mean of |d + e|, and never smaller than that less the mean of |e|.
    pub l1_difference_low: Option<f64>,
    /// Upper end; without realisations l1.
    pub l1_difference_high: Option<f64>,
    /// Largest |a - b|/se.
    pub max_t: Option<f64>,
    /// Share of the bins whose 95 % interval of the difference misses 0.
    pub share_outside_95: Option<f64>,
    /// Largest E_n = |a - b|/sqrt(U_a^2 + U_b^2), U the half-widths of the 95 % intervals; of paired tables the half-width of
    /// the difference. Source: ISO 13528:2022, 9.7, by which |E_n| up to 1 is satisfactory.
    pub max_e_n: Option<f64>,
    /// Share of the bins whose E_n is above 1.
    pub share_e_n_above_1: Option<f64>,
}

impl DifferenceFigures {
    /// The same with the distance without noise: by what each realisation adds to it, or between its bounds.
    pub(super) fn with_difference(self, by_part: &[f64]) -> Self {
        let Some((l1, noise)) = self.l1.zip(self.l1_noise) else { return self };
        let found = Estimate::of(by_part, noise);
        let [low, high] = found.and_then(|found| found.interval).unwrap_or([(l1 - noise).max(0.0), l1]);
        DifferenceFigures {
            l1_difference: found.map(|found| found.mean),
            l1_difference_floor: found.map(|found| found.floor),
            l1_difference_se: found.and_then(|found| found.se),
            l1_difference_low: Some(low),
            l1_difference_high: Some(high),
            ..self
        }
    }

    /// What a column shows: the distance without noise, or the floor that it is below; its bounds without realisations.
    pub fn shown(&self) -> String {
        match (self.l1_difference, self.l1_difference_floor, self.l1_difference_low, self.l1_difference_high)
        {
            (Some(found), Some(floor), ..) if found <= floor => format!("< {floor:.5}"),
            (Some(found), ..) => format!("{found:.5}"),
            (None, _, Some(low), Some(high)) => format!("{low:.5} to {high:.5}"),
            _ => "n/a".into(),
        }
    }
}
