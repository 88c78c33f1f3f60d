//! RGL/EPFL `.bsdf`: the adaptive tensor file that Mitsuba's `measured`, powitacq and pbrt read; rgb or spectral,
//! isotropic or anisotropic.
//!
//! A reader maps the half vector through the warp of the visible normals of an auxiliary distribution D and looks up
//! `spectra`; value = spectra D(m)/(4 sigma(wi)) = f cos(theta_o). D and sigma are in the file and need not be those of
//! the material: here the GGX whose slopes have the table's medians, so that `spectra` is smooth.
//! Source: Dupuy and Jakob 2018; layout: Mitsuba 3's `measured`.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::tensor_file::{TensorData, TensorField, TensorFile, encode};
use super::warp::{Slices, Warp, cell};
use crate::interchange::resample::guide::GuideLobe;
use crate::interchange::{Brdf, Colour, Lookup, Reason};
use crate::sphere;

/// How the values are meant.
pub const CONVENTION: &str = "spectra x D(m)/(4 sigma(wi)) is f cos(theta_o): with the cosine, as Mitsuba's eval returns \
    it; angles in radians, wi towards the light, z the normal, x the tangent; values at directions, no aperture";

/// Steps of the light's angles that are wider are divided, rad.
const WIDEST_THETA: f64 = 6.0 * PI / 180.0;
const WIDEST_PHI: f64 = 8.0 * PI / 180.0;
/// The last polar angle of the light, rad: at grazing light the warp has no density left.
const LAST_THETA: f64 = 88.0 * PI / 180.0;
/// Nodes along theta of D and sigma.
const NDF_NODES: usize = 256;
/// Least luminance, so that no slice is 0 throughout.
const LEAST_LUMINANCE: f32 = 1e-6;

fn theta_of(u: f64) -> f64 {
    FRAC_PI_2 * u * u
}

fn u_of_theta(theta: f64) -> f64 {
    (theta / FRAC_PI_2).sqrt()
}

fn phi_of(u: f64) -> f64 {
    (2.0 * u - 1.0) * PI
}

fn u_of_phi(phi: f64) -> f64 {
    let u = (phi + PI) / TAU;
    u - u.floor()
}

/// Nodes of `angles`, and such between them that no step is wider than `widest`.
fn refined(angles: &[f64], widest: f64) -> Vec<f64> {
    let mut nodes = vec![angles[0]];
    for pair in angles.windows(2) {
        let parts = ((pair[1] - pair[0]) / widest - 1e-9).ceil().max(1.0);
        nodes.extend((1..=parts as usize).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / parts));
    }
    nodes
}

/// A square grid's values at bilinear (u_theta, u_phi): columns along theta, rows along phi.
struct Map {
    rows: usize,
    columns: usize,
    values: Vec<f32>,
}

impl Map {
    fn of(rows: usize, columns: usize, value: impl Fn(DVec3) -> f64) -> Self {
        let node = |at: usize| {
            let (row, column) = (at / columns, at % columns);
            let (v, u) = (row as f64 / (rows - 1) as f64, column as f64 / (columns - 1) as f64);
            value(sphere::direction(theta_of(u), phi_of(v))) as f32
        };
        Map { rows, columns, values: (0..rows * columns).map(node).collect() }
    }

    fn at(&self, [u, v]: [f64; 2]) -> f64 {
        let ((column, x), (row, y)) = (cell(u, self.columns), cell(v, self.rows));
        let node = |r: usize, c: usize| f64::from(self.values[(row + r) * self.columns + column + c]);
        (1.0 - y) * ((1.0 - x) * node(0, 0) + x * node(0, 1)) + y * ((1.0 - x) * node(1, 0) + x * node(1, 1))
    }
}

/// One slice and nothing else.
fn only(slice: usize) -> Slices {
    [(slice, 1.0), (slice, 0.0), (slice, 0.0), (slice, 0.0)]
}

/// Polar angles of the light: the table's, no wider apart than 6 degrees, on to 88 degrees.
fn theta_nodes(lookup: &Lookup) -> Vec<f64> {
    let mut theta: Vec<f64> = lookup.theta_i().iter().copied().filter(|&t| t < LAST_THETA).collect();
    if theta.first().is_none_or(|&first| first > 0.0) {
        theta.insert(0, 0.0);
    }
    theta.push(LAST_THETA);
    refined(&theta, WIDEST_THETA)
}

