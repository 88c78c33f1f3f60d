//! An RGL file as a function of two directions.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use super::direction_map::{Map, u_of_phi, u_of_theta};
use super::tensor_file::TensorFile;
use super::warp::{Slices, Warp, cell};
use crate::error::wrong;
use crate::interchange::resample::interval::interval;
use crate::interchange::{Brdf, Checked, Colour};
use crate::sphere;

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
pub fn read(bytes: &[u8]) -> Checked<Rgl> {
    let file = TensorFile::open(bytes)?;
    let axis = |name: &str| -> Checked<Vec<f64>> {
        let values: Vec<f64> = file.f32(name, 1)?.1.into_iter().map(f64::from).collect();
        match values.windows(2).find(|pair| pair[0] >= pair[1]) {
            Some(pair) => Err(wrong!("field `{name}` does not increase from {} to {}", pair[0], pair[1])),
            None => Ok(values),
        }
    };
    let (theta, phi) = (axis("theta_i")?, axis("phi_i")?);
    let in_range = |values: &[f64], low: f64, high: f64| values.iter().all(|v| (low..=high).contains(v));
    if !in_range(&theta, 0.0, FRAC_PI_2 + 1e-6) || !in_range(&phi, -TAU, TAU) {
        return Err("angles of the light lie outside the hemisphere; radians needed".into());
    }
    if phi.len() > 2 && phi[phi.len() - 1] - phi[0] < TAU - 0.1 {
        return Err(wrong!(
            "azimuths from {} to {} rad: only files of the whole turn are read",
            phi[0],
            phi[phi.len() - 1]
        ));
    }
    let map = |name: &str| -> Checked<Map> {
        let (sides, values) = file.f32(name, 2)?;
        if sides[0] < 2 || sides[1] < 2 || values.iter().any(|&v| v < 0.0) {
            return Err(wrong!("field `{name}`: at least 2 x 2 values, none negative, needed"));
        }
        Ok(Map { rows: sides[0], columns: sides[1], values })
    };
    let (ndf, sigma) = (map("ndf")?, map("sigma")?);
    let (sides, vndf) = file.f32("vndf", 4)?;
    let slices = [phi.len(), theta.len()];
    if sides[..2] != slices {
        return Err(wrong!("field `vndf` has sides {sides:?}, the angles make {slices:?}"));
    }
    let warp = Warp::new(sides[2], sides[3], vndf)?;
    let spectral = file.has("wavelengths");
    let name = if spectral { "spectra" } else { "rgb" };
    let (sides, spectra) = file.f32(name, 5)?;
    if sides[..2] != slices || sides[3] < 2 || sides[4] < 2 || spectra.iter().any(|&v| v < 0.0) {
        return Err(wrong!(
            "field `{name}` has sides {sides:?}, the angles make {slices:?}, or a value is negative"
        ));
    }
    let (chosen, note) = if spectral {
        let wavelengths = axis("wavelengths")?;
        if wavelengths.len() != sides[2] {
            return Err(wrong!("{} wavelengths for {} spectra", wavelengths.len(), sides[2]));
        }
        choose(&wavelengths)
    } else if sides[2] == 3 {
        (vec![0, 1, 2], None)
    } else {
        return Err(wrong!("field `rgb` has {} channels", sides[2]));
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
        let (rows, t) = interval(&self.theta, theta);
        let (columns, p) = if self.phi.len() <= 2 { ([0, 0], 0.0) } else { interval(&self.phi, phi) };
        let at = |p: usize, t: usize| columns[p] * self.theta.len() + rows[t];
        [
            (at(0, 0), (1.0 - p) * (1.0 - t)),
            (at(0, 1), (1.0 - p) * t),
            (at(1, 0), p * (1.0 - t)),
            (at(1, 1), p * t),
        ]
    }
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
