//! The likeliest parameters of a law, and how they scatter from tile to tile.
//!
//! For a held gamma the matrix solves alpha^2 = 2 mean(weight p p'), by iteration; gamma by the golden section of the
//! likelihood that is left. Errors are the sandwich over tiles: H^-1 (sum g_k g_k') H^-1 K/(K - 1), g_k the gradient of tile k's
//! log-likelihood and H the second derivatives of all, both by differences: one step of leaving tiles out.

use glam::DVec2;
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::{SlopeFamily, SlopeTiles};

/// gamma - 1 that a surface can be made with, as logarithms: gamma 2 to 100.
const GAMMA: [f64; 2] = [0.0, 4.595_119_850_134_59];
/// How near to an end a fitted gamma stands on it, of its logarithm.
const ON_BOUND: f64 = 1e-3;
/// The matrix is found where a round changes no logarithm by more.
const EXACT: f64 = 1e-10;
const ROUNDS: usize = 500;
/// The golden section ends at this length of ln(gamma - 1): the likelihood is flat to the square of it.
const SECTION: f64 = 1e-5;
/// Step of the differences.
const STEP: f64 = 1e-3;

/// A law at its best.
pub struct Solved {
    pub family: SlopeFamily,
    /// a, b, c, ln(gamma - 1), as far as they are free.
    pub params: Vec<f64>,
    /// Standard errors of the decoded parameters.
    pub errors: Vec<Option<f64>>,
    /// Mean over facets, nats.
    pub log_likelihood: f64,
    /// The same of each tile.
    pub by_tile: Vec<f64>,
    /// What the freedom of the parameters gains of `log_likelihood` on these very tiles.
    pub optimism: f64,
}

/// Whether gamma stands at an end of what it may be.
pub fn on_bound(gamma: f64) -> bool {
    let at = (gamma - 1.0).ln();
    at <= GAMMA[0] + ON_BOUND || at >= GAMMA[1] - ON_BOUND
}

pub fn solve(family: SlopeFamily, tiles: &SlopeTiles) -> Solved {
    let params = if family.fits_gamma() { with_gamma(family, tiles) } else { matrix(family, tiles, None) };
    let by_tile = by_tile(family, &params, tiles);
    let sums: Vec<f64> =
        by_tile.iter().zip(tiles.tiles()).map(|(mean, tile)| mean * tile.len() as f64).collect();
    let free = if family.fits_gamma() && on_bound(family.gamma(&params)) {
        family.matrix_params()
    } else {
        params.len()
    };
    let scatter = Scatter::of(family, &params, free, tiles);
    Solved {
        errors: scatter.as_ref().map_or(vec![None; family.names().len()], |s| s.errors(family, &params)),
        optimism: scatter.as_ref().map_or(0.0, |scatter| scatter.optimism) / tiles.facets() as f64,
        log_likelihood: sums.iter().sum::<f64>() / tiles.facets() as f64,
        by_tile,
        family,
        params,
    }
}

/// The matrix of roughness for a gamma, as parameters; `gamma`: ln(gamma - 1), where it is free.
fn matrix(family: SlopeFamily, tiles: &SlopeTiles, gamma: Option<f64>) -> Vec<f64> {
    // The median of |p|^2 is about alpha^2 under every law.
    let mut squares: Vec<f64> = tiles.all().map(DVec2::length_squared).collect();
    let middle = squares.len() / 2;
    let (_, median, _) = squares.select_nth_unstable_by(middle, f64::total_cmp);
    let start = if *median > 0.0 { *median } else { tiles.all().map(DVec2::length_squared).sum::<f64>() };
    let mut params = vec![0.5 * start.ln()];
    params.resize(family.matrix_params(), 0.0);
    params.extend(gamma);
    for _ in 0..ROUNDS {
        let law = family.at(&params);
        let sums = |tile: &Vec<DVec2>| {
            let moment = |sum: [f64; 3], slope: &DVec2| {
                let weight = law.weight(law.q(*slope));
                [
                    sum[0] + weight * slope.x * slope.x,
                    sum[1] + weight * slope.x * slope.y,
                    sum[2] + weight * slope.y * slope.y,
                ]
            };
            tile.iter().fold([0.0; 3], moment)
        };
        let each: Vec<[f64; 3]> = tiles.tiles().par_iter().map(sums).collect();
        let m: [f64; 3] =
            std::array::from_fn(|i| 2.0 * each.iter().map(|sum| sum[i]).sum::<f64>() / tiles.facets() as f64);
        let next = if family.anisotropic { logarithm(m) } else { vec![0.5 * (0.5 * (m[0] + m[2])).ln()] };
        let change = next.iter().zip(&params).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        params[..next.len()].copy_from_slice(&next);
        if change < EXACT {
            break;
        }
    }
    params
}

/// Half the logarithm of a symmetric matrix [xx, xy, yy], as (a, b, c).
fn logarithm([xx, xy, yy]: [f64; 3]) -> Vec<f64> {
    let (middle, across) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = across.hypot(xy);
    // The smaller eigenvalue without cancellation.
    let (large, small) = (middle + radius, (xx * yy - xy * xy) / (middle + radius));
    let r = 0.25 * (large / small).ln();
    let part = |component: f64| if radius > 0.0 { r * component / radius } else { 0.0 };
    vec![0.25 * (large * small).ln(), part(across), part(xy)]
}

