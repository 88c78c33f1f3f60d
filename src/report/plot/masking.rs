//! The plot of masking given the normal: what the light sees of facets by their slope, against Smith's masking.

use super::plots::spread;
use crate::measure::accumulate::slopes::SlopeClass;
use crate::report::plot::{Chart, ChartAxis, Series, SeriesStyle, model_style, series_style};
use crate::report::slices::Scene;
use crate::report::summary::IncidenceSummary;
use crate::stats;

/// Light angles that are drawn at most.
const MOST_ANGLES: usize = 4;
/// Slopes shown, units of alpha.
const STEEPEST: f64 = 4.0;
/// Surface samples below which a class says nothing.
const FEWEST_SAMPLES: u64 = 400;

/// The chart from the summary's incidences at the first azimuth of the light; `None` where nothing was counted. Slopes are
/// `scaled` by alpha where the surface has one.
pub fn chart(scene: &Scene, incidences: &[IncidenceSummary], scaled: bool) -> Option<Chart> {
    let sweep = scene.sweeps().into_iter().next()?;
    let counted =
        |&incidence: &usize| Some((incidence, incidences.get(incidence)?.seen_by_slope.as_deref()?));
    let known: Vec<(usize, &[SlopeClass])> = sweep.incidences.iter().filter_map(counted).collect();
    let mut series = Vec::new();
    for (index, at) in spread(known.len(), MOST_ANGLES).into_iter().enumerate() {
        let (incidence, classes) = known[at];
        let theta = scene.table.grid.incidence_deg(incidence).0;
        let (points, error) = points(classes, scene.realisations);
        let style = SeriesStyle { line: false, ..series_style(index) };
        series.push(Series { label: format!("theta_i {theta}°"), points, error, style });
        let averaged = scene.table.grid.phi_r_relative;
        let smith = scene.prediction.and_then(|p| p.model.smith(scene.table.grid.wi(incidence), averaged));
        if let Some([g1, steepest]) = smith {
            let label = if index == 0 { "Smith's G1".into() } else { String::new() };
            let points = vec![[-STEEPEST, g1], [steepest.min(STEEPEST), g1]];
            let style = SeriesStyle { dashes: "9 4", colour: series_style(index).colour, ..model_style(0) };
            series.push(Series::new(label, points, style));
        }
    }
    (!series.is_empty()).then(|| Chart {
        title: "Masking given the normal: facets that the light sees".into(),
        x: ChartAxis::linear(
            if scaled {
                "slope along the light, alpha (−: towards it)"
            } else {
                "slope along the light (−: towards it)"
            },
            [-STEEPEST, STEEPEST],
        ),
        y: ChartAxis::linear("share of samples that the light sees", [0.0, 1.1]),
        series,
    })
}

/// (middle of the class, share) and the half-widths of 95 % intervals.
fn points(classes: &[SlopeClass], realisations: usize) -> (Vec<[f64; 2]>, Vec<f64>) {
    let limit = if realisations > 1 { stats::student_limit(0.05, realisations - 1) } else { 0.0 };
    let class = |&SlopeClass { slope: [low, high], starts, share, share_se }: &SlopeClass| {
        let (low, high) = low.zip(high)?;
        let share = share.filter(|_| starts >= FEWEST_SAMPLES)?;
        Some(([0.5 * (low + high), share], limit * share_se.unwrap_or(0.0)))
    };
    classes.iter().filter_map(class).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_without_ends_or_with_few_starts_are_left_out() {
        let class = |slope: [Option<f64>; 2], starts: u64| SlopeClass {
            slope,
            starts,
            share: Some(0.5),
            share_se: Some(0.1),
        };
        let classes = [
            class([None, Some(-4.0)], 900),
            class([Some(-1.0), Some(0.0)], 900),
            class([Some(0.0), Some(1.0)], 9),
        ];
        let (points, error) = points(&classes, 2);
        // Student's t with one degree of freedom: tan(0.475 pi) = 12.706.
        assert_eq!(points, [[-0.5, 0.5]]);
        assert!((error[0] - 1.270_6).abs() < 1e-4, "{error:?}");
    }
}
