//! What a fit says: parameters under their names, both kinds of errors, distances, the ranking, and what did not fit.

use nalgebra::DMatrix;
use serde::{Serialize, Serializer, ser::SerializeMap};

use super::error_propagation::{apart, decoded, propagated};
use super::law::{Amplitudes, FitLaw};
use super::ranking::{self, Ranking};
use super::solve;
use super::{FitData, Fitted};
use crate::stats;

/// Share of the divergence of a constant BRDF that a model must at least explain.
const HALF: f64 = 0.5;
/// L1 from which on not even the best model is one.
const FAR: f64 = 0.5;
/// Tilts, rad, below which Oren and Nayar's model is Lambert's to 1e-5.
const SMOOTH: f64 = 2e-3;

/// Named things in their order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Named<T>(pub Vec<(String, Option<T>)>);

/// Named numbers.
pub type Parameters = Named<f64>;

impl<T: Copy> Named<T> {
    /// The one of that name.
    pub fn get(&self, name: &str) -> Option<T> {
        self.0.iter().find(|(known, _)| known == name).and_then(|(_, value)| *value)
    }
}

impl<T: Serialize> Serialize for Named<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

/// One model at its best.
#[derive(Debug, Clone, Serialize)]
pub struct Fit {
    /// What was fitted.
    #[serde(skip)]
    pub law: FitLaw,
    /// Law of the normals, or the model's name.
    pub model: &'static str,
    /// The masking; null where the model has none.
    pub masking: Option<&'static str>,
    /// Whether two roughnesses and a rotation were fitted.
    pub anisotropic: bool,
    /// Why the model did not fit; null where it did.
    pub did_not_fit: Option<String>,
    /// What came out. Two roughnesses lie as far apart as they do beyond their noise.
    pub parameters: Parameters,
    /// Parameters on the bound of what they may be: they have no error.
    pub on_bound: Vec<String>,
    /// Jackknife over realisations; from the bins where there are none. One standard error.
    pub standard_errors: Parameters,
    /// From the bins' errors alone (without any: from the residuals): too small where bins are off together.
    pub standard_errors_least_squares: Parameters,
    /// Over realisations; null where they are not known.
    pub standard_errors_jackknife: Option<Parameters>,
    /// Limits that hold the true value in 95 % of all cases: Student's t with R - 1 degrees; null without realisations.
    pub intervals_95: Option<Named<[f64; 2]>>,
    /// Squared residuals over the squared errors, 1 where the model is exact; null where the table has no errors.
    pub chi2_per_dof: Option<f64>,
    /// Flux-weighted L1 distance, mean over incidences and colours; noise included.
    pub l1: Option<f64>,
    /// Takeuchi's criterion; Akaike's for errors of unknown scale where the table has none.
    pub aic: f64,
    /// `aic` less that of the best model.
    pub behind: f64,
    /// Its standard error over realisations; null without them.
    pub behind_se: Option<f64>,
    /// Whether the realisations do not distinguish the model from the best one at 95 %; null without them.
    pub alike: Option<bool>,
    /// Whether the iteration converged.
    pub converged: bool,
    /// Values of one colour that the parameters were fitted to; distances are of all.
    pub fitted_values: usize,
}

/// All fits, best first.
#[derive(Debug, Clone, Serialize)]
pub struct Fits {
    /// What is fitted: order 1.
    pub scope: &'static str,
    /// Values that were fitted.
    pub values: usize,
    /// Realisations left out in turn; 0: their file is absent.
    pub realisations: usize,
    /// Whether the table knows errors of its values.
    pub has_errors: bool,
    /// Those that fit by increasing `aic`, then the others.
    pub fits: Vec<Fit>,
}

impl Fit {
    /// The model with its masking and axes.
    pub fn name(&self) -> String {
        let axes = if self.anisotropic { " with two roughnesses" } else { "" };
        format!("{}{}{axes}", self.model, self.masking.map_or(String::new(), |masking| format!(" {masking}")))
    }
}

/// Puts fits into words and numbers, and in order.
pub(super) fn report(data: &FitData, fitted: Vec<Fitted>) -> Fits {
    let places = ranking::places(data, &fitted);
    let constant = constant(data);
    let far = |fit: &Fitted, place: &Ranking| {
        place.behind > 0.0 && place.alike != Some(true) && fit.divergence > HALF * constant
    };
    let fits = fitted.iter().zip(places).map(|(fit, place)| {
        let far = far(fit, &place);
        one(data, fit, place, far)
    });
    let mut fits: Vec<Fit> = fits.collect();
    fits.sort_by(|a, b| {
        let lost = |fit: &Fit| fit.did_not_fit.is_some();
        lost(a).cmp(&lost(b)).then(a.aic.total_cmp(&b.aic))
    });
    Fits {
        scope: "single",
        values: data.len(),
        realisations: data.parts.len(),
        has_errors: data.variance.is_some(),
        fits,
    }
}

