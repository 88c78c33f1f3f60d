//! The rows of a BiRD file: numbers of its variables put side by side, in the table's units.

use std::collections::HashMap;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use super::metadata::ISOTROPIC;
use super::units::Unit;
use crate::error::{ContentError, wrong};
use crate::interchange::Checked;
use crate::interchange::text::samples::key;
use crate::interchange::text::spectral_rows::{LISTED_NM, NO_WAVELENGTH, SpectralRow, whole_nm};
use crate::text_decoding::without_mark;

/// States of polarisation cancel to this.
const UNPOLARISED: f64 = 1e-6;

/// What is read of a file.
#[derive(Deserialize)]
struct BirdFile {
    /// Any of it may be a text such as NA.
    #[serde(default)]
    metadata: Value,
    data: Data,
}

/// The names in a file whose data are of another form.
#[derive(Deserialize)]
struct Names {
    data: HashMap<String, IgnoredAny>,
}

#[derive(Deserialize)]
struct Data {
    theta_i: Option<Variable>,
    phi_i: Option<Variable>,
    theta_r: Option<Variable>,
    phi_r: Option<Variable>,
    #[serde(rename = "BRDF")]
    brdf: Option<Variable>,
    #[serde(rename = "uBRDF")]
    uncertainty: Option<Variable>,
    wavelength_i: Option<Variable>,
    wavelength_r: Option<Variable>,
    polarization_i: Option<Polarisation>,
    polarization_r: Option<Polarisation>,
    adhoc_variables: Option<IgnoredAny>,
    /// Of the drafts of 2021, which list rows.
    variables: Option<IgnoredAny>,
}

#[derive(Deserialize)]
struct Variable {
    #[serde(default)]
    unit: String,
    values: Vec<f64>,
    uncertainty: Option<Constant>,
}

/// An uncertainty that is the same at all values.
#[derive(Deserialize)]
struct Constant {
    value: f64,
    unit: String,
}

#[derive(Deserialize)]
struct Polarisation {
    values: Vec<State>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum State {
    Letter(String),
    Stokes([f64; 4]),
}

/// What a file holds.
pub struct BirdRows {
    /// A value each.
    pub rows: Vec<SpectralRow>,
    /// The file says that the sample is isotropic, and its light has one azimuth.
    pub is_isotropic: bool,
    /// What was chosen, one sentence each.
    pub notes: Vec<String>,
}

/// The rows of a file; values of polarised light are put together where they make unpolarised light.
pub fn rows(bytes: &[u8]) -> Checked<BirdRows> {
    let bytes = without_mark(bytes)?;
    let file: BirdFile = serde_json::from_slice(&bytes).map_err(|e| refusal(&bytes, &e))?;
    let data = file.data;
    let symmetry = file.metadata.pointer("/sample/properties_symmetry").and_then(Value::as_str);
    let brdf = needed("BRDF", data.brdf.as_ref(), data.variables.is_some())?;
    let count = brdf.values.len();
    let of = |name: &'static str, variable: &Option<Variable>, unit: fn(&str) -> Option<Unit>| {
        let variable = needed(name, variable.as_ref(), data.variables.is_some())?;
        numbers(name, variable, unit, count)
    };
    let theta_i = of("theta_i", &data.theta_i, Unit::of_angle)?;
    let phi_i = of("phi_i", &data.phi_i, Unit::of_angle)?;
    let theta_r = of("theta_r", &data.theta_r, Unit::of_angle)?;
    let phi_r = of("phi_r", &data.phi_r, Unit::of_angle)?;
    for (name, angles) in [("theta_i", &theta_i), ("theta_r", &theta_r)] {
        if let Some(at) = angles.iter().position(|theta| !(0.0..=90.0).contains(theta)) {
            return Err(wrong!("value {} of {name}: {} degrees: 0 to 90 needed", at + 1, angles[at]));
        }
    }
    let values = numbers("BRDF", brdf, Unit::of_brdf, count)?;
    let wavelengths = wavelengths(&data, count)?;
    let errors = errors(&data, brdf, &values)?;
    let mut rows = Vec::with_capacity(count);
    for at in 0..count {
        let value = values[at];
        if !(value >= 0.0 && value <= f64::from(f32::MAX)) {
            return Err(wrong!("value {} of BRDF: {value} 1/sr: 0 or more needed", at + 1));
        }
        rows.push(SpectralRow {
            number: at + 1,
            nm: wavelengths.as_ref().map_or(NO_WAVELENGTH, |nm| nm[at]),
            light: [theta_i[at], phi_i[at]],
            sensor: [theta_r[at], phi_r[at]],
            value,
            error: errors.as_ref().map(|errors| errors[at]),
        });
    }
    let mut notes = vec![];
    if data.adhoc_variables.is_some() {
        notes.push("adhoc_variables are not read".to_string());
    }
    if let Some(seen) = &data.polarization_r {
        let states = states("polarization_r", seen, count)?;
        if let Some(at) = states.iter().position(|state| state.iter().any(|part| part.abs() > UNPOLARISED)) {
            return Err(wrong!(
                "value {} of polarization_r: light seen behind a polariser; unpolarised (u) needed",
                at + 1
            ));
        }
    }
    if let Some(light) = &data.polarization_i {
        let states = states("polarization_i", light, count)?;
        if states.iter().flatten().any(|part| part.abs() > UNPOLARISED) {
            rows = unpolarised(&rows, &states)?;
            notes.push(
                "values of unpolarised light: the mean of those of opposite polarisations, which the file has".into(),
            );
        }
    }
    let one_azimuth = rows.iter().all(|row| row.light[1] == rows[0].light[1]);
    let is_isotropic = symmetry.is_some_and(|word| word.trim().eq_ignore_ascii_case(ISOTROPIC));
    if is_isotropic && !one_azimuth {
        notes.push("an isotropic sample under light of several azimuths: read with its azimuths".into());
    }
    Ok(BirdRows { rows, is_isotropic: is_isotropic && one_azimuth, notes })
}

