//! The error measures of a table against one model, bin mean against bin mean: noise and model discrepancy apart.
//!
//! With w a bin's projected solid angle, f measured, m the model's bin mean, se the standard error of f over R
//! realisations: l1 = sum |f-m| w / sum m w; l1_noise = sqrt(2/pi)/c4(R) sum se w / sum m w, what noise alone would
//! show; l1_model = max(0, mean_k sum w pull_k (f_k-m) / sum m w), each realisation k with the sharpened sign that the
//! others give the bin (`model_distance`), null for R < 4; l2_model_sq = sum w ((f-m)^2 - se^2)/sum w m^2.
//!
//! Without the realisations l1_model is what is left of l1 by the errors alone, and has no error of its own.

use serde::{Deserialize, Serialize};

use super::model_distance::{self, ErrorsAlone, Estimate, FEWEST};
use crate::stats;

/// Arrivals that the model must give a bin for its t to be judged: the spread of fewer counts is itself a matter of chance,
/// and one arrival where six were to be expected seems certain of itself.
const FEWEST_EXPECTED: f64 = 32.0;

/// The error measures.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Figures {
    /// Flux-weighted L1 distance.
    pub l1: Option<f64>,
    /// Its part that noise explains.
    pub l1_noise: Option<f64>,
    /// What is left.
    pub l1_model: Option<f64>,
    /// Below this, `l1_model` cannot be distinguished from 0: where the model is true, 95 % of the values are below.
    ///
    /// Student's limit times `l1_model_se`; without realisations half of `l1_noise`.
    pub l1_model_floor: Option<f64>,
    /// Standard error of `l1_model` over the realisations; null where they are not known.
    pub l1_model_se: Option<f64>,
    /// Lower end of the 95 % interval of `l1_model`, its largest bias included.
    pub l1_model_low: Option<f64>,
    /// Upper end.
    pub l1_model_high: Option<f64>,
    /// Squared L2 discrepancy with the noise taken off: unbiased, it may be negative.
    pub l2_model_sq: Option<f64>,
}

/// One colour of one incidence.
pub struct IncidenceData<'a> {
    /// Measured.
    pub value: &'a [f32],
    /// Standard errors, -1: not available.
    pub stderr: &'a [f32],
    /// Arrivals.
    pub hits: &'a [u32],
    /// The model.
    pub model: &'a [f64],
    /// Projected solid angles.
    pub size: &'a [f64],
    /// Bins that count in statistics: of a folded pair, one.
    pub counted: &'a [bool],
    /// Realisations.
    pub realisations: usize,
    /// The values of each of them, or of each group; none where they are not known.
    pub parts: Vec<&'a [f32]>,
}

/// What one colour of one incidence shows.
#[derive(Debug, Clone, Default)]
pub struct ColourFigures {
    /// The error measures.
    pub figures: Figures,
    /// The model's flux.
    pub albedo_model: f64,
    /// Largest |t| of the counted bins.
    pub max_t: Option<f64>,
    /// Counted bins whose 95 % interval misses the model.
    pub outside: usize,
    /// Counted bins with an error bar.
    pub bins: usize,
    /// As in [`Comparison`](super::compare::Comparison).
    pub by_part: Vec<f64>,
}

