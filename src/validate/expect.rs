//! What a table is tested against where its campaign says nothing: the discrepancy known of its surface.

use serde::Serialize;

use crate::campaign::{
    Alpha, Campaign, ExpectedMasking, GrainShape, Grains, Optics, SmithHeights, SurfaceKind,
};
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

/// Random heights without shadowing and masking, whose normals follow the law to a Kolmogorov-Smirnov distance of 1e-3
/// or so: no table of them is D F/(4 cos cos) to the last bin, and with enough samples every one would miss a bar of 0.
const NORMALS: f64 = 0.002;
/// The same where alpha_x and alpha_y differ: up to 60 degrees, and up to 75.
const BRUSHED_NORMALS: [(f64, f64); 2] = [(60.0, 0.006), (75.0, 0.012)];
/// Largest ratio of roughnesses for which that is known.
const LARGEST_RATIO: f64 = 4.0;

/// The bar on a campaign's `l1_model`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bar {
    /// Which masking it speaks of.
    pub masking: &'static str,
    /// The bar.
    pub l1_model: f64,
}

/// The one masking that the campaign's surface has; `None` for random heights, where none is exact.
fn own_masking(campaign: &Campaign) -> Option<&'static str> {
    match &campaign.surface.kind {
        SurfaceKind::Mirror => Some("none"),
        SurfaceKind::VGroove { .. } => Some("v_cavity"),
        SurfaceKind::Smith(smith) if smith.heights == SmithHeights::Correlated => Some("height_correlated"),
        SurfaceKind::Smith(_) => Some("separable"),
        SurfaceKind::Grains(grains) if campaign.trace.visibility && grains.shape == GrainShape::Grains => {
            Some("grains")
        }
        _ if !campaign.trace.visibility => Some("none"),
        _ => None,
    }
}

/// The masking that a campaign is tested against: its surface's own, else the one that it names, else the height-correlated.
pub fn masking(campaign: &Campaign) -> &'static str {
    own_masking(campaign).unwrap_or(match campaign.expect.masking {
        Some(ExpectedMasking::Separable) => "separable",
        Some(ExpectedMasking::DirectionCorrelated) => "direction_correlated",
        Some(ExpectedMasking::HeightCorrelated) | None => "height_correlated",
    })
}

/// The bar that the campaign sets, or that its surface is known to keep; `None` where nothing is known.
///
/// 0 says that nothing but noise lies between table and model, bin by bin: mirror, V-groove, grains and the statistical
/// Smith surface, which are exact by construction. Random heights keep a discrepancy: with shadowing the one of
/// `KNOWN`, without it that of their own slopes.
// Tested by `without_visibility_the_patches_own_slopes_are_allowed_for`,
// `exact_surfaces_are_held_to_nothing_but_noise`.
pub fn bar(campaign: &Campaign, grid: &Grid) -> Option<Bar> {
    let matt = matches!(campaign.optics, Optics::Diffuse { .. } | Optics::Layered { .. });
    let left_out = match campaign.surface.kind {
        SurfaceKind::File(_) => return None,
        // What is known of heights is known of mirrors.
        _ if matt && campaign.surface.kind.is_random_heights() => None,
        // Of pits, and of heights with such normals, no masking is known.
        SurfaceKind::Grains(Grains { shape: GrainShape::Pits | GrainShape::Heights, .. }) => None,
        SurfaceKind::Smith(_)
        | SurfaceKind::Grains(_)
        | SurfaceKind::Mirror
        | SurfaceKind::VGroove { .. } => Some(0.0),
        // Gaussian heights are Beckmann's, whatever waves they are made of. Student's laws lie between GGX and Beckmann, and so does what their surfaces keep (`configs/tails`).
        SurfaceKind::Ggx(_)
        | SurfaceKind::Beckmann { .. }
        | SurfaceKind::StudentT { .. }
        | SurfaceKind::BlinnPhong { .. }
        | SurfaceKind::Psd(_) => known(campaign, grid),
    };
    campaign.expect.l1_model.or(left_out).map(|l1_model| Bar { masking: masking(campaign), l1_model })
}

/// The same for light that has gone through the surface: of random heights nothing is known.
pub fn bar_through(campaign: &Campaign) -> Option<Bar> {
    let exact = matches!(campaign.surface.kind, SurfaceKind::Smith(_) | SurfaceKind::Mirror);
    let l1_model = campaign.expect.l1_model.or(exact.then_some(0.0))?;
    Some(Bar { masking: masking(campaign), l1_model })
}

