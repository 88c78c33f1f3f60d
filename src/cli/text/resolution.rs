//! The rows of a `[bench]` table in words and as JSON.

use serde_json::{Value, json};

use super::layout::columns;
use super::numbers::{duration, grouped, or_na};
use super::output::to_json;
use crate::bench::{ResolutionRow, convergence, flatness};
use crate::campaign::Campaign;
use crate::error::Result;
use crate::validate::expect;
use crate::validate::prediction::model::Model;

/// What is in the column `discrepancy`, and in `error` of the JSON rows.
const MEASURE: &str = "l1_model: flux-weighted L1 of order 1, noise taken off, mean over incidences";

fn truth(campaign: &Campaign) -> String {
    let law = Model::of(campaign).map_or("model".into(), |model| model.name());
    format!("{law} {}", expect::masking(campaign))
}

/// The JSON document: the keys of every bench (no fit), and whether the rows are flat.
pub fn answer(campaign: &Campaign, resolved: String, rows: &[ResolutionRow]) -> Result<Value> {
    Ok(json!({
        "schema": 1,
        "name": campaign.name,
        "seed": campaign.seed,
        "version": env!("CARGO_PKG_VERSION"),
        "error_measure": MEASURE,
        "truth": "model",
        "truth_name": truth(campaign),
        "rows": to_json(&rows)?,
        "fit": null,
        "flatness": to_json(&flatness(rows))?,
        "convergence": to_json(&convergence(rows))?,
        "campaign": resolved,
    }))
}

/// The table, and what its rows say together.
pub fn lines(campaign: &Campaign, rows: &[ResolutionRow]) -> Vec<String> {
    const HEADINGS: [&str; 7] =
        ["cells", "correlation", "samples", "seconds", "KS", "discrepancy", "noise taken off"];
    let mut lines = vec![
        format!("discrepancy: {MEASURE}"),
        format!("from {}; +-: jackknife over realisations", truth(campaign)),
    ];
    lines.push(String::new());
    lines.extend(columns(&HEADINGS, &rows.iter().map(cells).collect::<Vec<_>>()));
    lines.push(String::new());
    let Some(flat) = flatness(rows) else {
        lines.push("flat?         n/a".into());
        return lines;
    };
    lines.push(format!("mean          {:.5} +- {:.5}", flat.mean, flat.mean_se));
    lines.push(format!(
        "flat?         chi-square {:.1} of {} degrees, p = {:.3}",
        flat.chi_square, flat.dof, flat.p_value
    ));
    if let Some((slope, se)) = flat.per_doubling.zip(flat.per_doubling_se) {
        lines.push(format!("per doubling  {slope:+.5} +- {se:.5} (correlation length)"));
    }
    if let Some(fall) = convergence(rows) {
        let (power, se) = (fall.power, fall.power_se);
        lines.push(format!(
            "falls as      cells^-p, p = {power:.3} +- {se:.3} (weighted least squares on logarithms)"
        ));
    }
    lines.push(format!("time          {}", duration(rows.iter().map(|row| row.seconds).sum())));
    lines
}

fn cells(row: &ResolutionRow) -> Vec<String> {
    vec![
        row.cells.to_string(),
        row.correlation_cells.to_string(),
        grouped(row.samples),
        format!("{:.1}", row.seconds),
        or_na(row.ks, 5),
        format!("{:.5} +- {:.5}", row.error, row.error_se),
        format!("{:.5}", row.noise),
    ]
}
