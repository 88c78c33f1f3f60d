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

/// A direction of a [`Pattern`], before light meets it.
#[derive(Debug, Clone, Copy)]
enum Entry {
    /// Wherever facets of this normal send the light.
    Normal(DVec3),
    /// This direction, whatever the light.
    Even(DVec3),
}

/// Directions of an integral of f cos for any light, always the same: `count` each of half vectors after a lobe, of half
/// vectors after a lobe a quarter as wide, and of cosines, together by the balance heuristic (Veach and Guibas 1995).
#[derive(Debug, Clone)]
pub(crate) struct Pattern {
    lobes: [GuideLobe; 2],
    count: usize,
    entries: Vec<Entry>,
}

impl Pattern {
    /// `count` directions of each kind.
    pub fn new(lobe: GuideLobe, count: usize) -> Self {
        let lobes = [lobe, lobe.scaled(0.25)];
        let entry = |k: usize| {
            let (u, v) = ((k as f64 + 0.5) / count as f64, radical_inverse(k));
            // GGX: tan^2 = alpha^2 u/(1 - u).
            let (slope, (sin, cos)) = ((u / (1.0 - u)).sqrt(), (TAU * v).sin_cos());
            let normal = |lobe: GuideLobe| {
                let h = DVec3::new(lobe.alpha_x * slope * cos, lobe.alpha_y * slope * sin, 1.0).normalize();
                Entry::Normal(h)
            };
            let even = sphere::direction(u.sqrt().asin(), TAU * v);
            [normal(lobes[0]), normal(lobes[1]), Entry::Even(even)]
        };
        Pattern { lobes, count, entries: (0..count).flat_map(entry).collect() }
    }

    /// Number of directions.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// The direction of a place for this light; `None` below the horizon.
    pub fn onward(&self, wi: DVec3, place: usize) -> Option<DVec3> {
        match self.entries[place] {
            Entry::Normal(h) if wi.dot(h) > 0.0 => self.lobes[0].facets.onward(wi, h),
            Entry::Normal(_) => None,
            Entry::Even(wo) => Some(wo).filter(|wo| wo.z > 0.0),
        }
    }

    /// The share of a direction, one of the pattern's, of the integral over projected solid angle.
    pub fn weight(&self, wi: DVec3, wo: DVec3) -> f64 {
        let of_facets = |h: DVec3| -> f64 {
            self.lobes.iter().map(|lobe| lobe.d(h) * h.z * lobe.facets.normals_of(wi, wo, h)).sum()
        };
        let density = self.lobes[0].facets.normal(wi, wo).map_or(0.0, of_facets) + wo.z / PI;
        wo.z / (self.count as f64 * density)
    }
}

/// The directions of a [`Pattern`] above the horizon, with their shares.
pub(crate) fn samples(wi: DVec3, lobe: GuideLobe, count: usize) -> Vec<Sampled> {
    let pattern = Pattern::new(lobe, count);
    let sampled = |wo: DVec3| Sampled { wo, weight: pattern.weight(wi, wo) };
    (0..pattern.len()).filter_map(|place| pattern.onward(wi, place)).map(sampled).collect()
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