/// Why a file is none: data of BiRD's first files, or what the parser says.
fn refusal(bytes: &[u8], error: &serde_json::Error) -> ContentError {
    let first = ["theta_v", "phi_v", "wavelengths", "pol", "data"];
    let names = serde_json::from_slice(bytes).map_or(HashMap::new(), |Names { data }| data);
    match first.iter().find(|name| names.contains_key(**name)) {
        Some(name) => wrong!(
            "data.{name} is of BiRD's first files: for each variable an object with unit and values needed, as in version 1.0"
        ),
        None => wrong!("no BRDF file of BiRD: {error}"),
    }
}

fn needed<'a>(name: &str, variable: Option<&'a Variable>, is_draft: bool) -> Checked<&'a Variable> {
    variable.ok_or_else(|| match is_draft {
        true => wrong!(
            "data.{name} is missing: data.variables is of a draft of the format; a list of values for each \
             variable needed, as in its version 1.0"
        ),
        false => wrong!("data.{name} is missing: theta_i, phi_i, theta_r, phi_r and BRDF needed"),
    })
}

/// The values of a variable in the table's unit.
fn numbers(
    name: &str,
    variable: &Variable,
    unit: fn(&str) -> Option<Unit>,
    count: usize,
) -> Checked<Vec<f64>> {
    let unit = unit(&variable.unit).ok_or_else(|| {
        let known = Unit::words(unit).join(", ");
        wrong!("data.{name}.unit = {:.40}: {known} needed", variable.unit)
    })?;
    let found = variable.values.len();
    if found != count {
        return Err(wrong!("data.{name} has {found} values, data.BRDF {count}: as many needed"));
    }
    Ok(variable.values.iter().map(|&value| unit.own(value)).collect())
}

/// The light's wavelengths; those of the sensor must be the same.
fn wavelengths(data: &Data, count: usize) -> Checked<Option<Vec<f64>>> {
    let of = |name: &'static str, variable: &Option<Variable>| -> Checked<Option<Vec<f64>>> {
        let Some(variable) = variable else { return Ok(None) };
        let mut all = numbers(name, variable, Unit::of_wavelength, count)?;
        all.iter_mut().for_each(|nm| *nm = whole_nm(*nm));
        match all.iter().position(|nm| !LISTED_NM.contains(nm)) {
            Some(at) => Err(wrong!(
                "value {} of {name}: {} nm: {} to {} needed",
                at + 1,
                all[at],
                LISTED_NM.start(),
                LISTED_NM.end()
            )),
            None => Ok(Some(all)),
        }
    };
    let (light, seen) = (of("wavelength_i", &data.wavelength_i)?, of("wavelength_r", &data.wavelength_r)?);
    if let (Some(light), Some(seen)) = (&light, &seen)
        && let Some(at) = (0..count).find(|&at| light[at] != seen[at])
    {
        return Err(wrong!(
            "value {}: light of {} nm is seen at {} nm: light that keeps its wavelength needed",
            at + 1,
            light[at],
            seen[at]
        ));
    }
    Ok(light.or(seen))
}