fn with_gamma(family: SlopeFamily, tiles: &SlopeTiles) -> Vec<f64> {
    let at = |gamma: f64| {
        let params = matrix(family, tiles, Some(gamma));
        (mean(family, &params, tiles), params)
    };
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let [mut low, mut high] = GAMMA;
    let inner = |low: f64, high: f64| [high - ratio * (high - low), low + ratio * (high - low)];
    let [a, b] = inner(low, high);
    let (mut left, mut right) = ((a, at(a)), (b, at(b)));
    while high - low > SECTION {
        if left.1.0 >= right.1.0 {
            (high, right) = (right.0, left);
            let a = inner(low, high)[0];
            left = (a, at(a));
        } else {
            (low, left) = (left.0, right);
            let b = inner(low, high)[1];
            right = (b, at(b));
        }
    }
    let ends = GAMMA.map(at);
    let all = [left.1, right.1].into_iter().chain(ends);
    all.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, params)| params).unwrap_or_default()
}

fn mean(family: SlopeFamily, params: &[f64], tiles: &SlopeTiles) -> f64 {
    let sums = by_tile(family, params, tiles).into_iter().zip(tiles.tiles());
    sums.map(|(mean, tile)| mean * tile.len() as f64).sum::<f64>() / tiles.facets() as f64
}

/// Mean ln P of each tile's facets.
fn by_tile(family: SlopeFamily, params: &[f64], tiles: &SlopeTiles) -> Vec<f64> {
    let law = family.at(params);
    let one =
        |tile: &Vec<DVec2>| tile.iter().map(|slope| law.log(law.q(*slope))).sum::<f64>() / tile.len() as f64;
    tiles.tiles().par_iter().map(one).collect()
}

/// How parameters scatter.
struct Scatter {
    covariance: DMatrix<f64>,
    /// tr(J H^-1), of the sum over facets.
    optimism: f64,
}

impl Scatter {
    /// Of the first `free` parameters; `None` of a single tile, or where the likelihood has no peak.
    fn of(family: SlopeFamily, params: &[f64], free: usize, tiles: &SlopeTiles) -> Option<Scatter> {
        let count = tiles.count();
        if count < 2 {
            return None;
        }
        let moved = |steps: &[(usize, f64)]| {
            let mut params = params.to_vec();
            steps.iter().for_each(|&(k, step)| params[k] += step);
            let means = by_tile(family, &params, tiles).into_iter().zip(tiles.tiles());
            means.map(|(mean, tile)| mean * tile.len() as f64).collect::<Vec<f64>>()
        };
        let gradient = |k: usize, at: &[(usize, f64)]| {
            let [up, down] = [STEP, -STEP].map(|step| moved(&[at, &[(k, step)]].concat()));
            up.iter().zip(down).map(|(up, down)| (up - down) / (2.0 * STEP)).collect::<Vec<f64>>()
        };
        let scores: Vec<Vec<f64>> = (0..free).map(|k| gradient(k, &[])).collect();
        let spread = count as f64 / (count - 1) as f64;
        let scatter = DMatrix::from_fn(free, free, |i, j| {
            let mean = |k: usize| scores[k].iter().sum::<f64>() / count as f64;
            let pairs = scores[i].iter().zip(&scores[j]);
            spread * pairs.map(|(a, b)| (a - mean(i)) * (b - mean(j))).sum::<f64>()
        });
        let mut curvature = DMatrix::zeros(free, free);
        for j in 0..free {
            for i in 0..free {
                let [up, down] = [STEP, -STEP].map(|step| gradient(i, &[(j, step)]).iter().sum::<f64>());
                curvature[(i, j)] = -(up - down) / (2.0 * STEP);
            }
        }
        let inverse = (0.5 * (&curvature + curvature.transpose())).cholesky()?.inverse();
        let optimism = (&scatter * &inverse).trace();
        let covariance = &inverse * scatter * &inverse;
        covariance.iter().all(|value| value.is_finite()).then_some(Scatter { covariance, optimism })
    }

    /// Of the decoded parameters, by differences; `None` of what is held.
    fn errors(&self, family: SlopeFamily, params: &[f64]) -> Vec<Option<f64>> {
        let free = self.covariance.nrows();
        let columns: Vec<Vec<f64>> = (0..free)
            .map(|k| {
                let [up, down] = [STEP, -STEP].map(|step| {
                    let mut params = params.to_vec();
                    params[k] += step;
                    family.decoded(&params)
                });
                up.iter().zip(down).map(|(up, down)| (up - down) / (2.0 * STEP)).collect()
            })
            .collect();
        let variance = |row: usize| {
            let product = |i: usize, j: usize| columns[i][row] * self.covariance[(i, j)] * columns[j][row];
            (0..free).flat_map(|i| (0..free).map(move |j| (i, j))).map(|(i, j)| product(i, j)).sum::<f64>()
        };
        let error = |row| Some(variance(row).sqrt()).filter(|se| se.is_finite() && *se > 0.0);
        (0..family.names().len()).map(error).collect()
    }
}