/// The mean over the incidences of what random heights are known to keep: with shadowing MARGIN times the table, at the
/// larger of the two roughnesses. `None` where one incidence is beyond what is known.
fn known(campaign: &Campaign, grid: &Grid) -> Option<f64> {
    let alpha = campaign.alphas()[0]?;
    let at = |incidence: usize| {
        let theta_deg = grid.incidence_deg(incidence).0;
        if campaign.trace.visibility {
            Some(MARGIN * interpolated(alpha.x.max(alpha.y).max(ALPHAS[0]), theta_deg)?)
        } else {
            of_normals(alpha, theta_deg)
        }
    };
    let values = (0..grid.incidences()).map(at).collect::<Option<Vec<f64>>>()?;
    Some(crate::stats::mean(&values))
}

/// What is known without shadowing and masking.
fn of_normals(alpha: Alpha, theta_deg: f64) -> Option<f64> {
    let ratio = alpha.x.max(alpha.y) / alpha.x.min(alpha.y);
    let (_, brushed) = BRUSHED_NORMALS.into_iter().find(|&(up_to, _)| theta_deg <= up_to)?;
    // 0.4/0.1 may round above 4.
    let known = ratio <= LARGEST_RATIO * (1.0 + f64::EPSILON);
    known.then_some(if ratio == 1.0 { NORMALS } else { brushed })
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
    use std::path::Path;

    use super::*;
    use crate::campaign;
    use crate::instrument::grid_of;

    #[test]
    fn known_discrepancies_are_met_at_the_nodes_and_between() {
        assert_eq!(interpolated(0.8, 75.0), Some(0.066));
        assert!((interpolated(0.4, 75.0).unwrap() - 0.0425).abs() < 1e-15);
        assert_eq!(interpolated(0.9, 75.0), None);
        assert_eq!(interpolated(0.5, 80.0), None);
    }

    /// The bar of a campaign that sets none.
    fn left_out(surface: &str, light: &str, trace: &str) -> Option<f64> {
        let text = format!(
            "name = \"bar\"\n[surface]\nrealisations = 4\n[surface.{surface}\n[light]\n{light}\n\
             [sensor.hemisphere]\n[trace]\n{trace}\n[stop]\nsamples = 65536\n"
        );
        let parsed = campaign::parse(&text, "bar", Path::new("")).unwrap_or_else(|e| panic!("{e}"));
        bar(&parsed.campaign, &grid_of(&parsed.campaign)).map(|bar| bar.l1_model)
    }

    const FOUR_ANGLES: &str = "theta_i_deg = [0, 30, 60, 75]";

    #[test]
    fn without_visibility_the_patches_own_slopes_are_allowed_for() {
        let off = "visibility = false";
        assert_eq!(left_out("ggx]\nalpha = 0.5", FOUR_ANGLES, off), Some(0.002));
        assert_eq!(left_out("beckmann]\nalpha = 0.1", FOUR_ANGLES, off), Some(0.002));
        let brushed = "ggx]\nalpha_x = 0.1\nalpha_y = 0.4";
        let at = |theta: &str| {
            left_out(brushed, &format!("{theta}\nazimuth = \"absolute\"\nphi_i_deg = [0, 45]"), off)
        };
        assert_eq!(at("theta_i_deg = [0, 60]"), Some(0.006));
        // A mean over incidences, as the figure itself.
        assert!((at(FOUR_ANGLES).unwrap() - 0.0075).abs() < 1e-15);
        assert_eq!(at("theta_i_deg = [0, 80]"), None);
        assert_eq!(left_out("ggx]\nalpha = 0.5", "theta_i_deg = [0, 80]", off), None);
        let needles = "ggx]\nalpha_x = 0.1\nalpha_y = 0.5";
        let average = "theta_i_deg = [0]\naverage_azimuth = true";
        assert_eq!(left_out(needles, average, off), None);
    }

    #[test]
    fn exact_surfaces_are_held_to_nothing_but_noise() {
        let smith = "smith]\nndf = \"ggx\"\nheights = \"correlated\"\nalpha = 0.5";
        for surface in [smith, "mirror]", "v_groove]\nslope = 0.5"] {
            let light = "theta_i_deg = [0, 60]\nazimuth = \"absolute\"\nphi_i_deg = [0]";
            assert_eq!(left_out(surface, light, "bounces = 1"), Some(0.0), "{surface}");
        }
    }
}