impl IncidenceData<'_> {
    /// The figures of this incidence and colour.
    pub fn figures(&self) -> ColourFigures {
        let known = self.realisations > 1;
        let limit = if known { stats::student_limit(0.05, self.realisations - 1) } else { f64::INFINITY };
        let (mut distance, mut noise, mut flux) = (0.0, 0.0, 0.0);
        let (mut square, mut model_square) = (0.0, 0.0);
        let mut out = ColourFigures::default();
        let errors = (known && self.realisations >= FEWEST).then(|| ErrorsAlone::new(self.realisations));
        let mut left = 0.0;
        for bin in 0..self.value.len() {
            let (f, m, w) = (f64::from(self.value[bin]), self.model[bin], self.size[bin]);
            // A bin that only higher orders reach is empty as well.
            let hit = self.hits[bin] > 0 && f > 0.0;
            // An empty bin is off by its own mean, not by the 1.5 hits that its error bar allows for.
            let se = if hit { f64::from(self.stderr[bin]) } else { f64::from(self.stderr[bin]).min(m) };
            distance += (f - m).abs() * w;
            noise += se * w;
            left += errors.as_ref().map_or(0.0, |errors| w * errors.left((f - m).abs(), se));
            flux += m * w;
            square += w * ((f - m) * (f - m) - if hit { se * se } else { 0.0 });
            model_square += w * m * m;
            // The flux of an arrival is that of the bin over its number.
            let expected = f64::from(self.hits[bin]) * m / f;
            if known && hit && self.counted[bin] && se > 0.0 && expected >= FEWEST_EXPECTED {
                let t = (f - m).abs() / se;
                out.max_t = Some(out.max_t.map_or(t, |max: f64| max.max(t)));
                out.outside += usize::from(t > limit);
                out.bins += 1;
            }
        }
        out.albedo_model = flux;
        if flux > 0.0 {
            let l1 = distance / flux;
            let l1_noise = known
                .then(|| (2.0 / std::f64::consts::PI).sqrt() / stats::c4(self.realisations) * noise / flux);
            if errors.is_some() {
                out.by_part = self.by_part(flux).unwrap_or_else(|| vec![left / flux]);
            }
            let l2_model_sq = known.then_some(square / model_square);
            out.figures = Figures { l1: Some(l1), l1_noise, l2_model_sq, ..Figures::default() }
                .with_model(&out.by_part);
        }
        out
    }

    /// What each realisation adds to `l1_model`.
    fn by_part(&self, flux: f64) -> Option<Vec<f64>> {
        let mut sums = vec![0.0; self.parts.len()];
        for (bin, (m, w)) in self.model.iter().zip(self.size).enumerate() {
            let x: Vec<f64> = self.parts.iter().map(|part| f64::from(part[bin]) - m).collect();
            model_distance::add_products(&x, w / flux, &mut sums);
        }
        (sums.len() >= FEWEST).then_some(sums)
    }
}

