//! An RGL file out of a table.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use super::direction_map::{Map, phi_of, theta_of, u_of_phi, u_of_theta};
use super::tensor_file::{TensorData, TensorField, encode};
use super::warp::{Slices, Warp};
use crate::interchange::resample::lobe::{Facets, GuideLobe};
use crate::interchange::{Brdf, Checked, Colour, Lookup};
use crate::sphere;

/// Steps of the light's angles that are wider are divided, rad.
const WIDEST_THETA: f64 = 6.0 * PI / 180.0;
const WIDEST_PHI: f64 = 8.0 * PI / 180.0;
/// The last polar angle of the light, rad: at grazing light the warp has no density left.
const LAST_THETA: f64 = 88.0 * PI / 180.0;
/// Nodes along theta of D and sigma.
const NDF_NODES: usize = 256;
/// Least luminance, so that no slice is 0 throughout.
const LEAST_LUMINANCE: f32 = 1e-6;

/// Nodes of `angles`, and such between them that no step is wider than `widest`.
fn refined(angles: &[f64], widest: f64) -> Vec<f64> {
    let mut nodes = vec![angles[0]];
    for pair in angles.windows(2) {
        let parts = ((pair[1] - pair[0]) / widest - 1e-9).ceil().max(1.0);
        nodes.extend((1..=parts as usize).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / parts));
    }
    nodes
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
// Tested by `rgl_reads_back` (tests/it/interchange/interchange_rgl.rs), and against Mitsuba in tests/interop.
pub fn write(lookup: &Lookup, wavelengths_nm: Option<&[f64]>, description: &str) -> Checked<Vec<u8>> {
    let isotropic = lookup.is_isotropic();
    let (vndf_side, side) = if isotropic { (128, 64) } else { (64, 32) };
    let auxiliary = GuideLobe::of(lookup.values(), Facets::Mirror);
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
