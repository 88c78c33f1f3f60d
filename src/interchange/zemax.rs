//! Zemax tabular BSDF: one channel, angles about the mirror direction; isotropic, or a table for each rotation of the
//! sample.
//!
//! For each rotation and incidence a table over (azimuth, radial): radial is the angle from the mirror direction, azimuth 0 points
//! from it towards the normal. Before each, TIS, the directional albedo. Source: Zemax's pages on the tabular format.

use std::fmt::Write;

use glam::DVec3;
use rayon::prelude::*;

use super::{Brdf, Colour, Lookup, Reason};
use crate::sphere;

/// How the values are meant.
pub const CONVENTION: &str = "degrees about the mirror direction (radial the angle from it, azimuth 0 towards the normal, \
    counter-clockwise); BRDF in 1/sr, no cosine; TIS the directional albedo; values at directions, no aperture; \
    isotropic: PlaneSymmetrical; else ASymmetrical4D, SampleRotation the sample's turn counter-clockwise under a lamp at \
    azimuth 0 (light at phi_i is the rotation 360 - phi_i)";

/// Steps of the azimuth, degrees.
const STEP: f64 = 5.0;
const RADIALS: usize = 91;
/// More numbers in a list than any file has.
const LONGEST: usize = 10_000;
/// The widest step between rotations that is interpolated over, degrees.
const WIDEST_GAP: f64 = 46.0;

/// The mirror direction of light at `theta` in the plane of x and z, the direction towards the normal, and across.
fn frame(theta: f64) -> [DVec3; 3] {
    let (sin, cos) = theta.sin_cos();
    [DVec3::new(-sin, 0.0, cos), DVec3::new(cos, 0.0, sin), DVec3::Y]
}

/// Denser near the mirror direction: 180 (k/90)^2 degrees.
fn radials_deg() -> Vec<f64> {
    (0..RADIALS).map(|k| 180.0 * (k as f64 / (RADIALS - 1) as f64).powi(2)).collect()
}

/// Half a turn where the plane of incidence is a mirror, else a whole one, both ends there.
fn azimuths_deg(isotropic: bool) -> Vec<f64> {
    (0..=if isotropic { 36 } else { 72 }).map(|k| STEP * f64::from(k)).collect()
}

/// The rotation of the sample that brings light at this azimuth to 0, and the other way round.
fn rotation_deg(phi_deg: f64) -> f64 {
    sphere::reduced_deg(-phi_deg)
}

/// The text of a file of a table with one colour.
pub fn write(lookup: &Lookup) -> Reason<String> {
    let isotropic = lookup.is_isotropic();
    let listed = |list: &[f64]| list.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let deg = |angle: f64| (angle.to_degrees() * 1e9).round() / 1e9;
    let light: Vec<f64> = lookup.theta_i().iter().map(|&t| deg(t)).collect();
    // Rotations increase: azimuths fall, but for 0.
    let mut order: Vec<usize> = (0..lookup.phi_i().len()).collect();
    let rotation = |k: usize| rotation_deg(deg(lookup.phi_i()[k]));
    order.sort_by(|&a, &b| rotation(a).total_cmp(&rotation(b)));
    let rotations: Vec<f64> = order.iter().map(|&k| rotation(k)).collect();
    let azimuths = azimuths_deg(isotropic);
    let symmetry = if isotropic { "PlaneSymmetrical" } else { "ASymmetrical4D" };
    let mut text = format!(
        "# written by gonio\nSource  Measured\nSymmetry  {symmetry}\nSpectralContent  Monochrome\nScatterType  BRDF\n"
    );
    text += &format!("SampleRotation  {}\n{}\n", rotations.len(), listed(&rotations));
    text += &format!("AngleOfIncidence  {}\n{}\n", light.len(), listed(&light));
    text += &format!("ScatterAzimuth  {}\n{}\n", azimuths.len(), listed(&azimuths));
    text += &format!("ScatterRadial  {RADIALS}\n{}\n\nMonochrome\nDataBegin\n", listed(&radials_deg()));
    let stops: Vec<(usize, usize)> =
        order.iter().flat_map(|&pi| (0..light.len()).map(move |ti| (ti, pi))).collect();
    let blocks: Vec<String> = stops.par_iter().map(|&stop| block(lookup, stop, &azimuths)).collect();
    Ok(text + &blocks.concat() + "DataEnd\n")
}

/// One incidence of one rotation. All directions turn with the light.
fn block(lookup: &Lookup, stop: (usize, usize), azimuths: &[f64]) -> String {
    let (theta, phi) = (lookup.theta_i()[stop.0], lookup.phi_i()[stop.1]);
    let [mirror, up, across] = frame(theta);
    let value = |out: DVec3| lookup.at_stop(stop, phi, sphere::turned(out, phi.sin_cos()))[0];
    let mut text = format!("TIS {:.6}\n", albedo(value));
    for &azimuth in azimuths {
        let (sin_a, cos_a) = sphere::sin_cos_deg(azimuth);
        for radial in radials_deg() {
            let (sin_r, cos_r) = sphere::sin_cos_deg(radial);
            let out = cos_r * mirror + sin_r * (cos_a * up + sin_a * across);
            // Writing into a String does not fail.
            let _written = write!(text, "{:.6e} ", if out.z > 0.0 { value(out) } else { 0.0 });
        }
        text.push('\n');
    }
    text
}

