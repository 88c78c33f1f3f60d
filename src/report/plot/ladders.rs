//! Error against samples, from the document of `gonio bench`: for the page, and as a picture of its own.

use super::chart::{curve, ends};
use super::drawing::{Drawing, heading};
use crate::bench::{BenchAnswer, FittedLadder, LadderFit, MeasuredRung, Varies};
use crate::report::plot::{
    Chart, ChartAxis, Marker, Series, SeriesStyle, escaped, model_style, series_style,
};

/// The rules for charts are those of the page.
const PAGE_STYLE: &str = include_str!("../html/assets/page.css");
/// Room for the words above a chart of the picture.
const CAPTION: f64 = 30.0;

/// How noise alone falls.
const GUIDE: SeriesStyle = SeriesStyle { colour: "#777", dashes: "8 5", marker: Marker::Off, line: true };

/// By this a picture is recognised as one of ours.
pub const MARK: &str = "data-made-by=\"gonio bench\"";

/// A chart for each ladder that has an error above 0.
// Tested by `rungs_without_an_error_are_left_out`.
pub fn charts(bench: &BenchAnswer) -> Vec<Chart> {
    bench.ladders.iter().filter_map(|ladder| chart(ladder, &bench.rows)).collect()
}

/// The charts below each other.
pub fn picture(bench: &BenchAnswer) -> String {
    let (mut inner, mut width, mut height) = (Drawing::default(), 0.0f64, 0.0);
    for ladder in &bench.ladders {
        let Some(chart) = chart(ladder, &bench.rows) else { continue };
        let size = chart.size();
        inner.add(format_args!(
            "<g class=\"chart\" transform=\"translate(0 {height})\"><text x=\"8\" y=\"20\">{}</text>\n\
             <g transform=\"translate(0 {CAPTION})\">{}\n{}</g></g>",
            escaped(&caption(bench, ladder)),
            heading(&escaped(&chart.title)),
            chart.content()
        ));
        (width, height) = (width.max(size[0]), height + CAPTION + size[1]);
    }
    document(&inner.text(), [width, height])
}

/// A picture that stands alone.
pub(super) fn document(inner: &str, [width, height]: [f64; 2]) -> String {
    let style: String = PAGE_STYLE.lines().filter(|rule| rule.starts_with(".chart ")).collect();
    format!(
        "<svg {MARK} xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\">\n<style>{style}</style>\n<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n\
         {inner}</svg>\n"
    )
}

/// The last ladder of each bench in one chart: measured errors and their fits, next to how noise alone falls.
/// `None` where no ladder has an error above 0.
pub fn together(benches: &[BenchAnswer]) -> Option<Chart> {
    let mut series = Vec::new();
    let (mut samples, mut errors) = (Vec::new(), Vec::new());
    for (index, bench) in benches.iter().enumerate() {
        let Some(last) = bench.ladders.last() else { continue };
        let of_this = |row: &&MeasuredRung| row.varies == last.varies && row.error > 0.0;
        let points: Vec<[f64; 2]> =
            bench.rows.iter().filter(of_this).map(|row| [row.samples as f64, row.error]).collect();
        let (Some(first), Some(end)) = (points.first(), points.last()) else { continue };
        let style = series_style(index);
        let fitted = last.fit.map_or("no fit".into(), |LadderFit { b_low, b_high, .. }| {
            let low = if b_low > 0.0 { format!("{b_low:.1e}") } else { "0".into() };
            format!("b within [{low}, {b_high:.1e}]")
        });
        if let Some(LadderFit { a, b, .. }) = last.fit {
            let line = SeriesStyle { marker: Marker::Off, line: true, ..style };
            series.push(Series::new("", curve(first[0], end[0], |n| (a / n + b * b).sqrt()), line));
        }
        samples.extend(points.iter().map(|point| point[0]));
        errors.extend(points.iter().map(|point| point[1]));
        let label = format!("{}: {fitted}", bench.name);
        series.push(Series::new(label, points, SeriesStyle { line: false, ..style }));
    }
    if series.is_empty() {
        return None;
    }
    let (samples, errors) = (ends(samples.into_iter()), ends(errors.into_iter()));
    let fall = |n: f64| errors[1] * (samples[0] / n).sqrt();
    series.insert(0, Series::new("1/√N", curve(samples[0], samples[1], fall), GUIDE));
    Some(Chart {
        title: "Distance from the formula".into(),
        x: ChartAxis::decades("samples of one incidence, N", samples),
        y: ChartAxis::decades("flux-weighted L1 of order 1", errors),
        series,
    })
}

