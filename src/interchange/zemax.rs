//! Zemax tabular BSDF: isotropic, one channel, angles about the mirror direction.
//!
//! For each incidence a table over (azimuth, radial): radial is the angle from the mirror direction, azimuth 0 points
//! from it towards the normal. Before each, TIS, the directional albedo. Source: Zemax's pages on the tabular format.

use std::fmt::Write;

use glam::DVec3;

use super::{Brdf, Colour, Lookup, Reason};
use crate::sphere;

/// How the values are meant.
pub const CONVENTION: &str = "PlaneSymmetrical, degrees about the mirror direction (radial the angle from it, azimuth 0 \
    towards the normal); BRDF in 1/sr, no cosine; TIS the directional albedo; values at directions, no aperture";

const AZIMUTHS: usize = 37;
const RADIALS: usize = 91;
/// More numbers in a list than any file has.
const LONGEST: usize = 10_000;

/// The mirror direction of light at `theta` in the plane of x and z, the direction towards the normal, and across.
fn frame(theta: f64) -> [DVec3; 3] {
    let (sin, cos) = theta.sin_cos();
    [DVec3::new(-sin, 0.0, cos), DVec3::new(cos, 0.0, sin), DVec3::Y]
}

/// Denser near the mirror direction: 180 (k/90)^2 degrees.
fn radials_deg() -> Vec<f64> {
    (0..RADIALS).map(|k| 180.0 * (k as f64 / (RADIALS - 1) as f64).powi(2)).collect()
}

fn azimuths_deg() -> Vec<f64> {
    (0..AZIMUTHS).map(|k| 5.0 * k as f64).collect()
}

/// The text of a file of an isotropic table with one colour.
pub fn write(lookup: &Lookup) -> Reason<String> {
    if !lookup.is_isotropic() {
        return Err("the table is anisotropic, and the tabular model takes one SampleRotation; measure with azimuth = \
                    \"relative\", or export to ssdd, rgl or tensor_tree"
            .into());
    }
    let listed = |list: &[f64]| list.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let light: Vec<f64> = lookup.theta_i().iter().map(|t| (t.to_degrees() * 1e9).round() / 1e9).collect();
    let mut text = String::from(
        "# written by gonio\nSource  Measured\nSymmetry  PlaneSymmetrical\nSpectralContent  Monochrome\n",
    );
    text += "ScatterType  BRDF\nSampleRotation  1\n0\n";
    text += &format!("AngleOfIncidence  {}\n{}\n", light.len(), listed(&light));
    text += &format!("ScatterAzimuth  {AZIMUTHS}\n{}\n", listed(&azimuths_deg()));
    text += &format!("ScatterRadial  {RADIALS}\n{}\n\nMonochrome\nDataBegin\n", listed(&radials_deg()));
    for &theta in lookup.theta_i() {
        let (wi, [mirror, up, across]) = (sphere::direction(theta, 0.0), frame(theta));
        text += &format!("TIS {:.6}\n", albedo(lookup, wi));
        for azimuth in azimuths_deg() {
            let (sin_a, cos_a) = sphere::sin_cos_deg(azimuth);
            for radial in radials_deg() {
                let (sin_r, cos_r) = sphere::sin_cos_deg(radial);
                let wo = cos_r * mirror + sin_r * (cos_a * up + sin_a * across);
                let value = if wo.z > 0.0 { lookup.brdf(wi, wo)[0] } else { 0.0 };
                write!(text, "{value:.6e} ").map_err(|e| e.to_string())?;
            }
            text.push('\n');
        }
    }
    Ok(text + "DataEnd\n")
}

/// Integral of f cos over the hemisphere, midpoints in (sin^2 theta, phi).
fn albedo(lookup: &Lookup, wi: DVec3) -> f64 {
    let (rows, columns) = (180, 180);
    let value = |k: usize| {
        let s = (0.5 + (k / columns) as f64) / rows as f64;
        let (sin, cos) = (std::f64::consts::TAU * (0.5 + (k % columns) as f64) / columns as f64).sin_cos();
        lookup.brdf(wi, DVec3::new(s.sqrt() * cos, s.sqrt() * sin, (1.0 - s).sqrt()))[0]
    };
    (0..rows * columns).map(value).sum::<f64>() * std::f64::consts::PI / (rows * columns) as f64
}

/// A file as a function: linear between its angles.
pub struct Zemax {
    light: Vec<f64>,
    azimuths: Vec<f64>,
    radials: Vec<f64>,
    values: Vec<f32>,
}