/// Azimuths of the light from -pi to pi, both ends stored; a single 0 where all are alike.
fn phi_nodes(lookup: &Lookup) -> Vec<f64> {
    if lookup.is_isotropic() {
        return vec![0.0];
    }
    let mut phi: Vec<f64> = lookup.phi_i().iter().map(|&p| if p >= PI { p - TAU } else { p }).collect();
    phi.extend([-PI, PI]);
    phi.sort_by(f64::total_cmp);
    phi.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    refined(&phi, WIDEST_PHI)
}

/// The bytes of a file. With increasing `wavelengths_nm`, those of B, G, R (any number for a table of one colour, which
/// has the same value at each), the file is spectral; without them rgb.
///
/// Held by: `rgl_reads_back` (tests/it/interchange/interchange_rgl.rs), and against Mitsuba in tests/interop.
pub fn write(lookup: &Lookup, wavelengths_nm: Option<&[f64]>, description: &str) -> Reason<Vec<u8>> {
    let isotropic = lookup.is_isotropic();
    let (vndf_side, side) = if isotropic { (128, 64) } else { (64, 32) };
    let auxiliary = GuideLobe::of(lookup);
    let rows = if isotropic { 2 } else { NDF_NODES / 2 };
    let ndf = Map::of(rows, NDF_NODES, |m| auxiliary.d(m));
    let sigma = Map::of(rows, NDF_NODES, |w| auxiliary.sigma(w));
    let (theta, phi) = (theta_nodes(lookup), phi_nodes(lookup));
    let slices: Vec<(f64, f64)> = phi.iter().flat_map(|&p| theta.iter().map(move |&t| (p, t))).collect();
    let vndf: Vec<f32> = slices
        .par_iter()
        .flat_map_iter(|&(p, t)| {
            let wi = sphere::direction(t, p);
            Map::of(vndf_side, vndf_side, |m| {
                // In an isotropic file the azimuth counts from the light's, here 0.
                let theta_m = sphere::theta(m);
                m.dot(wi).max(0.0) * auxiliary.d(m) * 2.0 * PI * PI * u_of_theta(theta_m) * theta_m.sin()
            })
            .values
        })
        .collect();
    let warp = Warp::new(vndf_side, vndf_side, vndf.clone())?;
    let channels = wavelengths_nm.map_or(3, <[f64]>::len);
    let (colours, spectral) = (lookup.colours(), wavelengths_nm.is_some());
    let slice = |(index, &(p, t)): (usize, &(f64, f64))| {
        let wi = sphere::direction(t, p);
        let area = 4.0 * sigma.at([u_of_theta(t), u_of_phi(p)]);
        let node = |at: usize| {
            let place =
                [at % side, at / side].map(|k| (k as f64 / (side - 1) as f64).clamp(6e-8, 1.0 - 6e-8));
            let [u, v] = warp.forward(&only(index), place);
            let m = sphere::direction(theta_of(u), phi_of(v));
            let wo = 2.0 * wi.dot(m) * m - wi;
            if wo.z <= 0.0 { [0.0; 3] } else { lookup.brdf(wi, wo).map(|f| f * wo.z * area / ndf.at([u, v])) }
        };
        let nodes: Vec<Colour> = (0..side * side).map(node).collect();
        // Wavelengths increase: blue comes first.
        let colour = |k: usize| if spectral && colours == 3 { 2 - k } else { k.min(colours - 1) };
        let channel = |k: usize| nodes.iter().map(move |node| node[colour(k)] as f32);
        (0..channels).flat_map(channel).collect::<Vec<f32>>()
    };
    let spectra: Vec<f32> = slices.par_iter().enumerate().flat_map_iter(slice).collect();
    let luminance = spectra.chunks(channels * side * side).flat_map(|slice| {
        let mean = move |at: usize| {
            (0..channels).map(|k| slice[k * side * side + at]).sum::<f32>() / channels as f32
        };
        (0..side * side).map(move |at| mean(at).max(LEAST_LUMINANCE))
    });
    let luminance: Vec<f32> = luminance.collect();
    let (np, nt) = (phi.len(), theta.len());
    let axis = |values: &[f64]| TensorData::F32(values.iter().map(|&v| v as f32).collect());
    let mut fields: Vec<TensorField> = vec![
        ("description", vec![description.len()], TensorData::U8(description.bytes().collect())),
        ("jacobian", vec![1], TensorData::U8(vec![1])),
        ("phi_i", vec![np], axis(&phi)),
        ("theta_i", vec![nt], axis(&theta)),
        ("ndf", vec![rows, NDF_NODES], TensorData::F32(ndf.values)),
        ("sigma", vec![rows, NDF_NODES], TensorData::F32(sigma.values)),
        ("vndf", vec![np, nt, vndf_side, vndf_side], TensorData::F32(vndf)),
        ("luminance", vec![np, nt, side, side], TensorData::F32(luminance)),
    ];
    let name = if spectral { "spectra" } else { "rgb" };
    fields.push((name, vec![np, nt, channels, side, side], TensorData::F32(spectra)));
    if let Some(wavelengths_nm) = wavelengths_nm {
        fields.push(("wavelengths", vec![channels], axis(wavelengths_nm)));
    }
    Ok(encode(&fields))
}

