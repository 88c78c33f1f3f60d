//! What a measurement says of its material: albedos of each order, and what Schlick's formula costs.

use super::layout::columns;
use crate::instrument::IncidenceAngles;
use crate::measure::{IncidenceResult, Measured, Plan};
use crate::stats;
use crate::validate::prediction::schlick_error::{ColourError, IncidenceError, SchlickError};

/// Orders with a column of their own.
const MOST_ORDERS: usize = 8;
/// Colours with a line of their own.
const MOST_COLOURS: usize = 6;

/// Albedos of each order, where there are several.
pub fn order_lines(measured: &Measured, plan: &Plan) -> Vec<String> {
    let orders =
        measured.incidences.iter().map(|incidence| incidence.albedo_by_order.len()).max().unwrap_or(0);
    if orders < 2 || plan.apertures_only {
        return vec![];
    }
    let shown = orders.min(MOST_ORDERS);
    let mut headings: Vec<String> = ["theta_i", "phi_i"].map(String::from).to_vec();
    headings.extend((1..=shown).map(|order| order.to_string()));
    headings.extend((orders > shown).then(|| format!("{} to {orders}", shown + 1)));
    let angles = IncidenceAngles::of(&plan.grid);
    let row = |(index, incidence): (usize, &IncidenceResult)| {
        let mut row = angles.texts(index).to_vec();
        if incidence.is_dark() {
            row.resize(headings.len(), "not seen".into());
            return row;
        }
        let means: Vec<f64> = incidence.albedo_by_order.iter().map(|order| stats::mean(order)).collect();
        row.extend(means[..shown].iter().map(|mean| format!("{mean:.5}")));
        row.extend((orders > shown).then(|| format!("{:.5}", means[shown..].iter().sum::<f64>())));
        row
    };
    let rows: Vec<Vec<String>> = measured.incidences.iter().enumerate().map(row).collect();
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    [vec![String::new(), "albedo by order".into()], columns(&headings, &rows)].concat()
}

/// The difference of Schlick's formula and Fresnel's equations for a material whose index is known.
pub fn schlick_lines(error: &SchlickError) -> Vec<String> {
    let mut all: Vec<&ColourError> = error.colours.iter().collect();
    all.sort_by(|a, b| b.largest.abs().total_cmp(&a.largest.abs()));
    let left_out = all.len().saturating_sub(MOST_COLOURS);
    all.truncate(MOST_COLOURS);
    let row = |colour: &&ColourError| {
        vec![
            colour.colour.clone(),
            format!("{:.4}", colour.f0),
            format!("{:+.4}", colour.largest),
            format!("{:.1}", colour.theta_d_deg),
            format!("{:+.4}", colour.hemispherical),
        ]
    };
    let rows: Vec<Vec<String>> = all.iter().map(row).collect();
    let mut lines = vec![String::new(), "Schlick's formula minus Fresnel's equations at one facet".into()];
    lines.extend(columns(&["colour", "F0", "largest", "at degrees", "hemispherical"], &rows));
    if left_out > 0 {
        lines.push(format!("(the {MOST_COLOURS} of {} colours that differ most)", error.colours.len()));
    }
    if !error.incidences.is_empty() {
        let angles = IncidenceAngles::new(
            error.incidences.iter().map(|incidence| (incidence.theta_i_deg, incidence.phi_i_deg)),
        );
        let row = |(index, incidence): (usize, &IncidenceError)| {
            let figures = [incidence.albedo_exact, incidence.albedo_schlick, incidence.l1]
                .map(|value| format!("{value:.5}"));
            [angles.texts(index).to_vec(), figures.to_vec()].concat()
        };
        let rows: Vec<Vec<String>> = error.incidences.iter().enumerate().map(row).collect();
        lines.push("the same paths with both (L1: flux-weighted difference of the bins)".into());
        let what = if error.incidences.iter().all(|incidence| incidence.whole) {
            "albedo"
        } else {
            "into apertures"
        };
        let [fresnel, schlick] = ["Fresnel", "Schlick"].map(|law| format!("{what}, {law}"));
        lines.extend(columns(&["theta_i", "phi_i", &fresnel, &schlick, "L1"], &rows));
    }
    lines
}
