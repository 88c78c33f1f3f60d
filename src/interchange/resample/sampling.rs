//! Integrals of f cos over the sensor's hemisphere, for lobes as wide or narrow as they may be.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::lobe::GuideLobe;
use crate::interchange::Colour;
use crate::sphere;

/// A direction and its share of an integral over projected solid angle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sampled {
    pub wo: DVec3,
    pub weight: f64,
}

/// Directions above the horizon, always the same: `count` each of half vectors after the lobe, of half vectors after a
/// lobe a quarter as wide, and of cosines, together by the balance heuristic (Veach and Guibas 1995).
pub(crate) fn samples(wi: DVec3, lobe: GuideLobe, count: usize) -> Vec<Sampled> {
    let lobes = [lobe, lobe.scaled(0.25)];
    let density = |wo: DVec3| {
        let of_facets = |h: DVec3| -> f64 {
            lobes.iter().map(|lobe| lobe.d(h) * h.z * lobe.facets.normals_of(wi, wo, h)).sum()
        };
        count as f64 * (lobe.facets.normal(wi, wo).map_or(0.0, of_facets) + wo.z / PI)
    };
    let mut found = Vec::with_capacity(3 * count);
    let mut add = |wo: DVec3| found.push(Sampled { wo, weight: wo.z / density(wo) });
    for k in 0..count {
        let (u, v) = ((k as f64 + 0.5) / count as f64, radical_inverse(k));
        for lobe in lobes {
            // GGX: tan^2 = alpha^2 u/(1 - u).
            let (slope, (sin, cos)) = ((u / (1.0 - u)).sqrt(), (TAU * v).sin_cos());
            let h = DVec3::new(lobe.alpha_x * slope * cos, lobe.alpha_y * slope * sin, 1.0).normalize();
            if wi.dot(h) > 0.0 {
                lobe.facets.onward(wi, h).into_iter().for_each(&mut add);
            }
        }
        let even = sphere::direction(u.sqrt().asin(), TAU * v);
        Some(even).filter(|wo| wo.z > 0.0).into_iter().for_each(&mut add);
    }
    found
}

/// The integral of f cos over the hemisphere.
pub(crate) fn integral(samples: &[Sampled], f: impl Fn(DVec3) -> Colour) -> Colour {
    samples.iter().fold([0.0; 3], |mut sum, to| {
        sum.iter_mut().zip(f(to.wo)).for_each(|(sum, value)| *sum += to.weight * value);
        sum
    })
}

/// The bits of k mirrored at the point: van der Corput's sequence.
fn radical_inverse(k: usize) -> f64 {
    (k as u32).reverse_bits() as f64 / 2f64.powi(32)
}
