//! Formulas of microfacet theory over columns of numbers.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use gonio::instrument::Region;
use gonio::optics::reflectance::{Field, Reflectance};
use gonio::optics::{FacetAngle, Fresnel};
use gonio::sphere::{direction_deg, sin_cos_deg};
use gonio::theory::smith::visibility;
use gonio::theory::{ArmSide, Masking, Microfacet, Ndf};
use gonio::validate::BinMeans;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;

use crate::failure::on_threads;

/// Rows for which another thread is worth its start.
const ROWS_OF_A_THREAD: usize = 1 << 12;

/// A value, or what is wrong with its arguments.
type Value = Result<f64, String>;

/// What is chosen for all rows.
struct Choice {
    law: String,
    masking: Masking,
    material: String,
    field: Field,
}

/// The value of `quantity` for every row of `columns`: f8 in the machine's order, all of one length.
///
/// Choices: law, masking, material, polarisation. Columns: `alpha_x`, `alpha_y`, the law's parameter, the rotation in
/// degrees; two constants of the material; then angles in degrees. Errors: `ValueError` for what no formula is defined for,
/// in words of the first row that has it.
#[pyfunction]
pub fn evaluate<'py>(
    py: Python<'py>,
    quantity: &str,
    choices: [String; 4],
    columns: Vec<Vec<u8>>,
) -> PyResult<Bound<'py, PyBytes>> {
    let [law, masking, material, polarisation] = choices;
    let formula = formula(quantity).map_err(PyValueError::new_err)?;
    let choice = Choice {
        law,
        masking: masking_of(&masking).map_err(PyValueError::new_err)?,
        material,
        field: field_of(&polarisation).map_err(PyValueError::new_err)?,
    };
    let columns: Vec<Vec<f64>> = columns.iter().map(|bytes| numbers(bytes)).collect();
    let rows = columns.iter().map(Vec::len).min().unwrap_or(0);
    let value = |row: usize| {
        let arguments: Vec<f64> = columns.iter().map(|column| column[row]).collect();
        match arguments.split_first_chunk::<6>() {
            Some((constants, angles)) => formula(&choice, constants, angles),
            None => Err(format!("{} columns", arguments.len())),
        }
    };
    let all = || Ok((0..rows).into_par_iter().map(value).collect::<Vec<Value>>());
    let values = on_threads(py, 1 + rows / ROWS_OF_A_THREAD, all)?;
    let values = values.into_iter().collect::<Result<Vec<f64>, String>>().map_err(PyValueError::new_err)?;
    Ok(PyBytes::new(py, &values.iter().flat_map(|value| value.to_ne_bytes()).collect::<Vec<u8>>()))
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks::<8>().0.iter().map(|chunk| f64::from_ne_bytes(*chunk)).collect()
}

type Formula = fn(&Choice, &[f64; 6], &[f64]) -> Value;

fn formula(quantity: &str) -> Result<Formula, String> {
    Ok(match quantity {
        "ndf" => ndf,
        "smith_lambda" => {
            |choice, constants, angles| side(choice, constants, angles).map(|side| side.lambda())
        }
        "g1" => |choice, constants, angles| side(choice, constants, angles).map(|side| side.g1()),
        "g2" => g2,
        "fresnel" => fresnel,
        "brdf" => brdf,
        "diffuse" => diffuse,
        "btdf" => btdf,
        "bin_mean" => bin_mean,
        _ => return Err(format!("{quantity}: no such quantity")),
    })
}

fn ndf(choice: &Choice, constants: &[f64; 6], angles: &[f64]) -> Value {
    let surface = surface(choice, constants)?;
    let h = surface.to_sample(upper("theta_h", angles)?);
    Ok(surface.ndf.d(h, surface.alpha_x, surface.alpha_y))
}

fn side(choice: &Choice, constants: &[f64; 6], angles: &[f64]) -> Result<ArmSide, String> {
    let surface = surface(choice, constants)?;
    Ok(surface.side(surface.to_sample(upper("theta", angles)?)))
}

fn g2(choice: &Choice, constants: &[f64; 6], angles: &[f64]) -> Value {
    let (surface, [wi, wo]) = (surface(choice, constants)?, pair(angles)?);
    let [i, o] = [wi, wo].map(|w| surface.side(surface.to_sample(w)));
    match choice.masking {
        Masking::None => Ok(1.0),
        masking if i.cos * o.cos > 0.0 => Ok(4.0 * i.cos * o.cos * visibility(masking, &i, &o)),
        _ => Ok(0.0),
    }
}