/// The standard uncertainty of each value, where the file has one.
fn errors(data: &Data, brdf: &Variable, values: &[f64]) -> Checked<Option<Vec<f64>>> {
    let count = values.len();
    let listed = data.uncertainty.as_ref().map(|listed| (&listed.unit, listed.values.clone()));
    let constant = brdf.uncertainty.as_ref().map(|constant| (&constant.unit, vec![constant.value; count]));
    let Some((unit, mut errors)) = listed.or(constant) else { return Ok(None) };
    if errors.len() != count {
        return Err(wrong!("data.uBRDF has {} values, data.BRDF {count}: as many needed", errors.len()));
    }
    match unit.as_str() {
        "%" => errors.iter_mut().zip(values).for_each(|(error, value)| *error *= 0.01 * value),
        unit if Unit::of_brdf(unit).is_some() => {}
        unit => return Err(wrong!("the unit {unit:.40} of an uncertainty of BRDF: 1/sr, sr^-1 or % needed")),
    }
    match errors.iter().position(|error| !(*error >= 0.0 && *error <= f64::from(f32::MAX))) {
        Some(at) => Err(wrong!("value {}: uncertainty {}: 0 or more needed", at + 1, errors[at])),
        None => Ok(Some(errors)),
    }
}

/// The last three components of each state's normalised Stokes vector.
fn states(name: &str, polarisation: &Polarisation, count: usize) -> Checked<Vec<[f64; 3]>> {
    let found = polarisation.values.len();
    if found != count {
        return Err(wrong!("data.{name} has {found} values, data.BRDF {count}: as many needed"));
    }
    let state = |(at, state): (usize, &State)| match state {
        State::Letter(letter) => match letter.as_str() {
            "s" => Ok([1.0, 0.0, 0.0]),
            "p" => Ok([-1.0, 0.0, 0.0]),
            "u" => Ok([0.0; 3]),
            other => Err(wrong!("value {} of {name}: {other:.20}: s, p or u needed", at + 1)),
        },
        State::Stokes([1.0, rest @ ..]) if rest.iter().all(|part| part.abs() <= 1.0) => Ok(*rest),
        State::Stokes(all) => {
            Err(wrong!("value {} of {name}: {all:?}: 1 and three of -1 to 1 needed", at + 1))
        }
    };
    polarisation.values.iter().enumerate().map(state).collect()
}

/// The mean over the polarisations of each pair of directions and wavelength, which must cancel. Their uncertainties
/// are averaged too, as if they had one cause: no smaller than those of independent ones.
fn unpolarised(rows: &[SpectralRow], states: &[[f64; 3]]) -> Checked<Vec<SpectralRow>> {
    let mut places = HashMap::new();
    let mut sums: Vec<(SpectralRow, [f64; 3], f64)> = Vec::new();
    for (row, state) in rows.iter().zip(states) {
        let place = *places.entry((row.nm.to_bits(), key(row.light), key(row.sensor))).or_insert_with(|| {
            sums.push((SpectralRow { value: 0.0, error: row.error.map(|_| 0.0), ..*row }, [0.0; 3], 0.0));
            sums.len() - 1
        });
        let (sum, polarisation, count) = &mut sums[place];
        sum.value += row.value;
        sum.error = sum.error.zip(row.error).map(|(sum, error)| sum + error);
        polarisation.iter_mut().zip(state).for_each(|(sum, part)| *sum += part);
        *count += 1.0;
    }
    let mean = |(sum, polarisation, count): (SpectralRow, [f64; 3], f64)| {
        if polarisation.iter().any(|part| part.abs() > UNPOLARISED * count) {
            return Err(wrong!(
                "value {}: polarised light without its opposite: unpolarised light, or s and p, needed",
                sum.number
            ));
        }
        Ok(SpectralRow { value: sum.value / count, error: sum.error.map(|error| error / count), ..sum })
    };
    sums.into_iter().map(mean).collect()
}