impl Figures {
    /// Means of what is available, null where nothing is; and of what each realisation adds.
    pub fn mean<'a>(all: impl Iterator<Item = (&'a Figures, &'a [f64])> + Clone) -> (Figures, Vec<f64>) {
        let mean = |pick: fn(&Figures) -> Option<f64>| {
            let values: Vec<f64> = all.clone().filter_map(|(figures, _)| pick(figures)).collect();
            (!values.is_empty()).then(|| stats::mean(&values))
        };
        let known: Vec<&[f64]> =
            all.clone().map(|(_, parts)| parts).filter(|parts| !parts.is_empty()).collect();
        let count = known.iter().map(|parts| parts.len()).min().unwrap_or(0);
        let of_part = |k: usize| known.iter().map(|parts| parts[k]).sum::<f64>() / known.len() as f64;
        let by_part: Vec<f64> = (0..count).map(of_part).collect();
        let figures = Figures {
            l1: mean(|f| f.l1),
            l1_noise: mean(|f| f.l1_noise),
            l2_model_sq: mean(|f| f.l2_model_sq),
            ..Figures::default()
        };
        (figures.with_model(&by_part), by_part)
    }

    /// The same with `l1_model`, its floor and its interval: of realisations, or of one value without them.
    ///
    /// The mean of several incidences or colours is taken before a negative one is cut off at 0.
    pub(super) fn with_model(self, by_part: &[f64]) -> Figures {
        let Some(found) = self.l1_noise.and_then(|noise| Estimate::of(by_part, noise)) else { return self };
        Figures {
            l1_model: Some(found.mean.max(0.0)),
            l1_model_floor: Some(found.floor),
            l1_model_se: found.se,
            l1_model_low: found.interval.map(|interval| interval[0]),
            l1_model_high: found.interval.map(|interval| interval[1]),
            ..self
        }
    }

    /// The distance with the noise taken off, or the plain one where that is not known, with its key.
    pub fn distance(&self) -> (&'static str, Option<f64>) {
        if self.l1_model.is_some() { ("l1_model", self.l1_model) } else { ("l1", self.l1) }
    }

    /// Whether `l1_model` cannot be distinguished from 0.
    pub fn is_below_floor(&self) -> bool {
        self.l1_model.zip(self.l1_model_floor).is_some_and(|(found, floor)| found < floor)
    }

    /// What a column shows: `l1_model`, or the floor that it is below; `l1` where there is none.
    pub fn shown(&self) -> String {
        match (self.distance().1, self.l1_model_floor) {
            (None, _) => "n/a".into(),
            (Some(_), Some(floor)) if self.is_below_floor() => format!("< {floor:.4}"),
            (Some(found), _) => format!("{found:.4}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::model_distance::MOST_BIAS;
    use super::*;

    const HEIGHT_5: f64 = 1.211_182;

    fn noise_of(found: &ColourFigures) -> f64 {
        found.figures.l1_noise.expect("5 realisations")
    }

    /// One bin of size 1 and model 1, four realisations 2, 2, 2, 4: x = 1, 1, 1, 3. Without the last the others agree:
    /// pull is the bare sign, product 3. Without one of the first: mean 5/3 of 1, 1, 3, error 2/3, z = 2.5, product
    /// pull(2.5) = erf(2.5/(1.8 sqrt 2)) + 6.5 2.5 exp(-6.25/0.72) = 0.835135 + 0.002762 (tables of erf).
    #[test]
    fn each_realisation_takes_its_sign_from_the_others() {
        let parts: [[f32; 1]; 4] = [[2.0], [2.0], [2.0], [4.0]];
        let data = IncidenceData {
            value: &[2.5],
            stderr: &[0.5],
            hits: &[100],
            model: &[1.0],
            size: &[1.0],
            counted: &[true],
            realisations: 4,
            parts: parts.iter().map(|part| &part[..]).collect(),
        };
        let found = data.figures();
        let product = 0.837_894;
        assert!((found.by_part[0] - product).abs() < 1e-6, "{:?}", found.by_part);
        assert!((found.by_part[3] - 3.0).abs() < 1e-12, "{:?}", found.by_part);
        let mean = (3.0 * product + 3.0) / 4.0;
        assert!((found.figures.l1_model.unwrap() - mean).abs() < 1e-6);
        // Standard error of the four products, doubled; t(0.975, 3) = 3.18245.
        let se = 2.0 * (3.0 - product) / 4.0;
        assert!((found.figures.l1_model_floor.unwrap() - 3.182_45 * se).abs() < 1e-4);
        let bias = MOST_BIAS * 0.5 / stats::c4(4);
        assert!((found.figures.l1_model_high.unwrap() - (mean + 3.182_45 * se + bias)).abs() < 1e-4);
        assert_eq!(found.figures.l1_model_low, Some(0.0));
    }

    /// Two bins of size 2 and 1, model 1 and 4, measured 1.5 and 3, errors 0.25 and 0.5, R = 5.
    #[test]
    fn the_error_measures_follow_their_definitions() {
        let data = IncidenceData {
            value: &[1.5, 3.0],
            stderr: &[0.25, 0.5],
            hits: &[100, 100],
            model: &[1.0, 4.0],
            size: &[2.0, 1.0],
            counted: &[true, true],
            realisations: 5,
            parts: vec![],
        };
        let found = data.figures();
        // l1 = (0.5 2 + 1 1)/(1 2 + 4 1) = 1/3; sum se w = 1; c4(5) = 0.939986 (tables).
        let noise = (2.0 / std::f64::consts::PI).sqrt() / 0.939_986 / 6.0;
        assert!((found.figures.l1.unwrap() - 1.0 / 3.0).abs() < 1e-15);
        assert!((found.figures.l1_noise.unwrap() - noise).abs() < 1e-6);
        // t = 2 in both bins: what noise adds, (a exp(-2) (0.25 2 + 0.5 1))/6, a = 1.21118 for 5 values (quadrature by
        // another program), is left out of l1.
        let model = 1.0 / 3.0 - HEIGHT_5 * (-2.0f64).exp() / 6.0;
        assert!((found.figures.l1_model.unwrap() - model).abs() < 1e-5);
        assert_eq!(
            (found.figures.l1_model_floor, found.figures.l1_model_high),
            (Some(0.5 * noise_of(&found)), None)
        );
        // (2 (0.25 - 0.0625) + (1 - 0.25))/(2 + 16).
        assert!((found.figures.l2_model_sq.unwrap() - 1.125 / 18.0).abs() < 1e-15);
        // t = 2 in both bins, t(0.975, 4) = 2.776.
        assert_eq!((found.max_t, found.outside, found.bins), (Some(2.0), 0, 2));
    }

    #[test]
    fn one_realisation_has_no_noise_figures() {
        let data = IncidenceData {
            value: &[1.0],
            stderr: &[-1.0],
            hits: &[1],
            model: &[1.0],
            size: &[1.0],
            counted: &[true],
            realisations: 1,
            parts: vec![],
        };
        let found = data.figures();
        assert_eq!((found.figures.l1, found.figures.l1_noise, found.max_t), (Some(0.0), None, None));
    }
}