fn fresnel(choice: &Choice, constants: &[f64; 6], angles: &[f64]) -> Value {
    let theta = within("theta_d", angles.first().copied(), 0.0, 90.0)?;
    let (sin, cos) = sin_cos_deg(theta);
    Ok(reflectance(choice, constants)?.at(FacetAngle { cos, sin2: sin * sin }))
}

fn brdf(choice: &Choice, constants: &[f64; 6], angles: &[f64]) -> Value {
    let (surface, [wi, wo]) = (surface(choice, constants)?, pair(angles)?);
    let grazing = [wi, wo].iter().filter(|w| w.z == 0.0).count();
    if grazing == 2 || grazing == 1 && choice.masking == Masking::None {
        return Err("theta_i and theta_r = 90: the formula has no finite value in the horizon".into());
    }
    let unit = surface.brdf(wi, wo, choice.masking, &Fresnel::Perfect);
    Ok(unit * reflectance(choice, constants)?.at(FacetAngle::of_pair(wi, wo)))
}

fn diffuse(choice: &Choice, constants: &[f64; 6], angles: &[f64]) -> Value {
    let (surface, [wi, wo]) = (surface(choice, constants)?, pair(angles)?);
    if matches!(surface.ndf, Ndf::Grains { .. }) {
        return Err("law = grains: matt grains have no formula".into());
    }
    let Fresnel::Diffuse { albedo } = reflectance(choice, constants)?.fresnel else {
        return Err("albedo is needed".into());
    };
    if wi.z == 0.0 || wo.z == 0.0 {
        return Err("theta_i and theta_r must lie below 90".into());
    }
    Ok(albedo * surface.diffuse(wi, wo, choice.masking))
}

fn btdf(choice: &Choice, constants: &[f64; 6], angles: &[f64]) -> Value {
    let (surface, eta) = (surface(choice, constants)?, clear_eta(choice, constants)?);
    let wi = direction("theta_i", angles, 0.0, 90.0)?;
    let wo = direction("theta_r", angles.get(2..).unwrap_or_default(), 90.0, 180.0)?;
    Ok(surface.btdf(wi, wo, choice.masking, eta))
}

fn bin_mean(choice: &Choice, constants: &[f64; 6], angles: &[f64]) -> Value {
    let surface = surface(choice, constants)?;
    let wi = upper("theta_i", angles)?;
    let &[t1, t2, p1, p2] = angles.get(2..).unwrap_or_default() else {
        return Err("a bin has four edges".into());
    };
    let side = if t1 < 90.0 { [0.0, 90.0] } else { [90.0, 180.0] };
    if !(side[0] <= t1 && t1 < t2 && t2 <= side[1]) {
        return Err(format!("theta_r from {t1} to {t2}: must increase, on one side of 90"));
    }
    if !(p1 < p2 && p2 - p1 <= 360.0 + 1e-9) {
        return Err(format!("phi_r from {p1} to {p2}: must increase, by 360 at most"));
    }
    let region = Region::Rectangle {
        theta: [t1, t2].map(|edge| if edge == 90.0 { FRAC_PI_2 } else { edge.to_radians() }),
        phi: [p1.to_radians(), p2.to_radians()],
    };
    let (means, source) = (BinMeans::new(vec![choice.masking]), [(wi, 1.0)]);
    if t1 >= 90.0 {
        let eta = clear_eta(choice, constants)?;
        return Ok(means.evaluate_through(&surface, &source, &[region], eta)[0].values[0]);
    }
    let reflectance = reflectance(choice, constants)?;
    if let Fresnel::Perfect = reflectance.fresnel {
        return Ok(means.evaluate(&surface, &source, &[region])[0].unit[0]);
    }
    let means = BinMeans { reflectance: Some(reflectance), ..means };
    Ok(means.evaluate(&surface, &source, &[region])[0].schlick[0])
}

