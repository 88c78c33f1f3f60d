//! What a table is held to where its campaign says nothing: the discrepancy known of its surface.

use serde::Serialize;

use crate::campaign::{Campaign, ExpectedMasking, SmithHeights, SurfaceKind};
use crate::instrument::Grid;

/// Room for the spread of patches above the known discrepancy.
const MARGIN: f64 = 1.3;
/// Roughnesses and light angles of the table below.
const ALPHAS: [f64; 6] = [0.05, 0.1, 0.2, 0.3, 0.5, 0.8];
const ANGLES_DEG: [f64; 4] = [0.0, 30.0, 60.0, 75.0];
/// Discrepancy (flux-weighted L1) of random heightfields from height-correlated Smith masking, found beforehand with
/// another program on four patches of 1024^2 cells; 0.001 where it was below.
const KNOWN: [[f64; 4]; 6] = [
    [0.001, 0.001, 0.003, 0.005],
    [0.001, 0.002, 0.005, 0.011],
    [0.004, 0.005, 0.013, 0.026],
    [0.006, 0.008, 0.021, 0.036],
    [0.008, 0.017, 0.039, 0.049],
    [0.014, 0.034, 0.064, 0.066],
];

/// The bar on a campaign's `l1_model`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bar {
    /// Which masking it speaks of.
    pub masking: &'static str,
    /// The bar.
    pub l1_model: f64,
}

/// The masking that is exact on the campaign's surface; `None` for heights, where none is.
fn exact_masking(campaign: &Campaign) -> Option<&'static str> {
    match &campaign.surface.kind {
        SurfaceKind::Mirror => Some("none"),
        SurfaceKind::VGroove { .. } => Some("v_cavity"),
        SurfaceKind::Smith(smith) if smith.heights == SmithHeights::Correlated => Some("height_correlated"),
        SurfaceKind::Smith(_) => Some("separable"),
        _ if !campaign.trace.visibility => Some("none"),
        _ => None,
    }
}

/// The masking that a campaign is held to: the exact one, else the one that it names, else the height-correlated.
pub fn masking(campaign: &Campaign) -> &'static str {
    exact_masking(campaign).unwrap_or(match campaign.expect.masking {
        Some(ExpectedMasking::Separable) => "separable",
        Some(ExpectedMasking::DirectionCorrelated) => "direction_correlated",
        Some(ExpectedMasking::HeightCorrelated) | None => "height_correlated",
    })
}

/// The bar that the campaign sets, or that its surface is known to keep; `None` where nothing is known.
pub fn bar(campaign: &Campaign, grid: &Grid) -> Option<Bar> {
    if matches!(campaign.surface.kind, SurfaceKind::File(_)) {
        return None;
    }
    let known = if exact_masking(campaign).is_some() { Some(0.0) } else { known(campaign, grid) };
    campaign.expect.l1_model.or(known).map(|l1_model| Bar { masking: masking(campaign), l1_model })
}

/// MARGIN times the mean of the known discrepancy over the stops, at the larger of the two roughnesses; `None`
/// outside the table.
fn known(campaign: &Campaign, grid: &Grid) -> Option<f64> {
    let alpha = campaign.alphas()[0].map(|alpha| alpha.x.max(alpha.y))?;
    let at = |stop: usize| interpolated(alpha.max(ALPHAS[0]), grid.stop_deg(stop).0);
    let values = (0..grid.stops()).map(at).collect::<Option<Vec<f64>>>()?;
    Some(MARGIN * crate::stats::mean(&values))
}

/// Linear in both directions.
fn interpolated(alpha: f64, theta_deg: f64) -> Option<f64> {
    let (row, a) = place(&ALPHAS, alpha)?;
    let (column, b) = place(&ANGLES_DEG, theta_deg)?;
    let along = |row: usize| KNOWN[row][column] * (1.0 - b) + KNOWN[row][column + 1] * b;
    Some(along(row) * (1.0 - a) + along(row + 1) * a)
}

/// The interval of `axis` that holds `x`, and the place in it.
fn place(axis: &[f64], x: f64) -> Option<(usize, f64)> {
    let last = axis.len() - 1;
    if !(axis[0] <= x && x <= axis[last]) {
        return None;
    }
    let k = axis.partition_point(|&a| a <= x).clamp(1, last) - 1;
    Some((k, (x - axis[k]) / (axis[k + 1] - axis[k])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_discrepancies_are_met_at_the_nodes_and_between() {
        assert_eq!(interpolated(0.8, 75.0), Some(0.066));
        assert!((interpolated(0.4, 75.0).unwrap() - 0.0425).abs() < 1e-15);
        assert_eq!(interpolated(0.9, 75.0), None);
        assert_eq!(interpolated(0.5, 80.0), None);
    }
}
