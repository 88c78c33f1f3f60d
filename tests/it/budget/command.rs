//! Promise: `gonio budget` prints what it finds in text that fits a terminal and as JSON, writes page and CSV of the same
//! figures, says the same for any number of threads, and leaves what `measure` makes as it is.

use std::fs;

use serde_json::Value;

use crate::support::campaign_text::SMALL;
use crate::support::program::{done, exits, folder, gonio, json};

const UNCERTAINTY: &str = "
[uncertainty]
lamp_theta_deg = { u = 0.1 }
sensor_phi_deg = { half_width = 0.2 }
height_scale = { u = 0.01, dof = 5 }
sensor_aperture = { half_width = 0.02 }
reading = { U = 0.02, k = 2 }
correlations = [[\"lamp_theta_deg\", \"reading\", -0.3]]
at = [[50, 0, 45, 180], [50, 0, 30, 150]]
aperture_deg = 4
trials = 200_000
";

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number: {value}"))
}

#[test]
fn the_command_writes_page_csv_and_json() {
    let folder = folder(&format!("{SMALL}{UNCERTAINTY}"));
    let at = folder.path();
    let text = done(&gonio(at, &["budget", "small.toml", "-o", "out", "--threads", "2"]));
    // Rows of tables end in a number and fit 80 columns; sentences are broken at the terminal's width, 100 without one.
    for line in text.lines() {
        let row = line.split(' ').next_back().is_some_and(|last| last.parse::<f64>().is_ok());
        assert!(line.chars().count() <= if row { 80 } else { 100 }, "{line}");
    }
    for word in ["nu_eff", "U 95 %", "height_scale", "discretisation", "correlations", "Monte Carlo", "check"]
    {
        assert!(text.contains(word), "{word}: {text}");
    }
    let checked = done(&gonio(at, &["check", "small.toml"]));
    assert!(checked.contains("uncertainty   5 inputs, for gonio budget\n"), "{checked}");
    let all = json(&gonio(at, &["budget", "small.toml", "--json", "--threads", "1"]));
    let written: Value =
        serde_json::from_str(&fs::read_to_string(at.join("out/small.budget.json")).expect("JSON"))
            .expect("JSON");
    // Another number of threads, the same digits.
    assert_eq!(all, written);
    let values = all["values"].as_array().expect("values");
    assert_eq!(values.len(), 2);
    for (place, value) in values.iter().enumerate() {
        let [y, u, k, expanded] =
            ["value", "standard_uncertainty", "coverage_factor", "expanded"].map(|key| number(&value[key]));
        assert!(y > 0.0 && u > 0.0 && (k * u / expanded - 1.0).abs() < 1e-14, "{value}");
        // Shares are of all of u^2: 15 numbers of rounding 1e-16, squared and summed.
        let components = value["components"].as_array().expect("components");
        let shares: f64 = components.iter().map(|one| number(&one["share"])).sum();
        assert!((shares - 1.0).abs() < 1e-12, "{shares}");
        let diagonal = number(&all["covariance"][place][place]);
        assert!((diagonal / (u * u) - 1.0).abs() < 1e-14);
    }
    let (a, b) = (number(&all["covariance"][0][1]), number(&all["covariance"][1][0]));
    assert!((a - b).abs() <= 1e-14 * a.abs(), "{a} {b}");
    let csv = fs::read_to_string(at.join("out/small.budget.csv")).expect("CSV");
    assert!(csv.lines().nth(1).expect("a line").contains(",combined,"), "{csv}");
    let page = fs::read_to_string(at.join("out/small.budget.html")).expect("the page");
    let shown = format!("{:.5}", number(&values[0]["value"]));
    assert!(page.contains(&shown) && page.contains("height_scale") && page.contains("<svg"), "{shown}");
    // What is there stays.
    exits(&gonio(at, &["budget", "small.toml", "-o", "out"]), 3);
}

#[test]
fn a_table_is_the_same_with_and_without_an_uncertainty() {
    let tables = [SMALL.to_string(), format!("{SMALL}{UNCERTAINTY}")].map(|text| {
        let folder = folder(&text);
        done(&gonio(folder.path(), &["measure", "small.toml", "-o", "out"]));
        fs::read(folder.path().join("out/small.exr")).expect("the table")
    });
    assert!(tables[0] == tables[1]);
}
