//! Propagation of distributions: JCGM 101:2008.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use rand_pcg::Pcg64Dxsm;
use rayon::prelude::*;
use serde::Serialize;

use super::gum::{Combined, OUTSIDE, tolerance};
use crate::campaign::{Distribution, InputQuantity, QUANTITIES};
use crate::rng::{self, Purpose, StreamId};

/// Trials that share a stream.
const BLOCK: u64 = 10_000;

/// What is drawn in every trial.
#[derive(Debug, Clone)]
pub struct Inputs<'a> {
    /// The inputs.
    pub inputs: &'a [InputQuantity],
    /// L of their correlation matrix L L^T.
    pub factor: &'a [Vec<f64>],
    /// Standard error and degrees of freedom of what is added by the spread of realisations.
    pub type_a: Option<(f64, f64)>,
    /// Half-widths of rectangular errors that are added.
    pub half_widths: &'a [f64],
    /// Everything drawn follows from it.
    pub seed: u64,
}

/// What the trials gave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MonteCarlo {
    /// Number of trials.
    pub trials: u64,
    /// Their mean.
    pub mean: f64,
    /// Their standard deviation.
    pub standard_uncertainty: f64,
    /// Ends of the probabilistically symmetric 95 % interval.
    pub low: f64,
    /// The upper one.
    pub high: f64,
}

/// Whether both methods say the same (JCGM 101, 8).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Agreement {
    /// Significant digits of u_c to which they do: 2, 1, or 0 where they differ.
    pub digits: usize,
    /// Half a unit of the last of these digits; of the first where they differ.
    pub tolerance: f64,
    /// |y - U - low|.
    pub low: f64,
    /// |y + U - high|.
    pub high: f64,
}

impl Inputs<'_> {
    /// The errors of the inputs of one trial, in their order.
    ///
    /// Independent normal numbers are made correlated and mapped to the distributions (a Gaussian copula: coefficients are
    /// exact of normal inputs). t: Bailey 1994, sqrt(nu (u^(-2/nu) - 1)) cos(2 pi v).
    pub fn draw(&self, draws: &mut Pcg64Dxsm, errors: &mut [f64]) {
        let mut normal = [0.0; QUANTITIES.len()];
        let normal = &mut normal[..self.inputs.len()];
        normal.iter_mut().for_each(|z| *z = rng::normal(draws));
        for (k, input) in self.inputs.iter().enumerate() {
            let z: f64 = self.factor[k].iter().zip(normal.iter()).map(|(l, z)| l * z).sum();
            errors[k] = match (input.distribution, input.dof) {
                (Distribution::T, Some(dof)) => input.scale * student(draws, dof),
                (law, _) => input.scale * standard_quantile(law, z),
            };
        }
    }

    /// What is added to the model's value in one trial.
    fn added(&self, draws: &mut Pcg64Dxsm) -> f64 {
        let type_a = self.type_a.map_or(0.0, |(se, dof)| se * student(draws, dof));
        let even = |half_width: &f64| half_width * (2.0 * rng::uniform(draws) - 1.0);
        type_a + self.half_widths.iter().map(even).sum::<f64>()
    }

    /// `trials` of the value that `model` gives to errors of the inputs; the same for any number of threads.
    // Tested by `the_sum_of_four_rectangular_quantities` (tests/it/budget/methods.rs).
    pub fn propagate(&self, trials: u64, model: impl Fn(&[f64]) -> f64 + Sync) -> MonteCarlo {
        let block = |number: u64| {
            let id = StreamId {
                seed: self.seed,
                purpose: Purpose::Budget,
                realisation: 0,
                incidence: 0,
                block: number,
            };
            let mut draws = rng::stream(id);
            let mut errors = vec![0.0; self.inputs.len()];
            let count = BLOCK.min(trials - number * BLOCK);
            let one = |_| {
                self.draw(&mut draws, &mut errors);
                model(&errors) + self.added(&mut draws)
            };
            (0..count).map(one).collect::<Vec<f64>>()
        };
        let blocks: Vec<Vec<f64>> = (0..trials.div_ceil(BLOCK)).into_par_iter().map(block).collect();
        let mut values = blocks.concat();
        // In the order of the trials: sums do not depend on the threads.
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        // JCGM 101, 7.7.2: the interval from rank r to r + q, r = (M - q)/2, q = p M.
        let inside = ((1.0 - OUTSIDE) * count).round() as usize;
        let first = ((values.len() - inside) / 2).max(1);
        let mut ranked = |rank: usize| *values.select_nth_unstable_by(rank - 1, f64::total_cmp).1;
        let (low, high) = (ranked(first), ranked(first + inside));
        MonteCarlo { trials, mean, standard_uncertainty: (squares / (count - 1.0)).sqrt(), low, high }
    }
}

impl Agreement {
    /// Of y +- U and the interval of the trials.
    pub fn of(value: f64, gum: &Combined, trials: &MonteCarlo) -> Self {
        let (low, high) =
            ((value - gum.expanded - trials.low).abs(), (value + gum.expanded - trials.high).abs());
        let tolerance = |digits| tolerance(gum.standard_uncertainty, digits);
        let digits = [2, 1].into_iter().find(|&digits| low.max(high) <= tolerance(digits)).unwrap_or(0);
        Agreement { digits, tolerance: tolerance(digits.max(1)), low, high }
    }
}

/// Student's t of `dof` > 0 degrees of freedom.
fn student(draws: &mut Pcg64Dxsm, dof: f64) -> f64 {
    let radius = (dof * ((1.0 - rng::uniform(draws)).powf(-2.0 / dof) - 1.0)).sqrt();
    radius * (TAU * rng::uniform(draws)).cos()
}

/// The value of a distribution of scale 1 where a normal number is `z`.
fn standard_quantile(law: Distribution, z: f64) -> f64 {
    let below = || 0.5 * libm::erfc(-z * FRAC_1_SQRT_2);
    match law {
        Distribution::Normal | Distribution::T => z,
        Distribution::Rectangular => 2.0 * below() - 1.0,
        Distribution::Arcsine => (PI * (below() - 0.5)).sin(),
        Distribution::Triangular if z < 0.0 => (2.0 * below()).sqrt() - 1.0,
        Distribution::Triangular => 1.0 - libm::erfc(z * FRAC_1_SQRT_2).sqrt(),
    }
}
