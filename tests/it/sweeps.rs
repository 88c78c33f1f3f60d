//! Promise: a campaign that makes several tables ends in one CSV of all their figures and one page of joint plots, which
//! `gonio report` makes of any tables too; nothing foreign is replaced.

use std::fs;

use gonio::report::Summary;
use gonio::report::sweep::CSV_MARK;
use serde_json::Value;

use crate::support::campaign_text::SMALL;
use crate::support::program::{exits, folder, gonio, stderr, stdout};

/// Three roughnesses by a range.
fn sweep() -> String {
    SMALL.replace("alpha = 0.3", "alpha = { from = 0.1, to = 0.3, step = 0.1 }").replace("65_536", "16_384")
}

/// The cells of a CSV file under their headings.
fn rows(text: &str) -> Vec<Vec<(String, String)>> {
    let mut lines = text.lines().map(|line| line.split(',').map(String::from).collect::<Vec<_>>());
    let head = lines.next().expect("headings");
    lines.map(|line| head.iter().cloned().zip(line).collect()).collect()
}

#[test]
fn a_sweep_has_its_figures_in_one_file() {
    let folder = folder(&sweep());
    let at = folder.path();
    let said = stdout(&gonio(at, &["measure", "small.toml"]));
    assert!(said.contains("small.sweep.csv") && said.contains("small.sweep.html"), "{said}");
    let text = fs::read_to_string(at.join("out/small/small.sweep.csv")).expect("written");
    assert!(text.starts_with(CSV_MARK), "{text}");
    let rows = rows(&text);
    assert_eq!(rows.len(), 3 * 2, "three roughnesses, two angles");
    for (k, alpha) in ["0.1", "0.2", "0.3"].into_iter().enumerate() {
        let json = fs::read(at.join(format!("out/small/small_alpha_{alpha}.json"))).expect("summary");
        let summary: Summary = serde_json::from_slice(&json).expect("a summary");
        for (row, stop) in rows[2 * k..2 * k + 2].iter().zip(&summary.stops) {
            let cell = |name: &str| row.iter().find(|(head, _)| head == name).map(|(_, cell)| cell.as_str());
            assert_eq!(
                (cell("table"), cell("alpha_x")),
                (Some(&*format!("small_alpha_{alpha}")), Some(alpha))
            );
            let number = |name: &str| cell(name).and_then(|cell| cell.parse::<f64>().ok());
            assert_eq!(number("theta_i_deg"), Some(stop.theta_i_deg));
            assert_eq!(number("albedo_total"), stop.albedo_total);
            assert_eq!(number("albedo_total_se"), stop.albedo_total_se);
        }
        let own = &summary.comparisons[0];
        let name = format!("l1_model:{}:{}:{}", own.model, own.masking, own.scope);
        let found = rows[2 * k + 1].iter().find(|(head, _)| *head == name).expect("a column");
        assert_eq!(found.1.parse::<f64>().ok(), own.stops[1].figures.l1_model);
    }
    let page = fs::read_to_string(at.join("out/small/small.sweep.html")).expect("written");
    for word in
        ["Albedo against the roughness", "theta_i 50\u{b0}", "small_alpha_0.2.html", "3 tables side by side"]
    {
        assert!(page.contains(word), "{word}");
    }
    // Made again of the files alone: the same figures.
    let tables = ["0.1", "0.2", "0.3"].map(|alpha| format!("out/small/small_alpha_{alpha}.exr"));
    let words: Vec<&str> = ["report"].into_iter().chain(tables.iter().map(String::as_str)).collect();
    exits(&gonio(at, &[&words[..], &["-o", "again.csv"]].concat()), 0);
    assert_eq!(fs::read_to_string(at.join("again.csv")).expect("written"), text);
    exits(&gonio(at, &[&words[..], &["-o", "again.html"]].concat()), 0);
    let why = gonio(at, &words);
    exits(&why, 2);
    assert!(stderr(&why).contains("-o FILE.html, or FILE.csv"), "{}", stderr(&why));
}

#[test]
fn nothing_foreign_is_replaced_and_one_table_has_no_sweep() {
    let folder = folder(&sweep());
    let at = folder.path();
    fs::create_dir_all(at.join("out/small")).expect("folder");
    fs::write(at.join("out/small/small.sweep.csv"), "mine").expect("written");
    let refused = gonio(at, &["measure", "small.toml"]);
    exits(&refused, 3);
    assert!(stderr(&refused).contains("small.sweep.csv"), "{}", stderr(&refused));
    assert_eq!(fs::read_to_string(at.join("out/small/small.sweep.csv")).expect("there"), "mine");
    let one = crate::support::program::folder(SMALL);
    exits(&gonio(one.path(), &["measure", "small.toml", "--json"]), 0);
    let names = fs::read_dir(one.path().join("out/small")).expect("a folder");
    assert!(names.flatten().all(|entry| !entry.file_name().to_string_lossy().contains("sweep")));
    let wrong = crate::support::program::folder(&sweep().replace("step = 0.1", "step = 0"));
    let said: Value = Value::String(stderr(&gonio(wrong.path(), &["check", "small.toml"])));
    assert!(said.as_str().is_some_and(|said| said.contains("surface.ggx.alpha.step")), "{said}");
}
