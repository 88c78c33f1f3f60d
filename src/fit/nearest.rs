//! The law nearest to a table, for a picture of it: one quick fit of each, without errors.

use rayon::prelude::*;

use super::law::FitLaw;
use super::solve::{FitLayout, NEAR, Problem};
use super::{FIRST_PASS, FitData, FitSample, Fitted, fitted, pilot, started};

/// Values of one colour by which the laws are put in order.
const GLANCE: usize = 512;
/// Laws that are fitted to more of them.
const NEAREST: usize = 3;

/// A law at its best parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct NearestLaw {
    /// Its name, masking and shape: `ggx, direction-correlated, alpha 0.299`.
    pub name: String,
    /// Its means over the bins, [colour][incidence * bins + bin].
    pub means: Vec<Vec<f64>>,
}

/// The nearest of `laws`: the three that come nearest to 512 values of each colour are fitted to 2,048. `None` where there are
/// no laws or the table holds no light.
// Tested by `the_quick_fit_finds_the_law_of_its_table` (tests/it/fit.rs).
pub fn nearest(data: &FitData, laws: &[FitLaw]) -> Option<NearestLaw> {
    if laws.is_empty() || data.is_empty() || data.is_dark() {
        return None;
    }
    let few = FitSample::drawn(data, GLANCE);
    let (mut fits, lobe) = started(data, laws, &pilot::pilot(data), &few);
    fits.retain(|fit| fit.divergence.is_finite());
    fits.sort_by(|a, b| a.divergence.total_cmp(&b.divergence));
    fits.truncate(NEAREST);
    if !few.is_whole {
        let sample = FitSample::drawn(data, FIRST_PASS);
        let layout = FitLayout::new(data, &sample, lobe);
        let again = |fit: Fitted| {
            let problem = Problem::new(data, &layout, fit.law);
            let (state, converged) = problem.solve(fit.params, NEAR);
            fitted(&problem, state, converged, &sample)
        };
        fits = fits.into_par_iter().map(again).collect();
    }
    let best = fits.into_iter().min_by(|a, b| a.divergence.total_cmp(&b.divergence))?;
    let layout = FitLayout::new(data, &FitSample::whole(data), lobe);
    let problem = Problem::new(data, &layout, best.law);
    let means = problem.model(&problem.at(best.params.clone()));
    let found = means.iter().flatten().all(|value| value.is_finite());
    found.then(|| NearestLaw { name: name(data, best.law, &best.params[..best.shapes]), means })
}

fn name(data: &FitData, law: FitLaw, shape: &[f64]) -> String {
    let masking = law.masking().map(|masking| masking.replace('_', "-"));
    let values = law.shape_names().into_iter().zip(law.decode(shape, data.rotation));
    let values = values.map(|(name, value)| match name.strip_suffix("_deg") {
        Some(angle) => format!("{angle} {value:.3} degrees"),
        None => format!("{} {value:.3}", name.replace('_', " ")),
    });
    [Some(law.name().replace('_', " ")), masking]
        .into_iter()
        .flatten()
        .chain(values)
        .collect::<Vec<_>>()
        .join(", ")
}