/// Reads a file of one rotation and one channel.
pub fn read(bytes: &[u8]) -> Reason<Zemax> {
    let text = std::str::from_utf8(bytes).map_err(|_| "not a text in UTF-8")?;
    let mut words =
        text.lines().filter(|line| !line.starts_with('#')).flat_map(str::split_whitespace).peekable();
    let mut lists: [Vec<f64>; 4] = Default::default();
    const KEYS: [&str; 4] = ["SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial"];
    loop {
        let Some(word) = words.next() else { return Err("no DataBegin: not a Zemax BSDF".into()) };
        match word {
            "DataBegin" => break,
            "Symmetry" if words.peek() != Some(&"PlaneSymmetrical") => {
                return Err("Symmetry PlaneSymmetrical needed".into());
            }
            "SpectralContent" if words.peek() != Some(&"Monochrome") => {
                return Err("SpectralContent Monochrome needed".into());
            }
            "ScatterType" if words.peek() != Some(&"BRDF") => return Err("ScatterType BRDF needed".into()),
            _ => {}
        }
        if let Some(k) = KEYS.iter().position(|key| *key == word) {
            let count = words
                .next()
                .and_then(|word| word.parse::<usize>().ok())
                .filter(|n| (1..=LONGEST).contains(n));
            let count =
                count.ok_or_else(|| format!("{word}: a number of angles from 1 to {LONGEST} needed"))?;
            lists[k] = (0..count).map(|_| number(words.next())).collect::<Reason<Vec<f64>>>()?;
            if lists[k].windows(2).any(|pair| pair[0] >= pair[1]) {
                return Err(format!("{word}: the angles do not increase"));
            }
        }
    }
    let [rotations, light, azimuths, radials] = lists;
    if rotations.len() > 1 || light.is_empty() || azimuths.len() < 2 || radials.len() < 2 {
        return Err("one rotation, and at least one incidence, two azimuths and two radials needed".into());
    }
    let mut values = Vec::new();
    for _ in 0..light.len() {
        if words.next() != Some("TIS") {
            return Err("TIS needed before the values of each incidence".into());
        }
        number(words.next())?;
        for _ in 0..azimuths.len() * radials.len() {
            values.push(number(words.next())?.max(0.0) as f32);
        }
    }
    if words.next() != Some("DataEnd") {
        return Err("DataEnd needed behind the values".into());
    }
    Ok(Zemax { light, azimuths, radials, values })
}

fn number(word: Option<&str>) -> Reason<f64> {
    let value = word.and_then(|word| word.parse::<f32>().ok()).filter(|value| value.is_finite());
    value.map(f64::from).ok_or_else(|| "a finite number is missing".into())
}

/// The interval that holds x and the place in it; outside, the end.
fn interval(nodes: &[f64], x: f64) -> (usize, f64) {
    if nodes.len() < 2 {
        return (0, 0.0);
    }
    let k = nodes.partition_point(|&node| node <= x).clamp(1, nodes.len() - 1) - 1;
    (k, ((x - nodes[k]) / (nodes[k + 1] - nodes[k])).clamp(0.0, 1.0))
}

impl Zemax {
    /// Incidences, degrees.
    pub fn theta_i_deg(&self) -> Vec<f64> {
        self.light.clone()
    }
}

impl Brdf for Zemax {
    fn colours(&self) -> usize {
        1
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let (theta, phi) = (sphere::theta(wi), sphere::phi(wi));
        let [mirror, up, across] = frame(theta);
        let out = sphere::turned(wo, (-phi.sin(), phi.cos()));
        let local = DVec3::new(out.dot(up), out.dot(across), out.dot(mirror));
        // The plane of incidence is a mirror: azimuths beyond half a turn are those before it.
        let azimuth = sphere::phi(local).to_degrees();
        let (a, x) = interval(&self.azimuths, if azimuth > 180.0 { 360.0 - azimuth } else { azimuth });
        let (r, y) = interval(&self.radials, sphere::theta(local).to_degrees());
        let (l, z) = interval(&self.light, theta.to_degrees());
        let mut sum = 0.0;
        for corner in 0..8 {
            let (dl, da, dr) = (corner & 1, corner >> 1 & 1, corner >> 2);
            let side = |step: usize, f: f64| if step == 1 { f } else { 1.0 - f };
            let weight = side(dl, z) * side(da, x) * side(dr, y);
            if weight > 0.0 {
                let at = ((l + dl) * self.azimuths.len() + a + da) * self.radials.len() + r + dr;
                sum += weight * f64::from(self.values[at]);
            }
        }
        [sum; 3]
    }
}
