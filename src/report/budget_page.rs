//! The page of an uncertainty budget: values, and the shares of each.

use super::html::render::plain_page;
use super::html::sections::{figures_of, scrolled};
use super::plot::escaped;
use super::plot::shares::shares;
use crate::budget::{Budget, Component, Kind, ValueBudget};

/// Values whose components are shown; JSON and CSV have all.
const MOST_VALUES: usize = 24;

/// One self-contained page.
// Tested by `the_command_writes_page_csv_and_json` (tests/it/budget/command.rs).
pub fn page(found: &Budget) -> String {
    let title = format!("{}: uncertainty budget", escaped(&found.name));
    let below = format!(
        "<p id=\"verdict\">{}</p>\n",
        escaped(&format!(
            "{} values by JCGM 100 and, beside it, by Monte Carlo (JCGM 101); {} realisations of {} samples.",
            found.values.len(),
            found.realisations,
            found.samples
        ))
    );
    let shown = found.values.iter().take(MOST_VALUES);
    let components: String = shown.map(components).collect();
    let main = format!(
        "<section id=\"values\" aria-label=\"Values\">\n<h2>Values</h2>\n{}</section>\n\
         <section id=\"components\" aria-label=\"Components\">\n<h2>Components</h2>\n<p>Shares are parts of u².</p>\n{components}</section>\n\
         <section id=\"remarks\" aria-label=\"Remarks\">\n<h2>Remarks</h2>\n{}</section>\n",
        values(found),
        remarks(found)
    );
    plain_page(&title, &below, &main)
}

fn place(value: &ValueBudget) -> String {
    let at = value.place.position;
    format!(
        "θi {:.2}°, φi {:.2}°, θr {:.2}°, φr {:.2}°, {}",
        at.theta_i_deg, at.phi_i_deg, at.theta_r_deg, at.phi_r_deg, value.place.colour
    )
}

fn values(found: &Budget) -> String {
    let row = |value: &ValueBudget| {
        let dof = value.gum.dof.map_or("∞".into(), |dof| format!("{:.0}", dof.floor()));
        let says = match value.agreement.digits {
            2 => "agrees to two digits of u",
            1 => "agrees to one digit of u",
            _ => "differs: use it",
        };
        format!(
            "<tr><th>{}</th><td>{:.5}</td><td>{:.5}</td><td>{dof}</td><td>{:.2}</td><td>{:.5}</td><td>{:.5} to {:.5}</td>\
             <td>{says}</td></tr>\n",
            escaped(&place(value)),
            value.value,
            value.gum.standard_uncertainty,
            value.gum.coverage_factor,
            value.gum.expanded,
            value.monte_carlo.low,
            value.monte_carlo.high
        )
    };
    let rows: String = found.values.iter().map(row).collect();
    let table = format!(
        "<table class=\"facts\"><thead><tr><th>directions</th><th>BRDF, 1/sr</th><th>u</th><th>ν_eff</th><th>k</th><th>U, 95 %</th>\
         <th>Monte Carlo, 95 %</th><th>GUM and Monte Carlo</th></tr></thead>\n<tbody>{rows}</tbody></table>"
    );
    scrolled("Values", &table)
}

fn components(value: &ValueBudget) -> String {
    let number = |value: Option<f64>| value.map_or("–".to_string(), |value| format!("{value:.3e}"));
    let row = |component: &Component| {
        let own = component.standard_uncertainty.filter(|_| component.kind == Kind::Input);
        let sensitivity = component.sensitivity.filter(|_| component.kind == Kind::Input);
        let error = component.sensitivity_error.map_or(String::new(), |error| format!(" ± {error:.1e}"));
        format!(
            "<tr><th>{}</th><td>{}</td><td>{}</td><td>{}{error}</td><td>{}</td><td>{:.2} %</td></tr>\n",
            escaped(&component.name),
            component.distribution,
            number(own),
            number(sensitivity),
            number(component.contribution),
            100.0 * component.share
        )
    };
    let rows: String = value.components.iter().map(row).collect();
    let parts: Vec<(&str, f64)> =
        value.components.iter().map(|component| (component.name.as_str(), component.share)).collect();
    let table = format!(
        "<table class=\"facts\"><thead><tr><th>component</th><th>law</th><th>u(x)</th><th>c, 1/sr a unit</th><th>|c| u, 1/sr</th>\
         <th>share</th></tr></thead>\n<tbody>{rows}</tbody></table>"
    );
    format!(
        "<h3>{}</h3>\n{}{}",
        escaped(&place(value)),
        figures_of([shares(&format!("Shares of u²: {}", place(value)), &parts)]),
        scrolled(&format!("Components: {}", place(value)), &table)
    )
}

fn remarks(found: &Budget) -> String {
    let check = match (found.check.rms, found.check.noise) {
        (Some(rms), Some(noise)) => format!(
            "{} instruments with errors were measured: the second-order surface of the Monte Carlo method is off by {rms:.2} u, \
             noise alone gives {noise:.2} u.",
            found.check.instruments
        ),
        _ => "No instrument with errors was measured.".into(),
    };
    let left_out = found.left_out.iter().map(|one| format!("Left out: {}: {}.", one.name, one.why));
    let dark = (!found.dark.is_empty())
        .then(|| format!("No light arrived at {} values: they have no budget.", found.dark.len()));
    let all = std::iter::once(check).chain(left_out).chain(dark).chain(found.notes.iter().cloned());
    let items: String = all.map(|text| format!("<li>{}</li>\n", escaped(&text))).collect();
    format!("<ul>{items}</ul>\n")
}
