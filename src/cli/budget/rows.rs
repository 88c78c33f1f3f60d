//! The components of a budget as CSV: a line each, those of a value together, its sum first.

use serde::Serialize;

use crate::budget::{Budget, Component, ValueBudget};
use crate::error::{Error, Result};

/// One line.
#[derive(Debug, Clone, Default, Serialize)]
struct ComponentRow {
    theta_i_deg: f64,
    phi_i_deg: f64,
    theta_r_deg: f64,
    phi_r_deg: f64,
    colour: String,
    component: String,
    distribution: &'static str,
    /// u(x), or u_c.
    standard_uncertainty: Option<f64>,
    dof: Option<f64>,
    sensitivity: Option<f64>,
    sensitivity_error: Option<f64>,
    /// |c| u(x), or u_c; 1/sr.
    contribution: Option<f64>,
    share: Option<f64>,
    /// Of the sum alone.
    value: Option<f64>,
    coverage_factor: Option<f64>,
    expanded: Option<f64>,
    monte_carlo_low: Option<f64>,
    monte_carlo_high: Option<f64>,
    /// Digits of u_c to which both methods agree.
    agreement_digits: Option<usize>,
}

/// All components of all values.
pub fn csv(found: &Budget) -> Result<Vec<u8>> {
    let failed = |why: &dyn std::fmt::Display| Error::Internal(format!("writing CSV: {why}"));
    let mut out = csv::Writer::from_writer(Vec::new());
    for row in found.values.iter().flat_map(rows) {
        out.serialize(row).map_err(|why| failed(&why))?;
    }
    out.into_inner().map_err(|why| failed(&why))
}

fn rows(value: &ValueBudget) -> Vec<ComponentRow> {
    let position = value.place.position;
    let blank = ComponentRow {
        theta_i_deg: position.theta_i_deg,
        phi_i_deg: position.phi_i_deg,
        theta_r_deg: position.theta_r_deg,
        phi_r_deg: position.phi_r_deg,
        colour: value.place.colour.clone(),
        ..ComponentRow::default()
    };
    let sum = ComponentRow {
        component: "combined".into(),
        standard_uncertainty: Some(value.gum.standard_uncertainty),
        dof: value.gum.dof,
        contribution: Some(value.gum.standard_uncertainty),
        share: Some(1.0),
        value: Some(value.value),
        coverage_factor: Some(value.gum.coverage_factor),
        expanded: Some(value.gum.expanded),
        monte_carlo_low: Some(value.monte_carlo.low),
        monte_carlo_high: Some(value.monte_carlo.high),
        agreement_digits: Some(value.agreement.digits),
        ..blank.clone()
    };
    let of = |component: &Component| ComponentRow {
        component: component.name.clone(),
        distribution: component.distribution,
        standard_uncertainty: component.standard_uncertainty,
        dof: component.dof,
        sensitivity: component.sensitivity,
        sensitivity_error: component.sensitivity_error,
        contribution: component.contribution,
        share: Some(component.share),
        ..blank.clone()
    };
    std::iter::once(sum).chain(value.components.iter().map(of)).collect()
}
