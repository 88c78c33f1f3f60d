//! Cells and correlation length varied. Of random heights: the discrepancy belongs to the law of the heights, not to the
//! grid. Of grains: the same grains as heights, whose distance from the law of the grains is the grid's own.
//!
//! Input: a campaign of one roughness and its `[bench]` table. Output: a row for each patch size and correlation
//! length, a test whether all of them show the same discrepancy, and the power of the cells with which it falls.

use rayon::prelude::*;
use serde::Serialize;

use crate::campaign::{Alpha, Campaign, Resolution, SurfaceKind};
use crate::error::{Error, Result};
use crate::measure::{self, Measured, Patches, Plan, Specimen};
use crate::stats;
use crate::surface::SlopeCounts;
use crate::validate::error_measures::Figures;
use crate::validate::{Parts, Prediction, compare, expect};

/// Patches of each row whose slopes are counted.
const COUNTED_PATCHES: u64 = 4;

/// One patch size with one correlation length.
#[derive(Debug, Clone, Serialize)]
pub struct ResolutionRow {
    /// Cells per side.
    pub cells: u32,
    /// Correlation length in cells.
    pub correlation_cells: f64,
    /// Samples of one incidence, all realisations together.
    pub samples: u64,
    /// Realisations among them.
    pub realisations: u32,
    /// Wall time, making the patches included.
    pub seconds: f64,
    /// Rays followed in a second of it.
    pub rays_per_s: f64,
    /// Kolmogorov-Smirnov distance of the slopes of the first four patches together.
    pub ks: Option<f64>,
    /// The discrepancy `l1_model`: distance from the model with the noise taken off, mean over incidences.
    pub error: f64,
    /// Its standard error over realisations.
    pub error_se: f64,
    /// `l1_noise`, what was taken off.
    pub noise: f64,
    /// 1/(error^2 seconds).
    pub efficiency: f64,
}

/// Whether the rows differ by more than their errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Flatness {
    /// Weighted mean of the discrepancy.
    pub mean: f64,
    /// Its standard error.
    pub mean_se: f64,
    /// Sum of the squared deviations from it in standard errors.
    pub chi_square: f64,
    /// Its degrees of freedom.
    pub dof: usize,
    /// Probability of a larger one by chance.
    pub p_value: f64,
    /// Change for each doubling of the correlation length; null for one length.
    pub per_doubling: Option<f64>,
    /// Its standard error.
    pub per_doubling_se: Option<f64>,
}

/// How the discrepancy falls with the number of cells along a side: as cells^-power.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Convergence {
    /// The power, by weighted least squares on logarithms.
    pub power: f64,
    /// Its standard error, from the rows' own.
    pub power_se: f64,
}

/// The campaigns and plans of all rows; grains are measured as the heights that they have. Errors: those of planning any
/// of them.
pub fn settings(campaign: &Campaign, resolution: &Resolution) -> Result<Vec<(Campaign, Plan)>> {
    let pairs =
        resolution.cells.iter().flat_map(|&c| resolution.correlation_cells.iter().map(move |&l| (c, l)));
    let setting = |(cells, correlation_cells)| {
        let mut campaign = campaign.clone();
        campaign.surface.cells = cells;
        campaign.surface.correlation_cells = correlation_cells;
        if let Some(grains) = campaign.surface.kind.explicit_grains() {
            // As far as plan and tracing go, random heights of the same roughness.
            let alphas = grains.alphas.iter().map(|alpha| Alpha::new(alpha.x, alpha.y)).collect();
            campaign.surface.kind = SurfaceKind::Ggx(alphas);
        }
        measure::plan(&campaign).map(|plan| (campaign, plan))
    };
    pairs.map(setting).collect()
}

