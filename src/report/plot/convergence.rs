//! Error against samples, from the JSON document of `gonio bench` or from what a run saw on its own way.

use serde_json::Value;

use super::chart::{Chart, ChartAxis, Marker, Series, SeriesStyle, model_style, series_style};
use super::plots::{spread, stop_name};
use crate::report::slices::Scene;
use crate::report::summary::{ErrorLook, StopSummary};

/// Points of a fitted curve.
const CURVE: u32 = 60;

/// A chart for each ladder of the document; an error says why it is none.
pub fn charts(bench: &Value) -> Result<Vec<Chart>, String> {
    let missing = "is no answer of `gonio bench`: it has no ladders";
    let ladders = bench["ladders"].as_array().ok_or(missing)?;
    let rows = bench["rows"].as_array().ok_or("is no answer of `gonio bench`: it has no rows")?;
    let charts: Vec<Chart> = ladders.iter().filter_map(|ladder| chart(ladder, rows)).collect();
    if charts.is_empty() { Err("holds no rung with an error above 0".into()) } else { Ok(charts) }
}

/// Light angles that are drawn at most.
const MOST_ANGLES: usize = 4;

/// The errors that a run looked at on its way, from the stops of its summary; `None` where it looked fewer than twice.
///
/// The lines are least squares of err^2 = a/N + p^2 with relative weights: p is the patches' own spread.
pub fn looks(scene: &Scene, stops: &[StopSummary]) -> Option<Chart> {
    // A summary is a file that anybody may have changed: what has no logarithm is no point.
    let point = |look: &ErrorLook| {
        let point = [look.samples as f64, look.relative_error];
        point.iter().all(|value| *value > 0.0 && value.is_finite()).then_some(point)
    };
    let points = |stop: usize| -> Option<(usize, Vec<[f64; 2]>)> {
        let points: Vec<_> = stops.get(stop)?.looks.iter().filter_map(point).collect();
        (points.len() > 1).then_some((stop, points))
    };
    let sweep = scene.sweeps().into_iter().next()?;
    let looked: Vec<(usize, Vec<[f64; 2]>)> = sweep.stops.into_iter().filter_map(points).collect();
    let mut series = Vec::new();
    for (index, at) in spread(looked.len(), MOST_ANGLES).into_iter().enumerate() {
        let (stop, points) = looked[at].clone();
        let style = SeriesStyle { line: false, ..series_style(index) };
        let curve = SeriesStyle { colour: style.colour, ..model_style(index) };
        let label = stop_name(scene, stop);
        let fit = fitted(&points);
        let (first, last) = (points[0][0], points[points.len() - 1][0]);
        series.push(Series { label, points, error: vec![], style });
        let [a, b2] = fit;
        let steps = (0..=CURVE).map(|k| first * (last / first).powf(f64::from(k) / f64::from(CURVE)));
        let points = steps.map(|n| [n, (a / n + b2).sqrt()]).collect();
        let label = if index == 0 { "√(a/N + p²)".into() } else { String::new() };
        series.push(Series { label, points, error: vec![], style: curve });
    }
    let all = || series.iter().flat_map(|series| &series.points);
    let ends = |axis: usize| {
        all().map(|point| point[axis]).fold([f64::INFINITY, 0.0f64], |[l, h], v| [l.min(v), h.max(v)])
    };
    let ([first, last], errors) = (ends(0), ends(1));
    (!series.is_empty()).then(|| Chart {
        title: "Error against samples, as the run looked at it".into(),
        x: ChartAxis::decades("starts in each patch, N", [first, last]),
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

fn chart(ladder: &Value, rows: &[Value]) -> Option<Chart> {
    let of_this = rows.iter().filter(|row| row["varies"] == ladder["varies"]);
    let point = |row: &Value| Some([row["samples"].as_f64()?, row["error"].as_f64()?]);
    let measured: Vec<[f64; 2]> = of_this.filter_map(point).filter(|p| p[0] > 0.0 && p[1] > 0.0).collect();
    let (first, last) = (measured.first()?, measured.last()?);
    let curve = |error: &dyn Fn(f64) -> f64| {
        let at = |k: u32| first[0] * (last[0] / first[0]).powf(f64::from(k) / f64::from(CURVE));
        (0..=CURVE).map(at).map(|n| [n, error(n)]).collect::<Vec<_>>()
    };
    let fit = &ladder["fit"];
    let constants = fit["a"].as_f64().zip(fit["b"].as_f64());
    let from = constants.map_or(first[1], |(a, _)| (a / first[0]).sqrt());
    let guide = SeriesStyle { colour: "#777", dashes: "8 5", marker: Marker::Off, line: true };
    let line = |label: &str, points, style| Series { label: label.into(), points, error: vec![], style };
    let mut series = vec![line("1/√N", curve(&|n| from * (first[0] / n).sqrt()), guide)];
    if let Some((a, b)) = constants {
        series.push(line(
            "√(a/N + b²)",
            curve(&|n| (a / n + b * b).sqrt()),
            SeriesStyle { dashes: "", ..model_style(1) },
        ));
    }
    let points = SeriesStyle { line: false, ..series_style(0) };
    series.push(line("measured", measured.clone(), points));
    let errors =
        measured.iter().map(|p| p[1]).fold((f64::INFINITY, 0.0f64), |(l, h), e| (l.min(e), h.max(e)));
    let slope = fit["slope"].as_f64().map_or(String::new(), |slope| format!(", slope {slope:.3}"));
    let what = if ladder["varies"] == "realisations" { "more realisations" } else { "more samples in each" };
    Some(Chart {
        title: format!("Error: {what}{slope}"),
        x: ChartAxis::decades("samples of one stop, N", [first[0], last[0]]),
        y: ChartAxis::decades("flux-weighted L1 of order 1", [errors.0, errors.1]),
        series,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn another_document_is_refused_with_the_reason() {
        for (document, why) in [(json!({}), "no ladders"), (json!({ "ladders": [] }), "no rows")] {
            let answer = charts(&document).expect_err("must be refused");
            assert!(answer.contains(why), "{answer}");
        }
    }

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

    #[test]
    fn rungs_without_an_error_are_left_out() {
        let row = |n: u64, error: f64| json!({ "varies": "samples", "samples": n, "error": error });
        let document = json!({
            "ladders": [{ "varies": "samples", "fit": null }, { "varies": "realisations", "fit": null }],
            "rows": [row(100, 0.1), row(400, 0.0), row(1600, 0.025)],
        });
        let charts = charts(&document).expect("a chart");
        let measured = &charts[0].series.last().expect("measured").points;
        assert_eq!((charts.len(), &measured[..]), (1, &[[100.0, 0.1], [1600.0, 0.025]][..]));
    }
}
