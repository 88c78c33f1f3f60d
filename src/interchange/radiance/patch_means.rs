//! Means of a BRDF over pairs of Klems patches.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::instrument::Region;
use crate::instrument::klems::{Ring, patches};
use crate::interchange::resample::nodes;
use crate::interchange::{Brdf, Colour};

/// Means over pairs of patches, light major. Where every azimuth of the light is alike (`isotropic`), pairs of two rings that
/// are as far apart in azimuth have one mean: a sixth of all is integrated.
pub fn means(brdf: &dyn Brdf, rings: &[Ring], isotropic: bool) -> Vec<Colour> {
    let basis = patches(rings);
    let outward = |turn: f64| {
        let region = |&[t1, t2, p1, p2]: &[f64; 4]| Region::Rectangle {
            theta: [t1.to_radians(), t2.to_radians()],
            phi: [(p1 + turn).to_radians(), (p2 + turn).to_radians()],
        };
        basis.iter().map(|patch| nodes(&region(patch))).collect::<Vec<_>>()
    };
    let (light, sensor) = (outward(180.0), outward(0.0));
    let mean = |k: usize| {
        let mut sum = [0.0; 3];
        for (wi, w) in &light[k / basis.len()] {
            for (wo, v) in &sensor[k % basis.len()] {
                let value = brdf.brdf(*wi, *wo);
                sum.iter_mut().zip(value).for_each(|(s, f)| *s += w * v * f);
            }
        }
        sum
    };
    let same = if isotropic { alike(rings) } else { (0..basis.len() * basis.len()).collect() };
    let mut matrix = vec![[0.0; 3]; same.len()];
    let own = matrix.par_iter_mut().enumerate().filter(|(k, _)| same[*k] == *k);
    own.for_each(|(k, value)| *value = mean(k));
    (0..same.len()).for_each(|k| matrix[k] = matrix[same[k]]);
    matrix
}

/// For each pair of patches, light major, the first one of the same rings whose azimuths differ by as much.
fn alike(rings: &[Ring]) -> Vec<usize> {
    let ring = |(r, ring): (usize, &Ring)| (0..ring.2).map(move |place| (r, place));
    let all: Vec<(usize, usize)> = rings.iter().enumerate().flat_map(ring).collect();
    let mut first = HashMap::new();
    let pair = |k: usize| {
        let ((light, i), (sensor, j)) = (all[k / all.len()], all[k % all.len()]);
        let [n, m] = [light, sensor].map(|ring| rings[ring].2);
        // Patch i of a ring of n lies at i/n of a turn: j/m - i/n, by whole numbers.
        *first.entry((light, sensor, (j * n + n * m - i * m) % (n * m))).or_insert(k)
    };
    (0..all.len() * all.len()).map(pair).collect()
}
