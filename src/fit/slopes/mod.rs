//! The law of a surface's own slopes: GGX, Beckmann or Student's t, fitted to its facets, not to its table.
//!
//! Input: a heightfield. Output: for every law its parameters with errors over tiles, how likely the facets are under it,
//! and how far the shares of the slopes are off. All facets have the same area on the mean plane, so each counts once.
//!
//! Neighbouring facets have much the same slope, so a facet is no independent draw: errors come from square tiles, which
//! have to be several correlation lengths wide.

mod likelihood;
mod solve;
mod tiles;

use serde::Serialize;

pub use likelihood::{SlopeDensity, SlopeFamily};
pub use tiles::SlopeTiles;

use super::report::Named;
use crate::stats;

/// A law at its best parameters.
#[derive(Debug, Clone, Serialize)]
pub struct SlopeFit {
    /// The law with these parameters.
    #[serde(skip)]
    pub density: SlopeDensity,
    /// `ggx`, `beckmann` or `student_t`.
    pub law: &'static str,
    /// Whether two roughnesses and an axis were fitted.
    pub anisotropic: bool,
    /// alpha, or alpha_x, alpha_y and rotation_deg (of the axis of alpha_x in the map's frame, within 45 degrees of x); gamma
    /// of Student's t.
    pub parameters: Named<f64>,
    /// Standard errors over tiles; null where tiles do not tell.
    pub standard_errors: Named<f64>,
    /// Whether gamma stands at an end of what a surface can be made with: its law is another, or lies beyond.
    pub gamma_on_bound: bool,
    /// Mean logarithm of the density of a facet's slope, nats.
    pub log_likelihood: f64,
    /// That of the best law less this one, each less what its freedom gains on these very tiles (Takeuchi 1976).
    pub behind: f64,
    /// Its standard error over tiles; null for the best.
    pub behind_se: Option<f64>,
    /// Whether tiles do not tell it from the best law at 95 %; the best is like itself.
    pub alike: bool,
    /// Largest difference between the shares of facets, by the law and counted, whose slope is below any length.
    pub ks: f64,
}

/// All laws, the most likely first.
#[derive(Debug, Clone, Serialize)]
pub struct SlopeFits {
    /// Facets that were looked at, of those of the surface.
    pub facets: usize,
    /// Tiles, of so many along each side.
    pub tiles_per_side: usize,
    /// Mean slope along x and y: 0 where the map was levelled.
    pub mean_slope: [f64; 2],
    /// Root of the mean squared slope along x and y.
    pub rms_slope: [f64; 2],
    /// The laws.
    pub fits: Vec<SlopeFit>,
}

impl SlopeFit {
    /// The law and its axes in words.
    pub fn name(&self) -> String {
        format!("{}{}", self.law, if self.anisotropic { " with two roughnesses" } else { "" })
    }

    /// alpha_x, alpha_y, degrees of the axis of alpha_x, and gamma where it was fitted.
    pub fn shape(&self) -> ([f64; 2], f64, Option<f64>) {
        let get = |name| self.parameters.get(name);
        let one = get("alpha");
        let of = |name| one.or(get(name)).unwrap_or(f64::NAN);
        ([of("alpha_x"), of("alpha_y")], get("rotation_deg").unwrap_or(0.0), get("gamma"))
    }
}

/// Fits every law of `laws`, and ranks them.
///
/// - Needs two tiles at least for errors; without slopes, or laws, there is nothing to fit: `None`.
// Tested by tests/it/slopes.rs.
pub fn fit(tiles: &SlopeTiles, laws: &[SlopeFamily]) -> Option<SlopeFits> {
    if tiles.is_flat() {
        return None;
    }
    let solved: Vec<solve::Solved> = laws.iter().map(|&law| solve::solve(law, tiles)).collect();
    let worth = |solved: &solve::Solved| solved.log_likelihood - solved.optimism;
    let best = solved.iter().max_by(|a, b| worth(a).total_cmp(&worth(b)))?;
    let limit = stats::student_limit(0.05, (tiles.count() - 1).max(1));
    let one = |law: &solve::Solved| {
        let same = law.family == best.family;
        let behind = worth(best) - worth(law);
        let behind_se = (!same).then(|| tiles.se_of_mean(|k| best.by_tile[k] - law.by_tile[k])).flatten();
        let alike = same || behind_se.is_some_and(|se| behind <= limit * se);
        let (gamma, density) = (law.family.gamma(&law.params), law.family.at(&law.params));
        SlopeFit {
            density,
            law: law.family.name(),
            anisotropic: law.family.anisotropic,
            parameters: named(law.family, law.family.decoded(&law.params).into_iter().map(Some)),
            standard_errors: named(law.family, law.errors.iter().copied()),
            gamma_on_bound: law.family.fits_gamma() && solve::on_bound(gamma),
            log_likelihood: law.log_likelihood,
            behind,
            behind_se,
            alike,
            ks: tiles.ks(&density),
        }
    };
    let mut fits: Vec<SlopeFit> = solved.iter().map(one).collect();
    fits.sort_by(|a, b| a.behind.total_cmp(&b.behind));
    let (mean_slope, rms_slope) = tiles.moments();
    Some(SlopeFits { facets: tiles.facets(), tiles_per_side: tiles.per_side(), mean_slope, rms_slope, fits })
}

fn named(family: SlopeFamily, values: impl Iterator<Item = Option<f64>>) -> Named<f64> {
    Named(family.names().into_iter().map(String::from).zip(values).collect())
}