fn surface(
    choice: &Choice,
    &[alpha_x, alpha_y, shape, rotation, ..]: &[f64; 6],
) -> Result<Microfacet, String> {
    for (name, alpha) in [("alpha_x", alpha_x), ("alpha_y", alpha_y)] {
        if !(alpha > 0.0 && alpha.is_finite()) {
            return Err(format!("{name} = {alpha}: must be above 0"));
        }
    }
    let ndf = match choice.law.as_str() {
        "ggx" => Ndf::Ggx,
        "beckmann" => Ndf::Beckmann,
        "blinn_phong" if alpha_x * alpha_y <= 1.0 => Ndf::BlinnPhong,
        "blinn_phong" => {
            return Err(format!("alpha = {}: blinn_phong ends at 1", (alpha_x * alpha_y).sqrt()));
        }
        "student_t" if shape >= 2.0 && shape.is_finite() => Ndf::StudentT { gamma: shape },
        "student_t" => return Err(format!("gamma = {shape}: must be 2 or more")),
        "grains" if shape > 0.0 && shape < 1.0 => Ndf::Grains { coverage: shape },
        "grains" => return Err(format!("coverage = {shape}: must lie between 0 and 1")),
        law => return Err(format!("law = {law}: ggx, beckmann, student_t, blinn_phong or grains")),
    };
    let of_grains = matches!(choice.masking, Masking::Grains | Masking::GrainsProduct);
    if of_grains && !matches!(ndf, Ndf::Grains { .. }) {
        return Err(format!("masking = {}: of law = grains alone", choice.masking.name()));
    }
    if !rotation.is_finite() {
        return Err(format!("rotation = {rotation}: must be finite"));
    }
    Ok(Microfacet { ndf, alpha_x, alpha_y, rotation: rotation * PI / 180.0 })
}

fn reflectance(choice: &Choice, &[.., a, b]: &[f64; 6]) -> Result<Reflectance, String> {
    let share = |name: &str| within(name, Some(a), 0.0, 1.0);
    let positive = |name: &str, value: f64| match value >= 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(format!("{name} = {value}: must not be below 0")),
    };
    let fresnel = match choice.material.as_str() {
        "perfect" => Fresnel::Perfect,
        "f0" => Fresnel::Schlick { f0: share("f0")? },
        "albedo" => Fresnel::Diffuse { albedo: share("albedo")? },
        "eta" if a > 0.0 && a.is_finite() => Fresnel::Dielectric { eta: a },
        "eta" => return Err(format!("eta = {a}: must be above 0")),
        _ => {
            let (eta, k) = (positive("eta", a)?, positive("k", b)?);
            if eta + k == 0.0 {
                return Err("eta = 0 and k = 0: no material".into());
            }
            Fresnel::Conductor { eta, k }
        }
    };
    Ok(Reflectance { fresnel, field: choice.field })
}

/// The index of a clear surface, whose light goes through as both polarisations alike.
fn clear_eta(choice: &Choice, constants: &[f64; 6]) -> Result<f64, String> {
    if matches!(choice.masking, Masking::Grains | Masking::GrainsProduct) || choice.law == "grains" {
        return Err("law = grains: what goes through grains has no formula".into());
    }
    match reflectance(choice, constants)? {
        Reflectance { fresnel: Fresnel::Dielectric { eta }, field: Field::Both } if eta != 1.0 => Ok(eta),
        _ => Err("light goes through where eta is given, is not 1, and the light is not polarised".into()),
    }
}

fn pair(angles: &[f64]) -> Result<[DVec3; 2], String> {
    Ok([upper("theta_i", angles)?, upper("theta_r", angles.get(2..).unwrap_or_default())?])
}

/// The direction of the first two angles, on the upper side.
fn upper(name: &str, angles: &[f64]) -> Result<DVec3, String> {
    direction(name, angles, 0.0, 90.0)
}

fn direction(name: &str, angles: &[f64], least: f64, most: f64) -> Result<DVec3, String> {
    let theta = within(name, angles.first().copied(), least, most)?;
    let phi = angles.get(1).copied().unwrap_or(f64::NAN);
    if !phi.is_finite() {
        return Err(format!("phi of {name} = {phi}: must be finite"));
    }
    Ok(direction_deg(theta, phi))
}

fn within(name: &str, value: Option<f64>, least: f64, most: f64) -> Value {
    let value = value.unwrap_or(f64::NAN);
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(format!("{name} = {value}: must lie in [{least}, {most}]"))
    }
}

fn masking_of(name: &str) -> Result<Masking, String> {
    let all = Masking::ALL.into_iter().chain([Masking::Grains, Masking::GrainsProduct]);
    all.clone().find(|masking| masking.name() == name).ok_or_else(|| {
        let names: Vec<&str> = all.map(Masking::name).collect();
        format!("masking = {name}: one of {}", names.join(", "))
    })
}

fn field_of(polarisation: &str) -> Result<Field, String> {
    match polarisation {
        "none" => Ok(Field::Both),
        "s" => Ok(Field::Across),
        "p" => Ok(Field::Along),
        other => Err(format!("polarisation = {other}: none, s or p")),
    }
}
