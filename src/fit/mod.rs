//! Least-squares fits of analytic models to a table, bin mean against bin mean, weighted by the table's errors.
//!
//! Enters: a table, its campaign and its realisations. Leaves: every model's parameters with two kinds of standard
//! error, its distance and a ranking. The iteration is MINPACK's Levenberg-Marquardt (More 1978) of the crate
//! `levenberg-marquardt`. No model is the truth of a continuous surface, so least-squares errors, which know the noise
//! of single bins alone, are too small; the jackknife over realisations (Efron and Stein 1981) is the one to believe.

pub mod data;
pub mod law;
pub mod nodes;
pub mod pilot;
mod report;
pub mod solve;

pub use data::Data;
pub use law::{Law, NAMES};
pub use report::{Fit, Fits, Parameters};

use nalgebra::DMatrix;
use rayon::prelude::*;

use self::law::Amplitudes;
use self::nodes::StopNodes;
use self::pilot::{Pilot, pilot};
use self::solve::{EXACT, NEAR, Problem, amplitudes_per_colour};

/// How much narrower than planned a lobe may come out before the nodes are laid out anew.
const NARROWER: f64 = 0.7;
/// Layouts of the nodes at most.
const LAYOUTS: usize = 4;

/// Fits every law of `laws` and ranks them, best first.
///
/// - Where there are realisations (two at least), each is left out in turn for the jackknife's errors.
/// - Cost: about 10 evaluations of 16 nodes a bin for each parameter and fit, and again for each realisation.
/// - Held by: tests/fit.rs.
pub fn fit(data: &Data, laws: &[Law]) -> Fits {
    let guess = pilot(data);
    let mut alpha = (guess.log_alpha - guess.stretch[0].hypot(guess.stretch[1])).exp();
    for layout in 1.. {
        let nodes = StopNodes::of_grid(&data.grid, data.aperture, alpha);
        let fits: Vec<Fitted> = laws.par_iter().map(|&law| fit_one(data, &nodes, law, &guess)).collect();
        let narrowest =
            fits.iter().filter_map(|fit| fit.law.narrowest(&fit.params)).fold(f64::INFINITY, f64::min);
        if narrowest >= NARROWER * alpha || layout == LAYOUTS || narrowest <= 1e-5 {
            let jackknifed = fits.into_par_iter().map(|fit| {
                let spread = jackknife(data, &nodes, &fit);
                report::fit(data, fit, spread)
            });
            return report::ranked(data, jackknifed.collect());
        }
        alpha = narrowest;
    }
    unreachable!("the last layout returns")
}

/// The best of `laws` (at least one), the jackknife's errors for it alone.
pub fn best(data: &Data, laws: &[Law]) -> Fit {
    let once = Data { parts: Vec::new(), ..data.clone() };
    let law = fit(&once, laws).fits.swap_remove(0).law;
    fit(data, &[law]).fits.swap_remove(0)
}

/// A model at its best parameters.
pub(crate) struct Fitted {
    law: Law,
    params: Vec<f64>,
    shapes: usize,
    chi_square: f64,
    converged: bool,
    covariance: Option<DMatrix<f64>>,
    model: Vec<Vec<f64>>,
}

fn fit_one(data: &Data, nodes: &[StopNodes], law: Law, pilot: &Pilot) -> Fitted {
    let shape = law.start(pilot);
    let shapes = shape.len();
    let amplitudes = law.amplitudes(data.perfect_mirror);
    let start = if amplitudes == Amplitudes::Two { vec![0.5, 0.05] } else { vec![0.5] };
    let of_colour = &start[..amplitudes_per_colour(amplitudes)];
    let params = [shape, of_colour.repeat(data.value.len())].concat();
    let (problem, solution) = Problem::new(data, nodes, law, &data.value, params).solve(EXACT);
    Fitted {
        law,
        shapes,
        covariance: problem.covariance(),
        model: problem.model(),
        params: solution.params,
        chi_square: solution.chi_square,
        converged: solution.converged,
    }
}

/// Covariance of the parameters by leaving out one realisation at a time: (R-1)/R sum (p_k - mean)(p_k - mean)'.
fn jackknife(data: &Data, nodes: &[StopNodes], fit: &Fitted) -> Option<DMatrix<f64>> {
    let count = data.parts.len();
    if count < 2 || fit.params.is_empty() {
        return None;
    }
    let one = |left_out: usize| {
        let target = data.without(left_out);
        Problem::new(data, nodes, fit.law, &target, fit.params.clone()).solve(NEAR).1.params
    };
    let all: Vec<Vec<f64>> = (0..count).into_par_iter().map(one).collect();
    let mean = |k: usize| all.iter().map(|params| params[k]).sum::<f64>() / count as f64;
    let means: Vec<f64> = (0..fit.params.len()).map(mean).collect();
    let factor = (count - 1) as f64 / count as f64;
    Some(DMatrix::from_fn(means.len(), means.len(), |i, j| {
        factor * all.iter().map(|params| (params[i] - means[i]) * (params[j] - means[j])).sum::<f64>()
    }))
}
