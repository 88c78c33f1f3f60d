//! The plots of the page: which charts a table gives, and which it cannot give, with the reason.

use super::chart::ends;
use crate::report::plot::{
    Chart, ChartAxis, MEASURED, Marker, Series, SeriesStyle, model_style, ratio_style, series_style,
};
use crate::report::slices::{Scene, Sweep, mirror_bin};
use crate::report::summary::IncidenceSummary;

/// Light angles and azimuths that get plots of their own at most.
const MOST_ANGLES: usize = 8;
const MOST_AZIMUTHS: usize = 3;
/// Half-width of a ratio's 95 % interval beyond which the ratio is not drawn.
const WIDEST: f64 = 0.5;
const SENSOR: &str = "sensor theta_r, degrees (positive: mirror's side)";

/// `count` indices, at most `most` of them, evenly spread with both ends.
pub fn spread(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|k| k * (count - 1) / (most - 1)).collect()
}

/// The incidences that get plots: some azimuths, some angles of each.
pub fn shown_incidences(scene: &Scene) -> Vec<usize> {
    shown_sweeps(scene).into_iter().flat_map(|sweep| sweep.incidences).collect()
}

/// The same by azimuth.
pub fn shown_sweeps(scene: &Scene) -> Vec<Sweep> {
    let sweeps = scene.sweeps();
    let some = |sweep: &Sweep| {
        let incidences =
            spread(sweep.incidences.len(), MOST_ANGLES).into_iter().map(|k| sweep.incidences[k]).collect();
        Sweep { incidences, ..*sweep }
    };
    spread(sweeps.len(), MOST_AZIMUTHS).into_iter().map(|k| some(&sweeps[k])).collect()
}

/// A light direction in words.
pub fn incidence_name(scene: &Scene, incidence: usize) -> String {
    let (theta, phi) = scene.table.grid.incidence_deg(incidence);
    if scene.has_azimuths() {
        format!("theta_i {theta}°, phi_i {phi}°")
    } else {
        format!("theta_i {theta}°")
    }
}

/// The lobe in the plane of incidence: order 1 with its 95 % band, all orders, and every model; `None` without light
/// in the plane.
pub fn lobe(scene: &Scene, incidence: usize) -> Option<Chart> {
    let cuts = scene.in_plane(incidence);
    if cuts.len() < 2 {
        return None;
    }
    let curve =
        |value: &dyn Fn(usize) -> f64| cuts.iter().map(|c| [c.theta_deg, value(c.bin)]).collect::<Vec<_>>();
    let mut series = Vec::new();
    let error: Option<Vec<f64>> = cuts.iter().map(|cut| scene.half_width(incidence, cut.bin)).collect();
    let measured = curve(&|bin| scene.single(incidence, bin));
    let bars = error.iter().flatten().chain(std::iter::repeat(&0.0));
    let mut highest = measured.iter().zip(bars).map(|(point, bar)| point[1] + bar).fold(0.0, f64::max);
    if cuts.iter().all(|cut| scene.total(incidence, cut.bin) <= 0.0) {
        return None;
    }
    series.push(Series {
        label: "measured".into(),
        points: measured,
        error: error.unwrap_or_default(),
        style: MEASURED,
    });
    if scene.has_multiple() {
        let style = SeriesStyle { colour: "#777", dashes: "2 2", marker: Marker::Ring, line: true };
        let points = curve(&|bin| scene.total(incidence, bin));
        highest = points.iter().map(|point| point[1]).fold(highest, f64::max);
        series.push(Series::new("all orders", points, style));
    }
    for (index, label) in scene.maskings().into_iter().enumerate() {
        let points = curve(&|bin| scene.model(index, incidence, bin).unwrap_or(0.0));
        highest = points.iter().map(|point| point[1]).fold(highest, f64::max);
        series.push(Series::new(label, points, model_style(index)));
    }
    let top = 1.08 * highest;
    Some(Chart {
        title: format!("In-plane lobe, {}", incidence_name(scene, incidence)),
        x: ChartAxis::degrees(SENSOR, [-90.0, 90.0]),
        y: ChartAxis::linear(&format!("BRDF{}, 1/sr", scene.colour_note()), [0.0, top]),
        series,
    })
}

