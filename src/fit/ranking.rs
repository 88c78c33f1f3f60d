//! Which model is best, and which are as good: differences between models, realisation by realisation.
//!
//! Models are ordered by Takeuchi's criterion 2 (D + tr(K H^-1))/c (Takeuchi 1976): the divergence D, what its freedom
//! has gained on these very realisations, both over the scatter c of a bin. Where the noise of bins is independent,
//! the trace over c is the number of parameters and the criterion is Akaike's. The difference between two models is a
//! mean over realisations, since D is linear in the values but for a part that no model sees: its scatter is known.

use super::{FitData, Fitted};
use crate::stats;

/// Where a model stands.
pub(super) struct Ranking {
    /// The criterion.
    pub aic: f64,
    /// How far behind the best.
    pub behind: f64,
    /// Standard error of that.
    pub behind_se: Option<f64>,
    /// Whether the realisations do not distinguish it from the best; `None` where they cannot say.
    pub alike: Option<bool>,
}

/// Squared distance over squared scatter, each bin weighing by its size over the model: 1 for an exact model, but for
/// the parameters; the scatter is pooled over all bins, so few realisations do not make it large.
pub(super) fn chi_square_ratio(data: &FitData, model: &[Vec<f64>]) -> Option<f64> {
    let variance = data.variance.as_ref()?;
    let (mut far, mut scatter) = (0.0, 0.0);
    for (colour, entry) in data.entries() {
        let z = model[colour][entry] + data.floor[colour];
        far += data.size[entry] / z * (data.value[colour][entry] - model[colour][entry]).powi(2);
        scatter += data.size[entry] / z * variance[colour][entry];
    }
    Some(far / scatter).filter(|ratio| ratio.is_finite())
}

/// c of a model: what the scatter of a bin is of z/w, the mean over all bins. Without errors the residuals say it.
pub(super) fn scale(data: &FitData, fit: &Fitted) -> f64 {
    let square = |colour: usize, entry: usize| match &data.variance {
        Some(variance) => variance[colour][entry],
        None => (data.value[colour][entry] - fit.model[colour][entry]).powi(2),
    };
    let over = |(colour, entry): (usize, usize)| {
        square(colour, entry) * data.size[entry] / (fit.model[colour][entry] + data.floor[colour])
    };
    let used = if data.variance.is_some() { 0 } else { fit.params.len() };
    data.entries().map(over).sum::<f64>() / data.len().saturating_sub(used).max(1) as f64
}

/// The places of all fits, in their order.
pub(super) fn places(data: &FitData, fits: &[Fitted]) -> Vec<Ranking> {
    let freedom = |fit: &Fitted, c: f64| {
        fit.spread
            .as_ref()
            .and_then(|spread| spread.optimism)
            .map_or(fit.params.len() as f64, |cost| cost / c)
    };
    let nearest = fits.iter().min_by(|a, b| a.divergence.total_cmp(&b.divergence));
    let known = nearest.filter(|_| data.variance.is_some()).map(|fit| scale(data, fit)).filter(|c| *c > 0.0);
    let count = data.len() as f64;
    let aic = |fit: &Fitted| match known {
        Some(c) => 2.0 * (fit.divergence / c + freedom(fit, c)),
        // Errors of unknown scale: n ln(mean) + 2 k.
        None => {
            count * (2.0 * fit.divergence / count).max(f64::MIN_POSITIVE).ln() + 2.0 * fit.params.len() as f64
        }
    };
    let all: Vec<f64> = fits.iter().map(aic).collect();
    let Some(best) = (0..fits.len()).min_by(|&a, &b| all[a].total_cmp(&all[b])) else { return Vec::new() };
    let place = |k: usize| {
        let behind = all[k] - all[best];
        let behind_se = known.and_then(|c| Some(2.0 * difference_se(data, &fits[k], &fits[best])? / c));
        let limit = |se: f64| stats::student_limit(0.05, data.parts.len() - 1) * se;
        Ranking { aic: all[k], behind, behind_se, alike: behind_se.map(|se| behind <= limit(se)) }
    };
    (0..fits.len()).map(place).collect()
}

/// Standard error of the difference of two divergences: of the mean over realisations of sum w f_k ln(z_other/z_one).
fn difference_se(data: &FitData, one: &Fitted, other: &Fitted) -> Option<f64> {
    if data.parts.len() < 2 {
        return None;
    }
    let ratio = |(colour, entry): (usize, usize)| {
        let z = |fit: &Fitted| fit.model[colour][entry] + data.floor[colour];
        data.size[entry] * (z(other) / z(one)).ln()
    };
    let ratios: Vec<f64> = data.entries().map(ratio).collect();
    let part = |part: &Vec<Vec<f64>>| {
        data.entries().zip(&ratios).map(|((colour, entry), ratio)| part[colour][entry] * ratio).sum::<f64>()
    };
    let all: Vec<f64> = data.parts.iter().map(part).collect();
    stats::mean_and_se(all.into_iter()).1
}
