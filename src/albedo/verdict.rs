//! Whether measured albedos are those of the formula, and whether all light is accounted for.

use serde::Serialize;

use super::table::{Axes, Cell, Quantity};
use crate::stats::{mean_and_se, sidak, student_limit};

/// The chance that all of a test's cells are as they should be and one is called different.
const LEVEL: f64 = 0.01;
/// Sums of shares in f64: where nothing is left to chance, a standard error is smaller than their rounding.
const ROUNDING: f64 = 1e-12;

/// A measured quantity, its formula, and which share of the formula may lie between the two, by cell: 0 where the formula is
/// exact, `None` where nothing is known.
pub(super) struct Pair {
    pub measured: String,
    pub formula: String,
    pub allowed: Vec<Option<f64>>,
}

/// One test over many cells.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Test {
    /// What is tested.
    pub name: &'static str,
    /// Cells that were.
    pub cells: usize,
    /// The largest distance in standard errors.
    pub largest_t: f64,
    /// What it may be: Student's t, 1 % for all cells together.
    pub limit: f64,
    /// Where it is.
    pub at: String,
}

/// What is certified of a measured table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// Order 1 against the formula; null where no cell could be tested.
    pub order_1: Option<Test>,
    /// R + T + rest against 1.
    pub furnace: Option<Test>,
    /// Whether every test holds.
    pub ok: bool,
}

impl Certificate {
    /// The tests of all pairs, and of the light of every cell by realisation.
    pub(super) fn of(
        quantities: &[Quantity],
        pairs: &[Pair],
        closures: &[Vec<f64>],
        axes: &Axes,
        realisations: usize,
    ) -> Self {
        let by_name = |name: &str| quantities.iter().find(|quantity| quantity.name == name);
        let mut distances = Vec::new();
        for pair in pairs {
            let (Some(measured), Some(formula)) = (by_name(&pair.measured), by_name(&pair.formula)) else {
                continue;
            };
            let both = measured.cells.iter().zip(&formula.cells).zip(&pair.allowed).enumerate();
            distances.extend(both.filter_map(|(cell, ((measured, formula), allowed))| {
                let t = distance(measured, formula, (*allowed)?)?;
                Some((t, format!("{} {}", pair.measured, place(axes, cell))))
            }));
        }
        let order_1 = Test::of("order 1 against the formula", distances, realisations);
        let materials = closures.len() / axes.cells();
        let closed = closures.iter().enumerate().filter_map(|(k, closure)| {
            let (mean, se) = mean_and_se(closure.iter().copied());
            Some(((mean - 1.0).abs() / se?.max(ROUNDING), place(axes, k / materials)))
        });
        let furnace = Test::of("all light adds up to 1", closed.collect(), realisations);
        let ok = [&order_1, &furnace].into_iter().flatten().all(Test::holds);
        Certificate { order_1, furnace, ok }
    }

    /// A line for each test, and the verdict.
    pub fn lines(&self) -> Vec<String> {
        let tests = [&self.order_1, &self.furnace].into_iter().flatten();
        let mut lines: Vec<String> = tests.map(Test::line).collect();
        if self.order_1.is_none() {
            lines.insert(
                0,
                "order 1 against the formula: not judged: no formula, or a single realisation".into(),
            );
        }
        lines.push(format!("verdict: {}", if self.ok { "ok" } else { "differs" }));
        lines
    }

    /// What differs, one line each.
    pub fn failures(&self) -> Vec<String> {
        [&self.order_1, &self.furnace]
            .into_iter()
            .flatten()
            .filter(|test| !test.holds())
            .map(Test::line)
            .collect()
    }
}

impl Test {
    fn of(name: &'static str, distances: Vec<(f64, String)>, realisations: usize) -> Option<Self> {
        let cells = distances.len();
        let (largest_t, at) = distances.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let limit = student_limit(sidak(LEVEL, cells), realisations - 1);
        Some(Test { name, cells, largest_t, limit, at })
    }

    fn holds(&self) -> bool {
        self.largest_t <= self.limit
    }

    fn line(&self) -> String {
        let Test { name, cells, largest_t, limit, at } = self;
        let word = if self.holds() { "ok" } else { "differs" };
        format!("{name}: {word}: largest |t| {largest_t:.2} of {limit:.2} over {cells} cells, at {at}")
    }
}

/// The distance beyond what is allowed, in standard errors; `None` where that error is not known.
fn distance(measured: &Cell, formula: &Cell, allowed: f64) -> Option<f64> {
    let error = measured.error?.hypot(formula.error?).max(ROUNDING);
    let beyond = (measured.value - formula.value).abs() - allowed * formula.value;
    Some(beyond.max(0.0) / error)
}

/// A cell by its axes.
fn place(axes: &Axes, cell: usize) -> String {
    let (mus, alphas) = (axes.mu.len(), axes.alpha.len());
    let eta = axes.eta.get(cell / mus / alphas).map_or(String::new(), |eta| format!("eta {eta}, "));
    format!("{eta}alpha {}, mu {:.4}", axes.alpha[cell / mus % alphas], axes.mu[cell % mus])
}
