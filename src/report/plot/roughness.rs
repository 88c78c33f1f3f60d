//! Autocorrelation and power spectrum of a measured map, before and after its preparation.

use super::axis::ChartAxis;
use super::chart::{Chart, Series, ends};
use super::drawing::{Drawing, heading};
use super::ladders::document;
use super::style::model_style;
use crate::surface::areal::Roughness;

/// Points of a curve at most.
const MOST_POINTS: usize = 240;
/// Densities below this part of the largest are rounding.
const SMALLEST: f64 = 1e-14;
/// Lags are shown up to so many decay lengths.
const DECAYS: f64 = 8.0;

/// Both charts below each other; `unit_um`: one unit of height.
pub fn picture(before: &Roughness, after: &Roughness, unit_um: Option<f64>) -> String {
    let (mut inner, mut width, mut height) = (Drawing::default(), 0.0f64, 0.0);
    for chart in
        [autocorrelation(before, after, unit_um), spectrum(before, after, unit_um)].into_iter().flatten()
    {
        let size = chart.size();
        inner.add(format_args!(
            "<g class=\"chart\" transform=\"translate(0 {height})\">{}\n{}</g>",
            heading(&chart.title),
            chart.content()
        ));
        (width, height) = (width.max(size[0]), height + size[1]);
    }
    document(&inner.text(), [width, height])
}

fn unit(unit_um: Option<f64>) -> (f64, &'static str) {
    unit_um.map_or((1.0, "unit of the heights"), |unit| (unit, "um"))
}

/// Against the lag along x and y; `None` of a flat map.
fn autocorrelation(before: &Roughness, after: &Roughness, unit_um: Option<f64>) -> Option<Chart> {
    let (scale, unit) = unit(unit_um);
    let all = [
        ("x, as read", &before.acf_x),
        ("y, as read", &before.acf_y),
        ("x, measured", &after.acf_x),
        ("y, measured", &after.acf_y),
    ];
    let longest =
        all.iter().filter_map(|(_, acf)| acf.last()).map(|[lag, _]| scale * lag).fold(0.0, f64::max);
    let decay = after.parameters.sal.map(|sal| DECAYS * scale * sal);
    let shown = decay.map_or(longest, |decay| decay.min(longest));
    let curve = |(index, (label, acf)): (usize, &(&str, &Vec<[f64; 2]>))| {
        let points: Vec<[f64; 2]> =
            acf.iter().map(|[lag, value]| [scale * lag, *value]).filter(|[lag, _]| *lag <= shown).collect();
        let step = points.len().div_ceil(MOST_POINTS).max(1);
        Series::new(*label, points.into_iter().step_by(step).collect(), model_style(index))
    };
    let series: Vec<Series> = all.iter().enumerate().map(curve).collect();
    let lowest = series.iter().flat_map(|series| &series.points).map(|[_, value]| *value).fold(0.0, f64::min);
    (after.parameters.sq > 0.0 && shown > 0.0).then(|| Chart {
        title: "Autocorrelation along x and y".into(),
        x: ChartAxis::linear(&format!("lag, {unit}"), [0.0, shown]),
        y: ChartAxis::linear("autocorrelation", [lowest.min(-0.2), 1.0]),
        series,
    })
}

/// Against the spatial frequency; `None` of a flat map.
fn spectrum(before: &Roughness, after: &Roughness, unit_um: Option<f64>) -> Option<Chart> {
    let (scale, unit) = unit(unit_um);
    let largest = after.psd.iter().chain(&before.psd).map(|[_, density]| *density).fold(0.0, f64::max);
    let curve = |(index, label, psd): (usize, &str, &Vec<[f64; 2]>)| {
        let points: Vec<[f64; 2]> = psd
            .iter()
            .filter(|[_, density]| *density > SMALLEST * largest)
            .map(|[frequency, density]| [frequency / scale, density * scale.powi(4)])
            .collect();
        Series::new(label, thinned(&points), model_style(index))
    };
    let series = vec![curve((0, "as read", &before.psd)), curve((1, "measured", &after.psd))];
    let points = || series.iter().flat_map(|series| series.points.iter());
    points().next()?;
    let (x, y) = (ends(points().map(|[x, _]| *x)), ends(points().map(|[_, y]| *y)));
    Some(Chart {
        title: "Areal power spectral density, mean over azimuths".into(),
        x: ChartAxis::decades(&format!("spatial frequency, 1/{unit}"), x),
        y: ChartAxis::decades(&format!("density, {unit}^4"), y),
        series,
    })
}

/// At most `MOST_POINTS`, each the geometric mean of an equal part of a decade.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (Some([first, _]), Some([last, _])) = (points.first(), points.last()) else { return vec![] };
    let step = (last / first).ln() / MOST_POINTS as f64;
    let part =
        |point: &[f64; 2]| if step > 0.0 { ((point[0] / first).ln() / step).floor() as i64 } else { 0 };
    let mean = |some: &[[f64; 2]]| {
        [0, 1].map(|axis| (some.iter().map(|point| point[axis].ln()).sum::<f64>() / some.len() as f64).exp())
    };
    points.chunk_by(|a, b| part(a) == part(b)).map(mean).collect()
}
