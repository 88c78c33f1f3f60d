//! Error against samples, from the JSON document of `gonio bench`.

use serde_json::Value;

use super::chart::{Axis, Chart, Marker, Series, Style, model_style, series_style};

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
    let guide = Style { colour: "#777", dashes: "8 5", marker: Marker::Off, line: true };
    let line = |label: &str, points, style| Series { label: label.into(), points, error: vec![], style };
    let mut series = vec![line("1/√N", curve(&|n| from * (first[0] / n).sqrt()), guide)];
    if let Some((a, b)) = constants {
        series.push(line(
            "√(a/N + b²)",
            curve(&|n| (a / n + b * b).sqrt()),
            Style { dashes: "", ..model_style(1) },
        ));
    }
    let points = Style { line: false, ..series_style(0) };
    series.push(line("measured", measured.clone(), points));
    let errors =
        measured.iter().map(|p| p[1]).fold((f64::INFINITY, 0.0f64), |(l, h), e| (l.min(e), h.max(e)));
    let slope = fit["slope"].as_f64().map_or(String::new(), |slope| format!(", slope {slope:.3}"));
    let what = if ladder["varies"] == "realisations" { "more realisations" } else { "more samples in each" };
    Some(Chart {
        title: format!("Error: {what}{slope}"),
        x: Axis::decades("samples of one stop, N", [first[0], last[0]]),
        y: Axis::decades("flux-weighted L1 of order 1", [errors.0, errors.1]),
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
