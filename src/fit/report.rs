//! What a fit says: parameters under their names, both kinds of errors, distances and the ranking.

use nalgebra::DMatrix;
use serde::{Serialize, Serializer, ser::SerializeMap};

use super::law::{Amplitudes, Law};
use super::{Data, Fitted};

/// Step of the differences by which errors of logarithms become errors of what is reported.
const STEP: f64 = 1e-6;

/// Named numbers in their order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parameters(pub Vec<(String, Option<f64>)>);

impl Parameters {
    /// The number of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(known, _)| known == name).and_then(|(_, value)| *value)
    }
}

impl Serialize for Parameters {
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
    pub law: Law,
    /// Law of the normals, or the model's name.
    pub model: &'static str,
    /// The masking; null where the model has none.
    pub masking: Option<&'static str>,
    /// Whether two roughnesses and a rotation were fitted.
    pub anisotropic: bool,
    /// What came out.
    pub parameters: Parameters,
    /// Jackknife over realisations; least squares where there are none.
    pub standard_errors: Parameters,
    /// From the bins' errors alone: too small where the model is not the truth.
    pub standard_errors_least_squares: Parameters,
    /// Over realisations; null where they are not known.
    pub standard_errors_jackknife: Option<Parameters>,
    /// Sum of squared residuals per degree of freedom; null where the table has no errors.
    pub chi2_per_dof: Option<f64>,
    /// Flux-weighted L1 distance, mean over stops and colours.
    pub l1: Option<f64>,
    /// n ln(chi2/n) + 2 k: Akaike's criterion for errors of unknown scale.
    pub aic: f64,
    /// Whether the iteration converged.
    pub converged: bool,
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
    /// By increasing `aic`.
    pub fits: Vec<Fit>,
}

/// Puts a fit into words and numbers.
pub(super) fn fit(data: &Data, fitted: Fitted, jackknife: Option<DMatrix<f64>>) -> Fit {
    let names = names(data, &fitted);
    let values = decoded(data, &fitted, &fitted.params);
    let count = data.len() as f64;
    let dof = count - fitted.params.len() as f64;
    let per_dof = fitted.chi_square / dof;
    // Without errors the residuals themselves say how large they are.
    let unit = if data.has_errors { 1.0 } else { per_dof };
    let named = |numbers: Vec<Option<f64>>| Parameters(names.iter().cloned().zip(numbers).collect());
    let errors = |covariance: &DMatrix<f64>| named(propagated(data, &fitted, covariance));
    let least_squares = match &fitted.covariance {
        Some(covariance) => errors(&(covariance * unit)),
        None => named(vec![None; values.len()]),
    };
    let jackknife = jackknife.as_ref().map(errors);
    Fit {
        law: fitted.law,
        model: fitted.law.name(),
        masking: fitted.law.masking(),
        anisotropic: fitted.law.is_anisotropic(),
        parameters: named(values.into_iter().map(Some).collect()),
        standard_errors: jackknife.clone().unwrap_or_else(|| least_squares.clone()),
        standard_errors_least_squares: least_squares,
        standard_errors_jackknife: jackknife,
        chi2_per_dof: data.has_errors.then_some(per_dof),
        l1: l1(data, &fitted.model),
        aic: count * (fitted.chi_square / count).max(f64::MIN_POSITIVE).ln()
            + 2.0 * fitted.params.len() as f64,
        converged: fitted.converged,
    }
}

/// Best first.
pub(super) fn ranked(data: &Data, mut fits: Vec<Fit>) -> Fits {
    fits.sort_by(|a, b| a.aic.total_cmp(&b.aic));
    Fits { scope: "single", values: data.len(), realisations: data.parts.len(), fits }
}

fn names(data: &Data, fitted: &Fitted) -> Vec<String> {
    let of_colour: &[&str] = match (fitted.law, fitted.law.amplitudes(data.perfect_mirror)) {
        (_, Amplitudes::Fixed) => &[],
        (_, Amplitudes::Schlick) => &["f0"],
        (_, Amplitudes::Two) => &["specular", "diffuse"],
        (Law::Lambert | Law::OrenNayar, _) => &["albedo"],
        _ => &["amplitude"],
    };
    let colours: &[&str] = if data.value.len() == 1 { &[""] } else { &["_r", "_g", "_b"] };
    let amplitudes =
        colours.iter().flat_map(|colour| of_colour.iter().map(move |name| format!("{name}{colour}")));
    fitted.law.shape_names().iter().map(|name| name.to_string()).chain(amplitudes).collect()
}

fn decoded(data: &Data, fitted: &Fitted, params: &[f64]) -> Vec<f64> {
    let (shape, amplitudes) = params.split_at(fitted.shapes);
    [fitted.law.decode(shape, data.rotation), amplitudes.to_vec()].concat()
}

/// sqrt of the diagonal of D C D', D the derivatives of what is reported by what is fitted.
fn propagated(data: &Data, fitted: &Fitted, covariance: &DMatrix<f64>) -> Vec<Option<f64>> {
    let count = fitted.params.len();
    let rows = decoded(data, fitted, &fitted.params).len();
    let mut derivative = DMatrix::zeros(rows, count);
    for column in 0..count {
        let moved = |step: f64| {
            let mut params = fitted.params.clone();
            params[column] += step;
            decoded(data, fitted, &params)
        };
        for (row, (up, down)) in moved(STEP).into_iter().zip(moved(-STEP)).enumerate() {
            derivative[(row, column)] = (up - down) / (2.0 * STEP);
        }
    }
    let spread = &derivative * covariance * derivative.transpose();
    let known = |k: usize| k >= fitted.shapes || !fitted.law.is_degenerate(&fitted.params[..fitted.shapes]);
    (0..rows).map(|k| Some(spread[(k, k)].sqrt()).filter(|se| se.is_finite() && known(k))).collect()
}

/// Mean over stops and colours of sum |f - m| w/sum m w.
fn l1(data: &Data, model: &[Vec<f64>]) -> Option<f64> {
    let bins = data.grid.bins();
    let mut distances = Vec::new();
    for (value, model) in data.value.iter().zip(model) {
        for stop in 0..data.grid.stops() {
            let here = stop * bins..(stop + 1) * bins;
            let sum = |of: &dyn Fn(usize) -> f64| here.clone().map(|k| of(k) * data.size[k]).sum::<f64>();
            let flux = sum(&|k| model[k]);
            if flux > 0.0 {
                distances.push(sum(&|k| (value[k] - model[k]).abs()) / flux);
            }
        }
    }
    (!distances.is_empty()).then(|| crate::stats::mean(&distances))
}
