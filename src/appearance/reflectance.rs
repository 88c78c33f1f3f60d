//! Reflectance factors and colours in the geometries of colorimeters, and along the angles of a metallic finish.

use std::f64::consts::PI;

use rayon::prelude::*;
use serde::Serialize;

use super::colorimetry::{Illuminant, Observer, Tristimulus, lab};
use super::incidence::LightAzimuth;
use super::quantity::Quantity;
use super::reading::Reading;
use super::receptor::Receptor;
use super::samples::TableSamples;

/// Half-angle of the receptors, degrees: of 45:0 in CIE 015:2018.
const HALF_ANGLE_DEG: f64 = 5.0;
/// Bins may be as large as the receptor: its light changes little over it.
const PART: f64 = 1.0;
/// Angles from the mirror direction towards the light of instruments for metallic finishes (ASTM E2194, DIN 6175-2), degrees.
pub const ASPECULAR_DEG: [f64; 5] = [15.0, 25.0, 45.0, 75.0, 110.0];

/// A reflectance in one geometry, and its colours.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reflected {
    /// `45:0`, `0:45`, `8:d`, `45:as15` ..., `mirror`, `hemisphere`.
    pub geometry: String,
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Luminous reflectance factor over the perfect diffuser's; of `8:d` and `hemisphere` the reflectance.
    pub factor: Quantity,
    /// Its colours by observer and light; none where the table's colours do not say them.
    pub colours: Vec<Colour1976>,
}

/// A colour: X, Y, Z (100: perfect diffuser) and L*, a*, b* with standard errors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Colour1976 {
    /// Of whose eyes, degrees.
    pub observer: Observer,
    /// Under which light.
    pub illuminant: Illuminant,
    /// X, Y, Z.
    pub xyz: [f64; 3],
    /// Their standard errors; null without realisations.
    pub xyz_se: [Option<f64>; 3],
    /// L*, a*, b*.
    pub lab: [f64; 3],
    /// Their standard errors.
    pub lab_se: [Option<f64>; 3],
}

/// Reflectance factors of 45:0, 0:45, 8:d, of multi-angle instruments, and along theta_i in the mirror direction and of the
/// whole hemisphere.
///
/// R = pi (integral of f share cos)/(integral of share cos). 0:45 takes the ring from 40 to 50 degrees (0:45a); 45:0 the light
/// of the table's azimuth alone, which an isotropic table has averaged; 8:d is 8:di, the mirror direction included, and d:8
/// by reciprocity.
// Tested by `a_lambert_table_has_the_closed_forms` (tests/it/appearance/readings.rs).
pub fn reflectance(samples: &TableSamples, light: &LightAzimuth) -> Vec<Reflected> {
    let mirror = light.mirror_phi_deg();
    let of = |geometry: &str, theta_i_deg: f64, receptor: &(dyn Fn(f64) -> Receptor + Sync)| {
        let factor = |theta: f64, incidence: usize| {
            let reading = Reading::new(samples.table, incidence, &receptor(theta), PART)?;
            let measure = reading.measure;
            Ok(reading.scaled(PI / measure))
        };
        reflected(samples, (geometry.into(), theta_i_deg), light.at(theta_i_deg, factor))
    };
    let all = |geometry: &str, theta_i_deg: f64| {
        let reading = light.at(theta_i_deg, |_, incidence| Reading::of_all(samples.table, incidence));
        reflected(samples, (geometry.into(), theta_i_deg), reading)
    };
    let mut found = vec![
        of("45:0", 45.0, &|_| Receptor::cone([0.0, mirror], HALF_ANGLE_DEG)),
        of("0:45", 0.0, &|_| Receptor::ring(45.0 - HALF_ANGLE_DEG, 45.0 + HALF_ANGLE_DEG)),
        all("8:d", 8.0),
    ];
    found.extend(ASPECULAR_DEG.map(|off| {
        of(&format!("45:as{off}"), 45.0, &|theta| Receptor::cone([theta - off, mirror], HALF_ANGLE_DEG))
    }));
    let mirror_at = |at: f64| Receptor::cone([at, mirror], HALF_ANGLE_DEG);
    found.par_extend(light.incidences.par_iter().map(|incidence| of("mirror", incidence.0, &mirror_at)));
    found.par_extend(light.incidences.par_iter().map(|incidence| all("hemisphere", incidence.0)));
    found
}

fn reflected(
    samples: &TableSamples,
    (geometry, theta_i_deg): (String, f64),
    reading: Result<Reading, String>,
) -> Reflected {
    let none = |why: String| Reflected {
        geometry: geometry.clone(),
        theta_i_deg,
        factor: Quantity::missing(why),
        colours: Vec::new(),
    };
    let reading = match reading {
        Ok(reading) => reading,
        Err(why) => return none(why),
    };
    let scale = &samples.scale;
    let numbers = |values: &[f64]| {
        let of = |seen: &Tristimulus| {
            let xyz = seen.weights.each_ref().map(|w| values.iter().zip(w).map(|(v, w)| v * w).sum::<f64>());
            [xyz, lab(xyz, seen.white)].concat()
        };
        let colours = scale.tristimulus.iter().flat_map(of);
        std::iter::once(samples.luminance(values, 0)).chain(colours).collect()
    };
    let mut found = match samples.quantities(&[&reading], numbers) {
        Ok(found) => found.into_iter(),
        Err(why) => return none(why),
    };
    let factor = found.next().unwrap_or_default();
    let rest: Vec<Quantity> = found.collect();
    let colour = |(seen, six): (&Tristimulus, &[Quantity])| {
        let [x, l] = [&six[..3], &six[3..]];
        let values = |three: &[Quantity]| three.iter().map(|q| q.value).collect::<Option<Vec<f64>>>();
        let (xyz, lab) = (values(x)?, values(l)?);
        Some(Colour1976 {
            observer: seen.observer,
            illuminant: seen.illuminant,
            xyz: [xyz[0], xyz[1], xyz[2]],
            xyz_se: [0, 1, 2].map(|k| x[k].se),
            lab: [lab[0], lab[1], lab[2]],
            lab_se: [0, 1, 2].map(|k| l[k].se),
        })
    };
    let colours = scale.tristimulus.iter().zip(rest.chunks(6)).filter_map(colour).collect();
    Reflected { geometry, theta_i_deg, factor, colours }
}