/// Integral of f cos over the hemisphere, midpoints in (sin^2 theta, phi).
fn albedo(value: impl Fn(DVec3) -> f64) -> f64 {
    let (rows, columns) = (90, 90);
    let at = |k: usize| {
        let s = (0.5 + (k / columns) as f64) / rows as f64;
        let (sin, cos) = (std::f64::consts::TAU * (0.5 + (k % columns) as f64) / columns as f64).sin_cos();
        value(DVec3::new(s.sqrt() * cos, s.sqrt() * sin, (1.0 - s).sqrt()))
    };
    (0..rows * columns).map(at).sum::<f64>() * std::f64::consts::PI / (rows * columns) as f64
}

/// A file as a function: linear between its angles.
pub struct Zemax {
    symmetric: bool,
    rotations: Vec<f64>,
    light: Vec<f64>,
    azimuths: Vec<f64>,
    radials: Vec<f64>,
    values: Vec<f32>,
}

/// Reads a file of one channel; several rotations must go round.
pub fn read(bytes: &[u8]) -> Reason<Zemax> {
    let text = std::str::from_utf8(bytes).map_err(|_| "not a text in UTF-8")?;
    let mut words =
        text.lines().filter(|line| !line.starts_with('#')).flat_map(str::split_whitespace).peekable();
    let mut lists: [Vec<f64>; 4] = Default::default();
    let mut symmetric = true;
    const KEYS: [&str; 4] = ["SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial"];
    loop {
        let Some(word) = words.next() else { return Err("no DataBegin: not a Zemax BSDF".into()) };
        match word {
            "DataBegin" => break,
            "Symmetry" => match words.peek() {
                Some(&"PlaneSymmetrical") => symmetric = true,
                Some(&"Asymmetrical" | &"ASymmetrical4D") => symmetric = false,
                _ => return Err("Symmetry PlaneSymmetrical, Asymmetrical or ASymmetrical4D needed".into()),
            },
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
    let [mut rotations, light, azimuths, radials] = lists;
    if rotations.is_empty() {
        rotations.push(0.0);
    }
    if light.is_empty() || azimuths.len() < 2 || radials.len() < 2 {
        return Err("at least one incidence, two azimuths and two radials needed".into());
    }
    let within = |list: &[f64], most: f64| list.iter().all(|angle| (0.0..=most).contains(angle));
    let turn = if symmetric { 180.0 } else { 360.0 };
    if !within(&light, 90.0) || !within(&azimuths, turn) || !within(&radials, 180.0) {
        return Err(format!(
            "an angle lies outside [0, 90] (incidence), [0, {turn}] (azimuth) or [0, 180] (radial)"
        ));
    }
    let gaps = rotations.windows(2).map(|pair| pair[1] - pair[0]);
    let gap = gaps.fold(360.0 - rotations[rotations.len() - 1] + rotations[0], f64::max);
    if rotations.len() > 1 && (symmetric || !within(&rotations, 359.9) || gap > WIDEST_GAP) {
        return Err(format!(
            "several rotations must be asymmetrical and go round in steps of at most {WIDEST_GAP}"
        ));
    }
    let mut values = Vec::new();
    for _ in 0..rotations.len() * light.len() {
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
    Ok(Zemax { symmetric, rotations, light, azimuths, radials, values })
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

    /// Azimuths of the light, degrees; none where the file has one rotation.
    pub fn phi_i_deg(&self) -> Vec<f64> {
        if self.rotations.len() == 1 {
            return vec![];
        }
        let mut phi: Vec<f64> = self.rotations.iter().map(|&rotation| rotation_deg(rotation)).collect();
        phi.sort_by(f64::total_cmp);
        phi
    }

    /// The rotations on both sides of an azimuth of the light and the share of the second.
    fn around(&self, phi_deg: f64) -> ([usize; 2], f64) {
        let (list, at) = (&self.rotations, rotation_deg(phi_deg));
        let above = list.partition_point(|&rotation| rotation <= at);
        let (low, high) = ((above + list.len() - 1) % list.len(), above % list.len());
        let gap = (list[high] - list[low]).rem_euclid(360.0);
        ([low, high], if gap == 0.0 { 0.0 } else { (at - list[low]).rem_euclid(360.0) / gap })
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
        // Where the plane of incidence is a mirror, azimuths beyond half a turn are those before it.
        let azimuth = sphere::phi(local).to_degrees();
        let beyond = self.symmetric && azimuth > 180.0;
        let (a, x) = interval(&self.azimuths, if beyond { 360.0 - azimuth } else { azimuth });
        let (r, y) = interval(&self.radials, sphere::theta(local).to_degrees());
        let (l, z) = interval(&self.light, theta.to_degrees());
        let (turns, t) = self.around(phi.to_degrees());
        let mut sum = 0.0;
        for corner in 0..16 {
            let (dl, da, dr, dt) = (corner & 1, corner >> 1 & 1, corner >> 2 & 1, corner >> 3);
            let side = |step: usize, f: f64| if step == 1 { f } else { 1.0 - f };
            let weight = side(dl, z) * side(da, x) * side(dr, y) * side(dt, t);
            if weight > 0.0 {
                let stop = turns[dt] * self.light.len() + l + dl;
                let at = (stop * self.azimuths.len() + a + da) * self.radials.len() + r + dr;
                sum += weight * f64::from(self.values[at]);
            }
        }
        [sum; 3]
    }
}