/// Measures every setting of `campaign` against the masking that this is tested against. Errors: `Usage` with fewer than
/// five realisations, where the noise cannot be taken off.
pub fn resolution(
    campaign: &Campaign,
    settings: &[(Campaign, Plan)],
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Vec<ResolutionRow>> {
    let Some((_, plan)) = settings.first() else { return Ok(Vec::new()) };
    // Cells do not enter the model.
    let truth = Prediction::of(campaign, &plan.grid).filter(|_| campaign.surface.realisations >= 5);
    let few = "at least 5 realisations, to distinguish noise from the rest";
    let truth = truth.ok_or_else(|| Error::Usage(format!("{}: {few}", campaign.name)))?;
    let truth = (&truth, expect::masking(campaign));
    let of_setting = |(setting, plan): &(Campaign, Plan)| {
        let grains = campaign.surface.kind.explicit_grains().is_some();
        let mut patches = Patches::prepare(if grains { campaign } else { setting }, &mut Vec::new())?;
        if let Patches::Grains { as_heights, .. } = &mut patches {
            *as_heights = Some(setting.surface.cells as usize);
        }
        row(setting, plan, patches, truth, progress)
    };
    settings.iter().map(of_setting).collect()
}

fn row(
    campaign: &Campaign,
    plan: &Plan,
    patches: Patches,
    truth: (&Prediction, &str),
    progress: &(dyn Fn(u64) + Sync),
) -> Result<ResolutionRow> {
    let (mut measured, cost) = measure::measure(campaign, plan, &patches, progress)?;
    let measured = measured.pop().ok_or_else(|| Error::Internal("a row without a table".into()))?;
    let missing = || Error::Internal("a comparison without a figure".into());
    let figures = discrepancy(&measured, truth).ok_or_else(missing)?;
    let error = figures.l1_model.ok_or_else(missing)?;
    let error_se = figures.l1_model_se.ok_or_else(missing)?;
    let noise = figures.l1_noise.ok_or_else(missing)?;
    Ok(ResolutionRow {
        cells: campaign.surface.cells,
        correlation_cells: campaign.surface.correlation_cells,
        samples: plan.samples * u64::from(plan.realisations),
        realisations: plan.realisations,
        seconds: cost.wall_s,
        rays_per_s: cost.rays_traced as f64 / cost.wall_s,
        ks: if matches!(patches, Patches::Grains { .. }) { None } else { ks(campaign, &patches)? },
        error,
        error_se,
        noise,
        efficiency: 1.0 / (error * error * cost.wall_s),
    })
}

/// The figures against the masking of this name.
fn discrepancy(measured: &Measured, (truth, masking): (&Prediction, &str)) -> Option<Figures> {
    let parts = Some(Parts { all: &measured.realisations, first_incidence: 0 });
    let comparisons = compare::compare(&measured.table, &measured.campaign, parts, truth);
    comparisons.iter().find(|comparison| comparison.masking == masking).map(|comparison| comparison.figures)
}

fn ks(campaign: &Campaign, patches: &Patches) -> Result<Option<f64>> {
    let Some(law) = Patches::law(campaign) else { return Ok(None) };
    let mut counts = SlopeCounts::new(law);
    let first = 0..COUNTED_PATCHES.min(campaign.surface.realisations.into());
    let made: Result<Vec<_>> = first.into_par_iter().map(|k| patches.realisation(k)).collect();
    for specimen in made? {
        if let Specimen::Patch(patch) = specimen {
            counts.add(&patch.field);
        }
    }
    Ok(counts.ks())
}

/// Weighted mean, chi-square about it, and weighted least squares on log2 of the correlation length. `None` with one
/// row, or where an error is 0.
// Tested by `rows_that_differ_by_their_errors_are_flat_and_a_trend_is_found`.
pub fn flatness(rows: &[ResolutionRow]) -> Option<Flatness> {
    if rows.len() < 2 || !rows.iter().all(|row| row.error_se > 0.0) {
        return None;
    }
    let weights: Vec<f64> = rows.iter().map(|row| row.error_se.powi(-2)).collect();
    let all: f64 = weights.iter().sum();
    let mean_of = |of: &dyn Fn(&ResolutionRow) -> f64| {
        rows.iter().zip(&weights).map(|(row, weight)| weight * of(row)).sum::<f64>() / all
    };
    let mean = mean_of(&|row| row.error);
    let chi_square = all * mean_of(&|row| (row.error - mean).powi(2));
    let points =
        rows.iter().zip(&weights).map(|(row, &weight)| (row.correlation_cells.log2(), row.error, weight));
    let (slope, spread) = weighted_slope(&points.collect::<Vec<_>>());
    let dof = rows.len() - 1;
    Some(Flatness {
        mean,
        mean_se: all.powf(-0.5),
        chi_square,
        dof,
        p_value: stats::chi_square_p(chi_square, dof),
        per_doubling: (spread > 0.0).then_some(slope),
        per_doubling_se: (spread > 0.0).then(|| spread.powf(-0.5)),
    })
}

/// Weighted least squares of log discrepancy on log cells. `None` with fewer than three sizes, several correlation
/// lengths, or where an error is 0.
// Tested by `the_power_of_the_cells_is_found`.
pub fn convergence(rows: &[ResolutionRow]) -> Option<Convergence> {
    let one_length = rows.windows(2).all(|pair| pair[0].correlation_cells == pair[1].correlation_cells);
    let known = rows.iter().all(|row| row.error > 0.0 && row.error_se > 0.0);
    if rows.len() < 3 || !one_length || !known {
        return None;
    }
    let point =
        |row: &ResolutionRow| (f64::from(row.cells).ln(), row.error.ln(), (row.error / row.error_se).powi(2));
    let (slope, spread) = weighted_slope(&rows.iter().map(point).collect::<Vec<_>>());
    Some(Convergence { power: -slope, power_se: spread.powf(-0.5) })
}

/// The slope of y on x by weighted least squares, and the weighted sum of squares of x about its mean: where weights are
/// inverse variances, the slope's own. Points are (x, y, weight).
fn weighted_slope(points: &[(f64, f64, f64)]) -> (f64, f64) {
    let all: f64 = points.iter().map(|point| point.2).sum();
    let middle = points.iter().map(|(x, _, weight)| weight * x).sum::<f64>() / all;
    let spread: f64 = points.iter().map(|(x, _, weight)| weight * (x - middle).powi(2)).sum();
    (points.iter().map(|(x, y, weight)| weight * (x - middle) * y).sum::<f64>() / spread, spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_of_the_cells_is_found() {
        let row = |k: i32| ResolutionRow {
            cells: 256 << k,
            correlation_cells: 8.0,
            error: 0.1 * 2f64.powf(-1.5 * f64::from(k)),
            error_se: 0.001 * 2f64.powf(-1.5 * f64::from(k)),
            ..rows([0.1; 4]).swap_remove(0)
        };
        let found = convergence(&[row(0), row(1), row(2)]).expect("three sizes");
        // Relative errors of 1 % at log 2 times -1, 0, 1 from the middle: 0.01/(ln 2 sqrt 2).
        assert!((found.power - 1.5).abs() < 1e-12, "{found:?}");
        assert!((found.power_se - 0.01 / (2f64.ln() * 2f64.sqrt())).abs() < 1e-12, "{found:?}");
    }

    fn rows(errors: [f64; 4]) -> Vec<ResolutionRow> {
        let row = |(k, error): (usize, f64)| ResolutionRow {
            cells: 512,
            correlation_cells: 4.0 * f64::from(1 << k),
            samples: 1,
            realisations: 16,
            seconds: 1.0,
            rays_per_s: 1.0,
            ks: None,
            error,
            error_se: 0.001,
            noise: 0.001,
            efficiency: 1.0,
        };
        errors.into_iter().enumerate().map(row).collect()
    }

    #[test]
    fn rows_that_differ_by_their_errors_are_flat_and_a_trend_is_found() {
        // Deviations of one error each: 4 of 3 degrees, p = 0.2615 (tables).
        let flat = flatness(&rows([0.021, 0.019, 0.021, 0.019])).expect("four rows");
        assert!((flat.mean - 0.02).abs() < 1e-15 && (flat.mean_se - 0.0005).abs() < 1e-15);
        assert!(
            (flat.chi_square - 4.0).abs() < 1e-9 && flat.dof == 3 && (flat.p_value - 0.2615).abs() < 1e-4
        );
        // 0.002 a doubling at 0, 1, 2, 3: spread 5, error 0.001/sqrt 5.
        let trend = flatness(&rows([0.020, 0.022, 0.024, 0.026])).expect("four rows");
        let (slope, se) =
            (trend.per_doubling.expect("four lengths"), trend.per_doubling_se.expect("four lengths"));
        assert!((slope - 0.002).abs() < 1e-12 && (se - 0.001 / 5f64.sqrt()).abs() < 1e-12);
        assert!(trend.p_value < 1e-3);
        assert_eq!(flatness(&rows([0.0; 4])[..1]), None);
    }
}