/// Measured over model in the plane of incidence, for every masking; the error bars stand on the first.
///
/// Bins whose 95 % interval is wider than +-`WIDEST` of the model say nothing of it and are left out.
pub fn ratio(scene: &Scene, incidence: usize) -> Option<Chart> {
    let cuts = scene.in_plane(incidence);
    let mut series = vec![line_at_one()];
    for (index, label) in scene.maskings().into_iter().enumerate() {
        let (mut points, mut error) = (Vec::new(), Vec::new());
        for cut in &cuts {
            let (value, model) = (scene.single(incidence, cut.bin), scene.model(index, incidence, cut.bin)?);
            let half = scene.half_width(incidence, cut.bin).unwrap_or(0.0);
            if value > 0.0 && half <= WIDEST * model {
                points.push([cut.theta_deg, value / model]);
                error.push(half / model);
            }
        }
        if index > 0 {
            error.clear();
        }
        series.push(Series { label, points, error, style: ratio_style(index) });
    }
    (series.iter().any(|series| series.points.len() > 2)).then(|| Chart {
        title: format!("Measured / model, {}", incidence_name(scene, incidence)),
        x: ChartAxis::degrees(SENSOR, [-90.0, 90.0]),
        y: ChartAxis::linear(&format!("ratio{}", scene.colour_note()), [0.5, 1.5]),
        series,
    })
}

fn line_at_one() -> Series {
    let style = SeriesStyle { colour: "#999", dashes: "", marker: Marker::Off, line: true };
    Series::new("", vec![[-90.0, 1.0], [90.0, 1.0]], style)
}

/// Albedo by order against theta_i at one azimuth of the light, from the summary's incidences; models of order 1. `None`
/// where it is not known, or at one angle only.
pub fn albedo(scene: &Scene, incidences: &[IncidenceSummary], sweep: &Sweep) -> Option<Chart> {
    let theta = |incidence: usize| scene.table.grid.incidence_deg(incidence).0;
    let shown: Vec<&IncidenceSummary> =
        sweep.incidences.iter().filter_map(|&incidence| incidences.get(incidence)).collect();
    if shown.len() < 2 || shown.iter().all(|incidence| incidence.albedo_single.is_none()) {
        return None;
    }
    let column = |pick: &dyn Fn(&IncidenceSummary) -> Option<f64>| {
        shown
            .iter()
            .filter_map(|incidence| Some([incidence.theta_i_deg, pick(incidence)?]))
            .collect::<Vec<_>>()
    };
    let errors = |pick: fn(&IncidenceSummary) -> Option<f64>| {
        shown.iter().filter_map(|incidence| scene.interval(pick(incidence)?)).collect()
    };
    let mut series = Vec::new();
    let mut add = |label: String, points: Vec<[f64; 2]>, error: Vec<f64>, style: SeriesStyle| {
        if !points.is_empty() {
            let error = if error.len() == points.len() { error } else { vec![] };
            series.push(Series { label, points, error, style });
        }
    };
    // Another program's table does not know how often its light has bounced.
    let first = if scene.table.campaign.is_empty() { "measured" } else { "order 1" };
    add(
        first.into(),
        column(&|incidence| incidence.albedo_single),
        errors(|incidence| incidence.albedo_single_se),
        MEASURED,
    );
    let orders = shown.iter().filter_map(|incidence| incidence.albedo_by_order.as_ref()).map(Vec::len).max();
    for order in 1..orders.unwrap_or(1).min(5) {
        let points = column(&|incidence| incidence.albedo_by_order.as_ref()?.get(order).copied());
        add(format!("order {}", order + 1), points, vec![], series_style(order));
    }
    if scene.has_multiple() {
        let points = column(&|incidence| incidence.albedo_total);
        add("all orders".into(), points, errors(|incidence| incidence.albedo_total_se), series_style(5));
    }
    for (index, label) in scene.maskings().into_iter().enumerate() {
        let incidences = sweep.incidences.iter();
        let points = incidences
            .filter_map(|&incidence| Some([theta(incidence), scene.model_albedo(index, incidence)?]))
            .collect();
        add(label, points, vec![], model_style(index));
    }
    let highest = series.iter().flat_map(|s| &s.points).map(|p| p[1]).fold(0.0, f64::max);
    let at = if scene.has_azimuths() { format!(", phi_i {}°", sweep.angle_deg) } else { String::new() };
    Some(Chart {
        title: format!("Albedo against the light's angle{at}"),
        x: ChartAxis::degrees("light theta_i, degrees", [0.0, 90.0]),
        y: ChartAxis::linear("share of the light", [0.0, (1.05 * highest).max(1e-6)]),
        series,
    })
}

/// What a curve shows of R and T.
type PartOfBoth = fn([f64; 2]) -> f64;