/// All benches in one picture that stands alone.
pub fn picture_together(benches: &[BenchAnswer]) -> String {
    let mut inner = Drawing::default();
    let chart = together(benches);
    if let Some(chart) = &chart {
        let title = heading(&escaped(&chart.title));
        inner.add(format_args!("<g class=\"chart\">{title}\n{}</g>", chart.content()));
    }
    document(&inner.text(), chart.map_or([0.0; 2], |chart| chart.size()))
}

/// What the errors are of, and what the ladder's fit gives.
fn caption(bench: &BenchAnswer, ladder: &FittedLadder) -> String {
    let fit = ladder.fit.map_or("no fit".into(), |LadderFit { b, b_low, b_high, .. }| {
        format!("b = {b:.2e} [{b_low:.1e}, {b_high:.1e}]")
    });
    format!("{}: {fit}; truth: {}", bench.name, bench.truth_name)
}

/// Each rung with the range of its replicates, the fit sqrt(a/N + b^2), its b, and how noise alone falls.
fn chart(ladder: &FittedLadder, rows: &[MeasuredRung]) -> Option<Chart> {
    let of_this = |row: &&MeasuredRung| row.varies == ladder.varies && row.samples > 0 && row.error > 0.0;
    let rows: Vec<&MeasuredRung> = rows.iter().filter(of_this).collect();
    let measured: Vec<[f64; 2]> = rows.iter().map(|row| [row.samples as f64, row.error]).collect();
    let (first, last) = (*measured.first()?, *measured.last()?);
    let along = |error: &dyn Fn(f64) -> f64| curve(first[0], last[0], error);
    let from = ladder.fit.map_or(first[1], |fit| (fit.a / first[0]).sqrt());
    let mut series = vec![Series::new("1/√N", along(&|n| from * (first[0] / n).sqrt()), GUIDE)];
    if let Some(LadderFit { a, b, .. }) = ladder.fit {
        let solid = SeriesStyle { dashes: "", ..model_style(1) };
        series.push(Series::new("√(a/N + b²)", along(&|n| (a / n + b * b).sqrt()), solid));
        if b > 0.0 {
            series.push(Series::new("b", along(&|_| b), SeriesStyle { dashes: "2 4", ..solid }));
        }
    }
    let points = SeriesStyle { line: false, ..series_style(0) };
    let range = SeriesStyle { marker: Marker::Off, line: true, ..points };
    for row in &rows {
        let replicates = row.errors.iter().filter(|error| **error > 0.0);
        series.push(Series::new("", replicates.map(|&error| [row.samples as f64, error]).collect(), range));
    }
    series.push(Series::new("measured", measured, points));
    let errors = rows.iter().flat_map(|row| row.errors.iter().chain([&row.error])).filter(|e| **e > 0.0);
    let errors = ends(errors.copied());
    let slope =
        ladder.fit.map_or(String::new(), |fit| format!(", slope {:.3} ± {:.3}", fit.slope, fit.slope_se));
    let what = match ladder.varies {
        Varies::Realisations => "more realisations",
        Varies::Samples => "more samples in each",
    };
    Some(Chart {
        title: format!("Error: {what}{slope}"),
        x: ChartAxis::decades("samples of one incidence, N", [first[0], last[0]]),
        y: ChartAxis::decades("flux-weighted L1 of order 1", errors),
        series,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rungs_without_an_error_are_left_out() {
        let row = |samples: u64, error: f64| MeasuredRung {
            varies: Varies::Samples,
            samples,
            realisations: 1,
            seconds: 1.0,
            rays_per_s: 1.0,
            error,
            efficiency: None,
            errors: vec![error],
            closure: None,
        };
        let rows = [row(100, 0.1), row(400, 0.0), row(1600, 0.025)];
        let of = |varies: Varies| chart(&FittedLadder { varies, fit: None }, &rows);
        assert!(of(Varies::Realisations).is_none());
        let chart = of(Varies::Samples).expect("a chart");
        let measured = &chart.series.last().expect("measured").points;
        assert_eq!(measured[..], [[100.0, 0.1], [1600.0, 0.025]]);
    }
}