/// A file as a function.
pub struct Rgl {
    theta: Vec<f64>,
    phi: Vec<f64>,
    ndf: Map,
    sigma: Map,
    warp: Warp,
    /// [slice][channel][rows][columns].
    spectra: Vec<f32>,
    channels: usize,
    side: [usize; 2],
    /// The channels that stand for the table's colours.
    chosen: Vec<usize>,
    /// What was chosen on reading.
    pub note: Option<String>,
}

/// Wavelengths that stand for R, G and B where a spectral file is read, nm.
const RGB_NM: [f64; 3] = [630.0, 532.0, 465.0];

/// Reads the bytes of a file; anisotropic files must cover the whole turn.
pub fn read(bytes: &[u8]) -> Reason<Rgl> {
    let file = TensorFile::open(bytes)?;
    let axis = |name: &str| -> Reason<Vec<f64>> {
        let values: Vec<f64> = file.f32(name, 1)?.1.into_iter().map(f64::from).collect();
        match values.windows(2).find(|pair| pair[0] >= pair[1]) {
            Some(pair) => Err(format!("field `{name}` does not increase from {} to {}", pair[0], pair[1])),
            None => Ok(values),
        }
    };
    let (theta, phi) = (axis("theta_i")?, axis("phi_i")?);
    let in_range = |values: &[f64], low: f64, high: f64| values.iter().all(|v| (low..=high).contains(v));
    if !in_range(&theta, 0.0, FRAC_PI_2 + 1e-6) || !in_range(&phi, -TAU, TAU) {
        return Err("angles of the light lie outside the hemisphere; radians needed".into());
    }
    if phi.len() > 2 && phi[phi.len() - 1] - phi[0] < TAU - 0.1 {
        return Err(format!(
            "azimuths from {} to {} rad: only files of the whole turn are read",
            phi[0],
            phi[phi.len() - 1]
        ));
    }
    let map = |name: &str| -> Reason<Map> {
        let (sides, values) = file.f32(name, 2)?;
        if sides[0] < 2 || sides[1] < 2 || values.iter().any(|&v| v < 0.0) {
            return Err(format!("field `{name}`: at least 2 x 2 values, none negative, needed"));
        }
        Ok(Map { rows: sides[0], columns: sides[1], values })
    };
    let (ndf, sigma) = (map("ndf")?, map("sigma")?);
    let (sides, vndf) = file.f32("vndf", 4)?;
    let slices = [phi.len(), theta.len()];
    if sides[..2] != slices {
        return Err(format!("field `vndf` has sides {sides:?}, the angles make {slices:?}"));
    }
    let warp = Warp::new(sides[2], sides[3], vndf)?;
    let spectral = file.has("wavelengths");
    let name = if spectral { "spectra" } else { "rgb" };
    let (sides, spectra) = file.f32(name, 5)?;
    if sides[..2] != slices || sides[3] < 2 || sides[4] < 2 || spectra.iter().any(|&v| v < 0.0) {
        return Err(format!(
            "field `{name}` has sides {sides:?}, the angles make {slices:?}, or a value is negative"
        ));
    }
    let (chosen, note) = if spectral {
        let wavelengths = axis("wavelengths")?;
        if wavelengths.len() != sides[2] {
            return Err(format!("{} wavelengths for {} spectra", wavelengths.len(), sides[2]));
        }
        choose(&wavelengths)
    } else if sides[2] == 3 {
        (vec![0, 1, 2], None)
    } else {
        return Err(format!("field `rgb` has {} channels", sides[2]));
    };
    Ok(Rgl {
        theta,
        phi,
        ndf,
        sigma,
        warp,
        spectra,
        channels: sides[2],
        side: [sides[3], sides[4]],
        chosen,
        note,
    })
}