/// What comes back of the light (R), what goes through (T), and both together against theta_i at one azimuth of the light:
/// all orders that were followed, and order 1 by the model with the masking `masking`. `None` at one angle only, or where
/// one of them is not known.
///
/// Input: the scenes of both halves. R and T of a realisation do not vary independently, so the bars of R + T are the sum of
/// both, which is the most that they can be: sd(R + T) <= sd(R) + sd(T).
// Tested by `shares_of_the_light_add_up` (tests/it/report.rs).
pub fn shares(
    halves: [&Scene; 2],
    incidences: &[IncidenceSummary],
    sweep: &Sweep,
    masking: usize,
) -> Option<Chart> {
    let [back, _] = halves;
    let shown: Vec<&IncidenceSummary> =
        sweep.incidences.iter().filter_map(|&incidence| incidences.get(incidence)).collect();
    if shown.len() < 2 {
        return None;
    }
    let known = |incidence: &&IncidenceSummary| {
        let errors = incidence.albedo_total_se.zip(incidence.transmittance_total_se);
        let errors = errors.and_then(|(r, t)| Some([back.interval(r)?, back.interval(t)?]));
        Some((incidence.theta_i_deg, [incidence.albedo_total?, incidence.transmittance_total?], errors))
    };
    let known: Vec<_> = shown.iter().map(known).collect::<Option<_>>()?;
    let mut series = vec![line_at_one()];
    let parts: [(&str, PartOfBoth); 3] = [("R", |[r, _]| r), ("T", |[_, t]| t), ("R + T", |[r, t]| r + t)];
    for (index, (label, part)) in parts.into_iter().enumerate() {
        let points = known.iter().map(|&(theta, both, _)| [theta, part(both)]).collect();
        let error = known.iter().map(|&(_, _, errors)| errors.map(part)).collect::<Option<Vec<f64>>>();
        series.push(Series {
            label: label.into(),
            points,
            error: error.unwrap_or_default(),
            style: series_style(index),
        });
    }
    for (index, (label, part)) in parts.into_iter().enumerate() {
        let model = |incidence: usize| {
            let [r, t] = halves.map(|half| half.model_albedo(masking, incidence));
            Some([back.table.grid.incidence_deg(incidence).0, part([r?, t?])])
        };
        let points: Vec<[f64; 2]> =
            sweep.incidences.iter().filter_map(|&incidence| model(incidence)).collect();
        if !points.is_empty() {
            series.push(Series::new(format!("{label}, model, order 1"), points, model_style(index)));
        }
    }
    let at = if back.has_azimuths() { format!(", phi_i {}°", sweep.angle_deg) } else { String::new() };
    Some(Chart {
        title: format!("What comes back (R) and goes through (T){at}"),
        x: ChartAxis::degrees("light theta_i, degrees", [0.0, 90.0]),
        y: ChartAxis::linear("share of the light, all orders", [0.0, 1.1]),
        series,
    })
}

/// BRDF in the bin of the mirror direction against the light's azimuth, for some theta_i.
pub fn anisotropy(scene: &Scene) -> Option<Chart> {
    let grid = &scene.table.grid;
    let mut rounds = scene.rounds();
    rounds.retain(|round| round.incidences.len() > 1);
    let mut series = Vec::new();
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    for (index, row) in spread(rounds.len(), 4).into_iter().enumerate() {
        let (mut points, mut error, mut models) = (Vec::new(), Vec::new(), Vec::new());
        for &incidence in &rounds[row].incidences {
            let phi = grid.incidence_deg(incidence).1;
            let bin = mirror_bin(grid, incidence)?;
            if scene.table.is_gap(incidence * grid.bins() + bin) {
                continue;
            }
            (first, last) = (phi.min(first), phi.max(last));
            points.push([phi, scene.single(incidence, bin)]);
            error.push(scene.half_width(incidence, bin).unwrap_or(0.0));
            models.extend(scene.model(0, incidence, bin).map(|value| [phi, value]));
        }
        let label = format!("theta_i {}°", rounds[row].angle_deg);
        let style = SeriesStyle { line: false, ..series_style(index) };
        series.push(Series { label, points, error, style });
        let masking = scene.maskings().into_iter().next().unwrap_or_default();
        let label = if index == 0 { masking } else { String::new() };
        if !models.is_empty() {
            series.push(Series::new(label, models, model_style(5)));
        }
    }
    let values = series.iter().flat_map(|s| &s.points).map(|p| p[1]).filter(|&v| v > 0.0);
    let [low, high] = ends(values);
    (high > 0.0).then(|| Chart {
        title: "Mirror direction against the light's azimuth".into(),
        x: ChartAxis::degrees("light phi_i, degrees", [first, last]),
        y: ChartAxis::decades(&format!("BRDF{}, 1/sr", scene.colour_note()), [low, high]),
        series,
    })
}
