//! Node values of an interpolant whose means over a hemisphere's bins are the table's.

use std::f64::consts::PI;

use super::axis::{AzimuthCircle, Polar, Taps};
use crate::instrument::Grid;

/// Rounds of the correction towards the table's bin means; each leaves at most a third of the finest detail's error.
const ROUNDS: usize = 4;
/// Gauss-Legendre nodes and weights on [-1, 1], three points.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.774_596_669_241_483_4, 5.0 / 18.0)];

/// Moves the node values (rows x columns of every incidence) until the interpolant's bin means are what they were;
/// `places` are the grid's columns in the order of the circle.
pub(crate) fn keep_means(
    values: &mut [Vec<f32>],
    (polar, circle): (&Polar, &AzimuthCircle),
    grid: &Grid,
    places: &[usize],
) {
    let theta: Vec<[f64; 2]> = pairs(&grid.theta_r_edges_deg);
    let edges: Vec<[f64; 2]> = pairs(&grid.phi_r_edges_deg);
    let phi: Vec<[f64; 2]> = places.iter().map(|&place| edges[place]).collect();
    let rows: Vec<_> = theta.iter().map(|&range| row_mean(polar, range)).collect();
    let across = |shift: f64| {
        let mean = |&[p1, p2]: &[f64; 2]| {
            GAUSS.iter().flat_map(|&(x, w)| weighted(&circle.cubic(middle(p1, p2, x) + shift), w)).collect()
        };
        phi.iter().map(mean).collect()
    };
    let size = rows.len() * places.len();
    let means = Means { rows, near: across(0.0), far: across(PI), columns: places.len() };
    use rayon::prelude::*;
    for values in values {
        values.par_chunks_mut(size).for_each(|incidence| means.correct(incidence));
    }
}

/// Taps of the mean over [t1, t2], weighted with sin cos: nodes spaced in sin^2.
fn row_mean(polar: &Polar, [t1, t2]: [f64; 2]) -> Vec<(usize, bool, f64)> {
    let (s1, s2) = (t1.sin().powi(2), t2.sin().powi(2));
    let taps = |&(x, w): &(f64, f64)| {
        let taps = polar.cubic(middle(s1, s2, x).sqrt().asin());
        taps.iter().map(|tap| (tap.node, tap.reflected, w * tap.weight)).collect::<Vec<_>>()
    };
    GAUSS.iter().flat_map(taps).collect()
}

/// The bin means of an interpolant as sums over its nodes.
struct Means {
    rows: Vec<Vec<(usize, bool, f64)>>,
    near: Vec<Vec<(usize, f64)>>,
    far: Vec<Vec<(usize, f64)>>,
    columns: usize,
}

impl Means {
    fn correct(&self, values: &mut [f32]) {
        let wanted: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
        let mut nodes = wanted.clone();
        for _ in 0..ROUNDS {
            let means = self.of(&nodes);
            nodes
                .iter_mut()
                .zip(&wanted)
                .zip(&means)
                .for_each(|((node, wanted), mean)| *node += wanted - mean);
        }
        values.iter_mut().zip(&nodes).for_each(|(value, node)| *value = *node as f32);
    }

    fn of(&self, nodes: &[f64]) -> Vec<f64> {
        let along = |taps: &[Vec<(usize, f64)>], row: usize| -> Vec<f64> {
            let row = &nodes[row * self.columns..][..self.columns];
            taps.iter().map(|taps| taps.iter().map(|&(k, w)| w * row[k]).sum()).collect()
        };
        let near: Vec<Vec<f64>> = (0..self.rows.len()).map(|row| along(&self.near, row)).collect();
        // Only the first rows are seen through the pole.
        let far: Vec<Vec<f64>> = (0..self.rows.len().min(3)).map(|row| along(&self.far, row)).collect();
        let mut means = Vec::with_capacity(nodes.len());
        for taps in &self.rows {
            let value = |column: usize| {
                let seen = |row: usize, reflected: bool| {
                    if reflected { far[row][column] } else { near[row][column] }
                };
                taps.iter().map(|&(row, reflected, w)| w * seen(row, reflected)).sum::<f64>()
            };
            means.extend((0..self.columns).map(value));
        }
        means
    }
}

fn middle(low: f64, high: f64, x: f64) -> f64 {
    0.5 * (low + high) + 0.5 * x * (high - low)
}

fn weighted(taps: &Taps, weight: f64) -> Vec<(usize, f64)> {
    taps.iter().map(|tap| (tap.node, weight * tap.weight)).collect()
}

fn pairs(edges_deg: &[f64]) -> Vec<[f64; 2]> {
    edges_deg.windows(2).map(|pair| [pair[0].to_radians(), pair[1].to_radians()]).collect()
}
