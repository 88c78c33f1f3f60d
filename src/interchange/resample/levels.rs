//! How much light leaves for every direction of the light: the scale that gives an interpolant the table's albedo.
//!
//! At the incidences the table says it. Between them the ratio of the table's albedo to the guide's is interpolated,
//! as the values are; beyond them it holds.

use std::f64::consts::{FRAC_PI_2, TAU};

use rayon::prelude::*;

use super::axis::Taps;
use super::guided::Guided;
use super::interval::interval;
use super::sampling::{integral, samples};
use crate::interchange::Colour;
use crate::sphere;

/// Directions of each kind in an integral.
const SAMPLES: usize = 256;
/// Gaps up to here have no node between incidences, up to the second one; wider ones [`BETWEEN`], rad.
const NARROW: [f64; 2] = [1.01 * TAU / 360.0, 3.01 * TAU / 360.0];
const BETWEEN: usize = 3;
/// The last node, rad: at 90 degrees no light arrives.
const LAST: f64 = 89.5 * TAU / 360.0;

/// Scales at nodes, straight lines between them.
pub(crate) struct Levels {
    theta: Vec<f64>,
    phi: Vec<f64>,
    /// [theta][phi].
    factors: Vec<Colour>,
}

/// The incidences, and nodes between them; with each whether it is an incidence.
fn nodes(incidences: &[f64], end: Option<f64>) -> Vec<(f64, bool)> {
    let mut nodes: Vec<(f64, bool)> = Vec::new();
    let incidence = incidences.iter().map(|&angle| (angle, true));
    let pole = end.filter(|_| incidences[0] > 0.0).map(|_| (0.0, false));
    let last = end.filter(|&end| end > incidences[incidences.len() - 1]).map(|end| (end, false));
    let turn = (end.is_none() && incidences.len() > 1).then(|| (incidences[0] + TAU, true));
    for (angle, is_incidence) in pole.into_iter().chain(incidence).chain(last).chain(turn) {
        if let Some(&(before, _)) = nodes.last() {
            let gap = angle - before;
            let count = if gap <= NARROW[0] {
                0
            } else if gap <= NARROW[1] {
                1
            } else {
                BETWEEN
            };
            let part = |k: usize| before + gap * k as f64 / (count + 1) as f64;
            nodes.extend((1..=count).map(|k| (part(k), false)));
        }
        nodes.push((angle, is_incidence));
    }
    nodes
}

impl Levels {
    /// The scales of an interpolant that has its guide.
    pub fn of(guided: &Guided) -> Self {
        let values = &guided.values;
        let theta = nodes(values.theta_i(), Some(LAST.max(values.theta_i()[values.theta_i().len() - 1])));
        let phi = nodes(values.phi_i(), None);
        let columns = values.phi_i().len();
        let ratios: Vec<Colour> = (0..values.theta_i().len() * columns)
            .into_par_iter()
            .map(|incidence| {
                let (theta, phi) =
                    (values.theta_i()[incidence / columns], values.phi_i()[incidence % columns]);
                let [table, law] = albedos(guided, theta, phi);
                std::array::from_fn(|c| table[c] / law[c])
            })
            .collect();
        let factor = |k: usize| {
            let ((theta, on_row), (phi, on_column)) = (theta[k / phi.len()], phi[k % phi.len()]);
            // The incidence itself is the table.
            if on_row && on_column {
                return [1.0; 3];
            }
            let wanted = interpolated(&ratios, columns, values.incidence_taps(theta, phi));
            let [found, law] = albedos(guided, theta, phi);
            std::array::from_fn(|c| if found[c] > 0.0 { wanted[c].max(0.0) * law[c] / found[c] } else { 1.0 })
        };
        let factors = (0..theta.len() * phi.len()).into_par_iter().map(factor).collect();
        let angles = |nodes: Vec<(f64, bool)>| nodes.into_iter().map(|node| node.0).collect();
        Levels { factors, theta: angles(theta), phi: angles(phi) }
    }

    /// The scale of light from a polar angle and an azimuth.
    pub fn at(&self, theta: f64, phi: f64) -> Colour {
        let first = self.phi[0];
        let (rows, x) = interval(&self.theta, theta);
        let (columns, y) = interval(&self.phi, first + (phi - first).rem_euclid(TAU));
        let node = |r: usize, c: usize| self.factors[rows[r] * self.phi.len() + columns[c]];
        let corners = [node(0, 0), node(0, 1), node(1, 0), node(1, 1)];
        std::array::from_fn(|k| {
            let line = |low: usize| (1.0 - y) * corners[low][k] + y * corners[low + 1][k];
            (1.0 - x) * line(0) + x * line(2)
        })
    }
}

/// The integrals of f cos of the interpolant and of its guide.
fn albedos(guided: &Guided, theta: f64, phi: f64) -> [Colour; 2] {
    let wi = sphere::direction(theta.min(FRAC_PI_2), phi);
    let to = samples(wi, guided.guide.lobe(), SAMPLES);
    let angles = (sphere::theta(wi), sphere::phi(wi));
    [integral(&to, |wo| guided.brdf(wi, angles, wo)), integral(&to, |wo| guided.guide.brdf(wi, wo))]
}

fn interpolated(ratios: &[Colour], columns: usize, (polar, circle): (Taps, Taps)) -> Colour {
    let mut sum = [0.0; 3];
    for t in polar.iter() {
        for p in circle.iter() {
            let ratio = ratios[t.node * columns + p.node];
            sum.iter_mut().zip(ratio).for_each(|(s, r)| *s += t.weight * p.weight * r);
        }
    }
    sum
}
