//! Fits of analytic models to a table, bin mean against bin mean, weighted by the size of each bin over the model.
//!
//! Input: a table, its campaign and its realisations. Output: every model's parameters with two kinds of standard
//! error, its distances and a ranking that knows the errors of the realisations. No model is the truth of a continuous
//! surface, and facets that many bins share are off in all of them together; so errors that know single bins alone are
//! too small, and the jackknife over realisations (Efron and Stein 1981) is the one to believe.
//!
//! An interval of 95 % holds what the model nearest to the *mean* table would give, in 95 of 100 campaigns (R = 4, 8,
//! 16; tests/it/fit_errors.rs). How far that is from the roughness of the facets is the model's own affair: nothing for
//! walks over statistical facets, up to half a hundredth for random patches, whose masking no model has.

pub mod data;
mod error_propagation;
pub mod law;
pub mod microfacet_law;
mod nearest;
pub mod nodes;
pub mod pilot;
mod ranking;
mod report;
pub mod sample;
pub mod slopes;
pub mod solve;
mod spread;

pub use data::FitData;
pub use law::{FitLaw, NAMES};
pub use microfacet_law::MicrofacetLaw;
pub use nearest::{NearestLaw, nearest};
pub use report::{Fit, Fits, Parameters};
pub use sample::FitSample;

use rayon::prelude::*;

use crate::campaign::{Campaign, Optics};

use self::nodes::Lobe;
use self::pilot::{Pilot, pilot};
use self::solve::{EXACT, FitLayout, NEAR, Problem};
use self::spread::ParameterSpread;

/// How much narrower than planned a lobe may come out before the nodes are laid out anew.
const NARROWER: f64 = 0.7;
/// How far n - 1 may come out from what the nodes were laid out for, as a logarithm: they are dense where facets end.
const FARTHER: f64 = 0.01;
/// Layouts of the nodes at most.
const LAYOUTS: usize = 4;
/// Values of one colour that the first pass looks at.
const FIRST_PASS: usize = 2048;
/// How many times the best divergence a model may have in the first pass to be fitted to all values: where all are
/// compared, and where only the best is asked for.
const CONTENDERS: f64 = 4.0;
const CONTENDERS_FOR_BEST: f64 = 1.5;

/// A model at its best parameters.
pub(crate) struct Fitted {
    law: FitLaw,
    params: Vec<f64>,
    shapes: usize,
    /// Of all values, also where fewer were fitted.
    divergence: f64,
    converged: bool,
    /// Values of one colour that were fitted.
    values: usize,
    /// Means, [colour][entry].
    model: Vec<Vec<f64>>,
    /// Parameters on a bound.
    on_bound: Vec<usize>,
    /// `None` for models that the first pass left behind.
    spread: Option<ParameterSpread>,
}

/// Fits every law of `laws` and ranks them, best first.
///
/// - Where there are realisations (two at least), errors are a jackknife over them in which everything, weights too,
///   follows the realisation that is left out.
/// - Of large tables some values are fitted first; models that are four times as far off there as the best one stay
///   as they are.
/// - Cost: about 10 evaluations of 16 nodes a bin for each parameter and fit.
// Tested by tests/it/fit.rs.
pub fn fit(data: &FitData, laws: &[FitLaw]) -> Fits {
    fit_contenders(data, laws, CONTENDERS)
}

/// The same where models that are `farther` times as far off as the best one stay as the first pass left them.
fn fit_contenders(data: &FitData, laws: &[FitLaw], farther: f64) -> Fits {
    let guess = pilot(data);
    let (all, some) = (FitSample::whole(data), FitSample::drawn(data, FIRST_PASS));
    let (starts, lobe) = started(data, laws, &guess, &some);
    let layout = FitLayout::new(data, &all, lobe);
    let least = starts.iter().map(|start| start.divergence).fold(f64::INFINITY, f64::min);
    let fits = starts.into_par_iter().map(|start| {
        let problem = Problem::new(data, &layout, start.law);
        if !some.is_whole && start.divergence > farther * least {
            let state = problem.at(start.params);
            return fitted(&problem, state, start.converged, &some);
        }
        let (state, converged) = problem.solve(start.params, EXACT);
        let spread = spread::spread(data, &problem, &state);
        Fitted { spread: Some(spread), ..fitted(&problem, state, converged, &all) }
    });
    report::report(data, fits.collect())
}

/// The models that a table can be tested against, its surface's own among them; none for facets under an interface.
pub fn models(data: &FitData, campaign: Option<&Campaign>) -> Vec<FitLaw> {
    if campaign.is_some_and(|campaign| matches!(campaign.optics, Optics::Layered { .. })) {
        return Vec::new();
    }
    let own = campaign.map_or(Vec::new(), |campaign| FitLaw::of_surface(&campaign.surface.kind, data));
    FitLaw::all(data).into_iter().chain(own).collect()
}

/// The best of `laws` (at least one).
pub fn best(data: &FitData, laws: &[FitLaw]) -> Fit {
    fit_contenders(data, laws, CONTENDERS_FOR_BEST).fits.swap_remove(0)
}

/// The fits to some values, and what the nodes have to resolve.
fn started(data: &FitData, laws: &[FitLaw], guess: &Pilot, sample: &FitSample) -> (Vec<Fitted>, Lobe) {
    let alpha = (guess.log_alpha - guess.stretch[0].hypot(guess.stretch[1])).exp();
    let mut lobe = Lobe { alpha, eta: guess.eta(data) };
    let mut round = 0;
    loop {
        round += 1;
        let layout = FitLayout::new(data, sample, lobe);
        let fits = laws.par_iter().map(|&law| {
            let problem = Problem::new(data, &layout, law);
            let amplitudes = law.amplitudes(data.perfect_mirror);
            let start = &[0.5, 0.05][..amplitudes.per_colour()];
            let params = [law.start(guess), start.repeat(data.value.len())].concat();
            let (state, converged) = problem.solve(params, NEAR);
            fitted(&problem, state, converged, sample)
        });
        let fits: Vec<Fitted> = fits.collect();
        let narrowest = |fit: &Fitted| fit.law.narrowest(&fit.params[..fit.shapes]);
        let narrowest = fits.iter().filter_map(narrowest).fold(f64::INFINITY, f64::min);
        let wide = narrowest >= NARROWER * lobe.alpha || narrowest <= 1e-3 * lobe.alpha;
        let best = fits.iter().min_by(|a, b| a.divergence.total_cmp(&b.divergence));
        let eta = best.and_then(|best| best.law.eta(&best.params[..best.shapes])).unwrap_or(lobe.eta);
        let near = ((eta - 1.0) / (lobe.eta - 1.0)).abs().ln().abs() < FARTHER;
        if wide && near || round == LAYOUTS {
            return (fits, lobe);
        }
        lobe = Lobe { alpha: if wide { lobe.alpha } else { narrowest }, eta };
    }
}

fn fitted(problem: &Problem, state: solve::State, converged: bool, sample: &FitSample) -> Fitted {
    Fitted {
        law: problem.law,
        shapes: problem.shapes,
        divergence: state.divergence,
        converged,
        values: sample.entries.len(),
        model: problem.model(&state),
        on_bound: problem.on_bound(&state.params),
        params: state.params,
        spread: None,
    }
}