/// Three of the wavelengths, or the only one.
fn choose(wavelengths: &[f64]) -> (Vec<usize>, Option<String>) {
    let nearest = |wanted: f64| {
        let off = |k: &usize| (wavelengths[*k] - wanted).abs();
        (0..wavelengths.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
    };
    let chosen = RGB_NM.map(nearest);
    if wavelengths.len() < 3 {
        return (vec![chosen[1]], Some(format!("Y is the value at {} nm", wavelengths[chosen[1]])));
    }
    let names: Vec<String> = chosen.iter().map(|&k| format!("{} nm", wavelengths[k])).collect();
    (chosen.to_vec(), Some(format!("R, G, B are the values at {}", names.join(", "))))
}

impl Rgl {
    /// Polar angles of the light below 89.9 degrees, degrees.
    pub fn theta_i_deg(&self) -> Vec<f64> {
        let deg = self.theta.iter().map(|t| (t.to_degrees() * 1e4).round() / 1e4);
        deg.filter(|&t| t < 89.9).collect()
    }

    /// Azimuths of the light in degrees, without the one that closes the turn; none where all are alike.
    pub fn phi_i_deg(&self) -> Vec<f64> {
        if self.phi.len() <= 2 {
            return vec![];
        }
        let deg = self.phi[..self.phi.len() - 1].iter();
        deg.map(|p| sphere::reduced_deg((p.to_degrees() * 1e4).round() / 1e4)).collect()
    }

    fn slices(&self, theta: f64, phi: f64) -> Slices {
        let (t0, t) = interval(&self.theta, theta);
        let (p0, p) = if self.phi.len() <= 2 { (0, 0.0) } else { interval(&self.phi, phi) };
        let at = |dp: usize, dt: usize| {
            (p0 + dp).min(self.phi.len() - 1) * self.theta.len() + (t0 + dt).min(self.theta.len() - 1)
        };
        [
            (at(0, 0), (1.0 - p) * (1.0 - t)),
            (at(0, 1), (1.0 - p) * t),
            (at(1, 0), p * (1.0 - t)),
            (at(1, 1), p * t),
        ]
    }
}

/// The interval that holds x and the place in it; outside, the end.
fn interval(nodes: &[f64], x: f64) -> (usize, f64) {
    if nodes.len() < 2 {
        return (0, 0.0);
    }
    let k = nodes.partition_point(|&node| node <= x).clamp(1, nodes.len() - 1) - 1;
    (k, ((x - nodes[k]) / (nodes[k + 1] - nodes[k])).clamp(0.0, 1.0))
}

impl Brdf for Rgl {
    fn colours(&self) -> usize {
        self.chosen.len()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let m = (wi + wo).normalize();
        let phi_i = wi.y.atan2(wi.x);
        let slices = self.slices(sphere::theta(wi), phi_i);
        let origin = if self.phi.len() <= 2 { phi_i } else { 0.0 };
        let u = [u_of_theta(sphere::theta(m)), u_of_phi(m.y.atan2(m.x) - origin)];
        let sample = self.warp.inverse(&slices, u);
        let ((column, x), (row, y)) = (cell(sample[0], self.side[1]), cell(sample[1], self.side[0]));
        let scale =
            self.ndf.at(u) / (4.0 * self.sigma.at([u_of_theta(sphere::theta(wi)), u_of_phi(phi_i)]) * wo.z);
        let size = self.side[0] * self.side[1];
        let mut found = [0.0; 3];
        for (value, &channel) in found.iter_mut().zip(&self.chosen) {
            for &(slice, weight) in slices.iter().filter(|slice| slice.1 != 0.0) {
                let nodes = &self.spectra[(slice * self.channels + channel) * size..][..size];
                let node = |r: usize, c: usize| f64::from(nodes[(row + r) * self.side[1] + column + c]);
                let upper = (1.0 - x) * node(0, 0) + x * node(0, 1);
                *value += weight * ((1.0 - y) * upper + y * ((1.0 - x) * node(1, 0) + x * node(1, 1)));
            }
            *value *= scale;
        }
        found
    }
}
