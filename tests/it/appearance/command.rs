//! Promise: `gonio appearance` prints what the library finds, as text that fits a terminal, JSON and CSV, and the page has the
//! same figures.

use std::fs;

use serde_json::Value;

use crate::support::campaign_text::SMALL;
use crate::support::program::{done, exits, folder, gonio, json};

#[test]
fn the_command_prints_text_json_and_csv_of_the_same_figures() {
    let folder = folder(SMALL);
    let at = folder.path();
    done(&gonio(at, &["measure", "small.toml", "-o", "out"]));
    let text = done(&gonio(at, &["appearance", "out/small.exr"]));
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    for word in ["gloss 20", "DOI 30", "reflectance", "45:0", "jackknife"] {
        assert!(text.contains(word), "{word}: {text}");
    }
    let all = json(&gonio(at, &["appearance", "out/small.exr", "--json"]));
    let azimuth = &all["azimuths"][0];
    let rho = &azimuth["scatter"][0]["reflectance"];
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(at.join("out/small.json")).expect("the summary"))
            .expect("JSON");
    let same = |found: &Value, key: &str| {
        let [found, wanted] = [found, &summary["stops"][0][key]].map(|v| v.as_f64().expect("a number"));
        // The summary's albedo is summed before values become f32.
        assert!((found - wanted).abs() < 1e-5 * (1.0 + wanted), "{key}: {found} {wanted}");
    };
    same(&rho["value"], "albedo_total");
    same(&rho["se"], "albedo_total_se");
    done(&gonio(at, &["appearance", "out/small.exr", "-o", "figures.csv"]));
    let csv = fs::read_to_string(at.join("figures.csv")).expect("the CSV");
    let row = csv.lines().find(|line| line.contains(",hemisphere,reflectance,")).expect("a line");
    let value: f64 = row.split(',').nth(7).expect("the value").parse().expect("a number");
    assert_eq!(Some(value), rho["value"].as_f64());
    assert!(csv.lines().any(|line| line.contains(",in plane,ars,")), "{csv}");
    let page = fs::read_to_string(at.join("out/small.html")).expect("the page");
    let section = page.split("id=\"appearance\"").nth(1).expect("the section");
    let shown = format!("{:.4}", value);
    assert!(section.split("</section>").next().expect("it ends").contains(&shown), "{shown}");
    // What is there stays.
    exits(&gonio(at, &["appearance", "out/small.exr", "-o", "figures.csv"]), 3);
    exits(&gonio(at, &["appearance", "out/small.exr", "-o", "out/small.exr", "--force"]), 3);
}
