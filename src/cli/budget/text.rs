//! What `gonio budget` prints.

use crate::budget::{Budget, Component, Kind, ValueBudget};
use crate::cli::text::layout::{columns, wrapped};
use crate::cli::text::numbers::two_digits;

/// Values whose components are printed; JSON, CSV and page have all.
const MOST_VALUES: usize = 8;
/// Components below this share are counted together.
const LEAST_SHARE: f64 = 5e-4;
/// Digits after the point, at most.
const MOST_DIGITS: f64 = 12.0;

/// All values in a table, then the components of the first ones.
pub fn lines(found: &Budget) -> Vec<String> {
    let several = found.values.iter().any(|value| value.place.colour != found.values[0].place.colour);
    let mut lines = vec![format!(
        "budget of {}: {} realisations of {} samples, BRDF in 1/sr",
        found.name, found.realisations, found.samples
    )];
    lines.push(String::new());
    lines.extend(overview(found, several));
    for value in found.values.iter().take(MOST_VALUES) {
        lines.push(String::new());
        lines.extend(one(value, several));
    }
    if found.values.len() > MOST_VALUES {
        let rest = found.values.len() - MOST_VALUES;
        lines.push(String::new());
        lines.extend(wrapped(
            "",
            &format!("{rest} more values; --json and the files of -o have their components"),
        ));
    }
    lines.push(String::new());
    lines.extend(remarks(found));
    lines
}

fn overview(found: &Budget, several: bool) -> Vec<String> {
    let row = |value: &ValueBudget| {
        let mut row = vec![directions(value, several)];
        let (y, u) = (value.value, value.gum.standard_uncertainty);
        row.extend([digits(y, u), digits(u, u), percent(u / y), dof(value.gum.dof)]);
        row.extend([format!("{:.2}", value.gum.coverage_factor), digits(value.gum.expanded, u)]);
        row
    };
    let rows: Vec<Vec<String>> = found.values.iter().map(row).collect();
    columns(&["light, sensor", "value", "u", "u %", "nu_eff", "k", "U 95 %"], &rows)
}

/// `30/0, 45/180`: theta and phi of both arms, and the colour where there are several.
fn directions(value: &ValueBudget, several: bool) -> String {
    let at = value.place.position;
    let colour = if several { format!(" {}", value.place.colour) } else { String::new() };
    format!(
        "{}/{}, {}/{}{colour}",
        angle(at.theta_i_deg),
        angle(at.phi_i_deg),
        angle(at.theta_r_deg),
        angle(at.phi_r_deg)
    )
}

fn angle(deg: f64) -> String {
    let text = format!("{deg:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

fn one(value: &ValueBudget, several: bool) -> Vec<String> {
    let mut lines = vec![format!("light, sensor {}", directions(value, several))];
    let (shown, small): (Vec<&Component>, Vec<&Component>) =
        value.components.iter().partition(|component| component.share.abs() >= LEAST_SHARE);
    let rows: Vec<Vec<String>> = shown.iter().map(|component| row(component)).collect();
    lines.extend(columns(&["component", "law", "u(x)", "c", "|c| u", "share %"], &rows));
    if !small.is_empty() {
        let names: Vec<&str> = small.iter().map(|component| component.name.as_str()).collect();
        lines.extend(wrapped("below 0.05 %  ", &names.join(", ")));
    }
    lines.extend(wrapped("Monte Carlo   ", &monte_carlo(value)));
    lines
}

fn row(component: &Component) -> Vec<String> {
    let law = match component.distribution {
        "rectangular" => "rect".into(),
        "triangular" => "triang".into(),
        other => other.to_string(),
    };
    let law = match component.dof.filter(|_| component.distribution == "t") {
        Some(dof) => format!("{law} {dof:.0}"),
        None => law,
    };
    let sensitivity = match (component.kind, component.sensitivity, component.sensitivity_error) {
        (Kind::Input, Some(c), Some(error)) if error > 0.0 => {
            format!("{} +- {}", digits(c, error), digits(error, error))
        }
        (Kind::Input, Some(c), _) => format!("{c:.4}"),
        _ => String::new(),
    };
    let own = match component.kind {
        Kind::Input => component.standard_uncertainty.map_or(String::new(), short),
        _ => String::new(),
    };
    let contribution = component.contribution.map_or(String::new(), short);
    vec![component.name.clone(), law, own, sensitivity, contribution, percent(component.share)]
}

fn monte_carlo(value: &ValueBudget) -> String {
    let (found, u) = (&value.monte_carlo, value.gum.standard_uncertainty);
    let agreement = &value.agreement;
    let says = match agreement.digits {
        2 => format!("agrees with y +- U within {}", short(agreement.tolerance)),
        1 => format!("agrees with y +- U to one digit of u, within {}", short(agreement.tolerance)),
        _ => {
            format!(
                "differs from y +- U by up to {}: use this interval",
                short(agreement.low.max(agreement.high))
            )
        }
    };
    format!(
        "mean {}, u {}, 95 % from {} to {}; {says}",
        digits(found.mean, u),
        digits(found.standard_uncertainty, u),
        digits(found.low, u),
        digits(found.high, u)
    )
}

fn remarks(found: &Budget) -> Vec<String> {
    let check = &found.check;
    let mut lines = match (check.rms, check.noise) {
        (Some(rms), Some(noise)) => wrapped(
            "check         ",
            &format!(
                "{} instruments with errors were measured: the second-order surface is off by {rms:.2} u, noise alone gives {noise:.2} u",
                check.instruments
            ),
        ),
        _ => vec!["check         n/a: no instrument had both arms above the horizon".into()],
    };
    for left_out in &found.left_out {
        lines.extend(wrapped("left out      ", &format!("{}: {}", left_out.name, left_out.why)));
    }
    if !found.dark.is_empty() {
        lines.extend(wrapped(
            "dark          ",
            &format!("no light arrived at {} values: no budget", found.dark.len()),
        ));
    }
    lines
}

/// A number in the digits of an error of two digits.
fn digits(value: f64, error: f64) -> String {
    if error > 0.0 && error.is_finite() {
        let decimals = two_digits(error, MOST_DIGITS);
        format!("{value:.decimals$}")
    } else {
        short(value)
    }
}

/// Two significant digits.
fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".into()
    } else if (1e-4..1e3).contains(&size) {
        let decimals = two_digits(size, MOST_DIGITS);
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
}

fn percent(part: f64) -> String {
    let size = (100.0 * part).abs();
    let decimals = if size >= 10.0 { 1 } else { 2 };
    format!("{:.decimals$}", 100.0 * part)
}

fn dof(dof: Option<f64>) -> String {
    match dof {
        Some(dof) if dof < 9999.5 => format!("{:.0}", dof.floor()),
        _ => "inf".into(),
    }
}