fn one(data: &FitData, fit: &Fitted, place: Ranking, far: bool) -> Fit {
    let names = names(data, fit);
    let dof = data.len().saturating_sub(fit.params.len()).max(1) as f64;
    let spread = fit.spread.as_ref();
    let jackknife = spread.and_then(|spread| spread.jackknife.as_ref());
    let bins = spread.and_then(|spread| spread.fisher.as_ref()).map(|m| m * ranking::scale(data, fit));
    let params = apart(data, fit, jackknife.or(bins.as_ref()));
    let values = decoded(data, fit, &params);
    let on_bound = on_bound(fit, &names);
    let named = |numbers: Vec<Option<f64>>| Named(names.iter().cloned().zip(numbers).collect());
    let errors = |covariance: &DMatrix<f64>| {
        let known = |(error, name): (Option<f64>, &String)| error.filter(|_| !on_bound.contains(name));
        named(propagated(data, fit, &params, covariance).into_iter().zip(&names).map(known).collect())
    };
    let least_squares = bins.as_ref().map_or_else(|| named(vec![None; values.len()]), errors);
    let jackknife = jackknife.map(errors);
    let l1 = l1(data, &fit.model);
    let limit = |se: f64| stats::student_limit(0.05, data.parts.len() - 1) * se;
    let interval = |((name, se), value): (&(String, Option<f64>), &f64)| {
        (name.clone(), se.map(|se| [value - limit(se), value + limit(se)]))
    };
    Fit {
        law: fit.law,
        model: fit.law.name(),
        masking: fit.law.masking(),
        anisotropic: fit.law.is_anisotropic(),
        did_not_fit: why_not(fit, l1, far),
        intervals_95: jackknife.as_ref().map(|se| Named(se.0.iter().zip(&values).map(interval).collect())),
        parameters: named(
            values.into_iter().zip(&names).map(|(v, name)| told(fit, &params, v, name)).collect(),
        ),
        on_bound,
        standard_errors: jackknife.clone().unwrap_or_else(|| least_squares.clone()),
        standard_errors_least_squares: least_squares,
        standard_errors_jackknife: jackknife,
        chi2_per_dof: ranking::chi_square_ratio(data, &fit.model)
            .map(|ratio| ratio * data.len() as f64 / dof),
        l1,
        aic: place.aic,
        behind: place.behind,
        behind_se: place.behind_se,
        alike: place.alike,
        converged: fit.converged,
        fitted_values: fit.values,
    }
}

/// A rotation of equal roughnesses is none.
fn told(fit: &Fitted, params: &[f64], value: f64, name: &str) -> Option<f64> {
    let round = fit.law.is_anisotropic() && params[1] == 0.0 && params[2] == 0.0;
    Some(value).filter(|_| !(round && name == "rotation_deg"))
}

/// Why a model is none of this table; `far`: it explains too little of what a constant leaves.
fn why_not(fit: &Fitted, l1: Option<f64>, far: bool) -> Option<String> {
    // A diffuse surface without roughness is Lambert's: a bound, but no nonsense.
    let ends = match fit.law {
        FitLaw::OrenNayar if fit.params[0] < SMOOTH => vec![],
        // Student's t at either end is GGX or Beckmann.
        law => law.on_bound(&fit.params[..fit.shapes]).into_iter().filter(|name| *name != "gamma").collect(),
    };
    if !fit.converged && ends.is_empty() {
        return Some("the iteration did not converge".into());
    }
    if !ends.is_empty() {
        return Some(format!("{} ran to the bound of what it may be", ends.join(", ")));
    }
    if far {
        return Some("explains less than half of what a constant leaves".into());
    }
    l1.filter(|l1| *l1 > FAR).map(|l1| format!("misses {:.0} % of the light", 100.0 * l1))
}

/// The divergence of the best constant of each colour.
fn constant(data: &FitData) -> f64 {
    let whole: f64 = data.size.iter().sum();
    let mean = |values: &Vec<f64>| values.iter().zip(&data.size).map(|(f, w)| f * w).sum::<f64>() / whole;
    let model: Vec<Vec<f64>> = data.value.iter().map(|values| vec![mean(values); values.len()]).collect();
    solve::divergence(data, &model)
}

fn names(data: &FitData, fitted: &Fitted) -> Vec<String> {
    let of_colour: &[&str] = match (fitted.law, fitted.law.amplitudes(data.perfect_mirror)) {
        (_, Amplitudes::Fixed) => &[],
        (_, Amplitudes::Schlick) => &["f0"],
        (_, Amplitudes::Two) => &["specular", "diffuse"],
        (FitLaw::Lambert | FitLaw::OrenNayar, _) => &["albedo"],
        _ => &["amplitude"],
    };
    let amplitudes =
        data.suffixes.iter().flat_map(|colour| of_colour.iter().map(move |name| format!("{name}{colour}")));
    fitted.law.shape_names().iter().map(|name| name.to_string()).chain(amplitudes).collect()
}

/// Names of what stands on a bound.
fn on_bound(fit: &Fitted, names: &[String]) -> Vec<String> {
    let shape = fit.law.on_bound(&fit.params[..fit.shapes]).into_iter().map(str::to_string);
    let amplitudes = fit.on_bound.iter().filter(|&&k| k >= fit.shapes);
    // Decoded shapes have as many numbers as their parameters.
    shape.chain(amplitudes.map(|&k| names[k].clone())).collect()
}

/// Mean over incidences and colours of sum |f - m| w/sum m w.
fn l1(data: &FitData, model: &[Vec<f64>]) -> Option<f64> {
    let bins = data.grid.bins();
    let mut distances = Vec::new();
    for (value, model) in data.value.iter().zip(model) {
        for incidence in 0..data.grid.incidences() {
            let here = incidence * bins..(incidence + 1) * bins;
            let sum = |of: &dyn Fn(usize) -> f64| here.clone().map(|k| of(k) * data.size[k]).sum::<f64>();
            let flux = sum(&|k| model[k]);
            if flux > 0.0 {
                distances.push(sum(&|k| (value[k] - model[k]).abs()) / flux);
            }
        }
    }
    (!distances.is_empty()).then(|| crate::stats::mean(&distances))
}
