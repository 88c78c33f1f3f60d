//! Error against samples, from what a run saw on its own way.

use super::chart::{curve, ends};
use super::plots::{incidence_name, spread};
use crate::report::plot::{Chart, ChartAxis, Series, SeriesStyle, model_style, series_style};
use crate::report::slices::Scene;
use crate::report::summary::{ErrorLook, IncidenceSummary};

/// Light angles that are drawn at most.
const MOST_ANGLES: usize = 4;

/// The errors that a run looked at on its way, from the incidences of its summary; `None` where it looked fewer than twice.
///
/// The lines are least squares of err^2 = a/N + p^2 with relative weights: p is the patches' own spread.
pub fn looks(scene: &Scene, incidences: &[IncidenceSummary]) -> Option<Chart> {
    // A summary is a file that anybody may have changed: what has no logarithm is no point.
    let point = |look: &ErrorLook| {
        let point = [look.samples as f64, look.relative_error];
        point.iter().all(|value| *value > 0.0 && value.is_finite()).then_some(point)
    };
    let points = |incidence: usize| -> Option<(usize, Vec<[f64; 2]>)> {
        let points: Vec<_> = incidences.get(incidence)?.looks.iter().filter_map(point).collect();
        (points.len() > 1).then_some((incidence, points))
    };
    let sweep = scene.sweeps().into_iter().next()?;
    let looked: Vec<(usize, Vec<[f64; 2]>)> = sweep.incidences.into_iter().filter_map(points).collect();
    let mut series = Vec::new();
    for (index, at) in spread(looked.len(), MOST_ANGLES).into_iter().enumerate() {
        let (incidence, points) = looked[at].clone();
        let style = SeriesStyle { line: false, ..series_style(index) };
        let dashed = SeriesStyle { colour: style.colour, ..model_style(index) };
        let [a, b2] = fitted(&points);
        let (first, last) = (points[0][0], points[points.len() - 1][0]);
        series.push(Series::new(incidence_name(scene, incidence), points, style));
        let label = if index == 0 { "√(a/N + p²)" } else { "" };
        series.push(Series::new(label, curve(first, last, |n| (a / n + b2).sqrt()), dashed));
    }
    let of_axis = |axis: usize| ends(series.iter().flat_map(|s| &s.points).map(|point| point[axis]));
    let (samples, errors) = (of_axis(0), of_axis(1));
    (!series.is_empty()).then(|| Chart {
        title: "Error against samples, as the run looked at it".into(),
        x: ChartAxis::decades("surface samples in each patch, N", samples),
        y: ChartAxis::decades("median relative error of the bright bins", errors),
        series,
    })
}

/// a >= 0 and p^2 >= 0 of err^2 = a/N + p^2, each error^2 weighed by its own size.
fn fitted(points: &[[f64; 2]]) -> [f64; 2] {
    let mut s = [0.0; 5];
    for &[n, error] in points {
        let (x, y, w) = (1.0 / n, error * error, error.powi(-4));
        for (sum, term) in s.iter_mut().zip([w, w * x, w * x * x, w * y, w * x * y]) {
            *sum += term;
        }
    }
    let [one, x, xx, y, xy] = s;
    let a = (one * xy - x * y) / (one * xx - x * x);
    let p2 = (y - a * x) / one;
    match (a > 0.0, p2 > 0.0) {
        (true, true) => [a, p2],
        (true, false) => [xy / xx, 0.0],
        _ => [0.0, y / one],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_finds_noise_and_the_patches_spread() {
        let of = |a: f64, p2: f64| {
            let looks = [1.0, 2.0, 4.0, 8.0].map(|n: f64| [n, (a / n + p2).sqrt()]);
            fitted(&looks)
        };
        for (a, p2) in [(0.5, 0.01), (2.0, 0.0), (0.0, 0.04)] {
            let [found_a, found_p2] = of(a, p2);
            // Sums of four terms of one size.
            assert!((found_a - a).abs() < 1e-12 && (found_p2 - p2).abs() < 1e-12, "{found_a} {found_p2}");
        }
    }
}
