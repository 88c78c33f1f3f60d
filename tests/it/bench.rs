//! Promise: `gonio bench` measures its ladders, says what it found as a table, JSON and picture, one roughness at a
//! time; and it compares ways and sizes that give the same table.

use std::fs;
use std::path::Path;
use std::process::Output;
use std::sync::OnceLock;

use serde_json::Value;

use crate::support::program::{exits, folder, gonio};

const TINY: &str = "\
name = \"tiny\"
seed = 5
[surface]
realisations = 4
cells = 32
correlation_cells = 4.0
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = [40]
[sensor.hemisphere]
theta_r_bins = 6
phi_r_bins = 12
[stop]
samples = 65_536
";
const RUNGS: [&str; 6] = ["--from", "2^8", "--to", "2^12", "--replicates", "2"];

fn bench(folder: &Path, words: &[&str]) -> Output {
    let words = [&["bench", "small.toml"], words].concat();
    gonio(folder, &words)
}

/// Elements of a well-formed document: every tag is closed in its turn, attributes are quoted, `&` starts an entity.
fn elements(text: &str) -> Vec<String> {
    let (mut open, mut found) = (Vec::new(), Vec::new());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('<') {
        assert!(open.is_empty() && before.trim().is_empty() || !open.is_empty(), "text outside: {before}");
        assert!(before.split('&').skip(1).all(|e| ["amp;", "lt;", "gt;"].iter().any(|k| e.starts_with(k))));
        let (tag, tail) = after.split_once('>').expect("a tag ends");
        assert!(tag.matches('"').count() % 2 == 0 && !tag.contains('<'), "{tag}");
        let name = tag.trim_matches('/').split_whitespace().next().expect("a name").to_string();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else {
            if !tag.ends_with('/') {
                open.push(name.clone());
            }
            found.push(name);
        }
        rest = tail;
    }
    assert!(open.is_empty() && rest.trim().is_empty(), "{open:?} left open");
    found
}

/// The answer about the model of the surface by three threads, and its picture.
fn of_the_model() -> &'static (Value, String) {
    static ANSWER: OnceLock<(Value, String)> = OnceLock::new();
    ANSWER.get_or_init(|| answer("model", "3"))
}

fn answer(truth: &str, threads: &str) -> (Value, String) {
    let folder = folder(TINY);
    let words = ["--truth", truth, "--threads", threads, "--json", "-o", truth];
    let output = bench(folder.path(), &[&RUNGS[..], &words].concat());
    exits(&output, 0);
    let svg = fs::read_to_string(folder.path().join(truth).join("bench.svg")).expect("a picture");
    (serde_json::from_slice(&output.stdout).expect("JSON"), svg)
}

#[test]
fn a_tiny_campaign_gives_rows_fits_and_a_picture_with_a_point_for_each_row() {
    let reference = answer("reference", "2");
    for (truth, ladders, (answer, svg)) in [("model", 2, of_the_model()), ("reference", 2, &reference)] {
        assert_eq!(answer["truth"], truth);
        assert!(answer["error_measure"].is_string());
        let rows = answer["rows"].as_array().expect("rows");
        // 2^8, 2^10, 2^12 samples; 1, 4, 16 realisations.
        assert_eq!(rows.len(), 6);
        for row in rows {
            for key in ["samples", "realisations", "seconds", "rays_per_s", "error", "efficiency"] {
                assert!(row[key].as_f64().is_some_and(|value| value > 0.0), "{key}: {row}");
            }
            assert_eq!(row["errors"].as_array().map(Vec::len), Some(2));
        }
        let fits = answer["ladders"].as_array().expect("ladders");
        assert_eq!(fits.len(), ladders);
        assert_eq!(fits[1]["fit"], answer["fit"]);
        for key in ["a", "b", "b_low", "b_high", "slope", "slope_se"] {
            assert!(answer["fit"][key].is_number(), "{key}: {}", answer["fit"]);
        }
        let points = elements(svg).iter().filter(|name| *name == "circle").count();
        // One in each legend.
        assert_eq!(points, rows.len() + ladders);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}

#[test]
fn the_same_campaign_has_the_same_errors_for_any_number_of_threads() {
    let errors = |(answer, _): &(Value, String)| {
        let rows = answer["rows"].as_array().expect("rows").clone();
        rows.iter().map(|row| row["errors"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(errors(&answer("model", "1")), errors(of_the_model()));
}

#[test]
fn the_table_fits_a_terminal_and_another_campaigns_bench_is_kept() {
    let folder = folder(TINY);
    let output = bench(folder.path(), &RUNGS);
    exits(&output, 0);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    assert!(text.contains("slope") && text.contains("bench.svg"), "{text}");
    let document = folder.path().join("out/tiny/bench.json");
    let before = fs::read(&document).expect("readable");
    fs::write(folder.path().join("small.toml"), TINY.replace("seed = 5", "seed = 6")).expect("campaign");
    exits(&bench(folder.path(), &RUNGS), 3);
    assert_eq!(fs::read(&document).expect("readable"), before);
    exits(&bench(folder.path(), &[&RUNGS[..], &["--force"]].concat()), 0);
}

#[test]
fn a_statistical_surface_sends_all_its_light_back() {
    let smith = "[surface.smith]\nndf = \"ggx\"\nheights = \"correlated\"";
    let text = TINY.replace("cells = 32\ncorrelation_cells = 4.0\n[surface.ggx]", smith);
    let folder = folder(&text.replace("[stop]", "[trace]\nbounces = 4\n[stop]"));
    let output = bench(folder.path(), &[&RUNGS[..], &["--json"]].concat());
    exits(&output, 0);
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    for row in answer["rows"].as_array().expect("rows") {
        // Shares of 1/2^k counted as integers: only the sum of the orders is rounded, to f64.
        assert!(row["closure"].as_f64().is_some_and(|off| off < 1e-14), "{row}");
    }
}

#[test]
fn cells_and_correlation_length_are_varied_in_one_table() {
    let folder = folder(&format!(
        "{}\n[bench]\ncells = [32, 64]\ncorrelation_cells = [2, 4]\n",
        TINY.replace("realisations = 4", "realisations = 6")
    ));
    let output = bench(folder.path(), &["--json"]);
    exits(&output, 0);
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = answer["rows"].as_array().expect("rows");
    let settings: Vec<(u64, f64)> = rows
        .iter()
        .map(|row| (row["cells"].as_u64().unwrap_or(0), row["correlation_cells"].as_f64().unwrap_or(0.0)))
        .collect();
    assert_eq!(settings, [(32, 2.0), (32, 4.0), (64, 2.0), (64, 4.0)]);
    for row in rows {
        for key in ["samples", "realisations", "seconds", "rays_per_s", "error", "error_se", "noise", "ks"] {
            assert!(row[key].as_f64().is_some_and(|value| value >= 0.0), "{key}: {row}");
        }
    }
    // Patches of so few bumps: noise is larger than what is looked for, so chance alone decides p.
    assert!(answer["fit"].is_null() && answer.get("flatness").is_some(), "{answer}");
    let text = String::from_utf8(bench(folder.path(), &[]).stdout).expect("UTF-8");
    assert!(text.contains("flat?") && text.lines().all(|line| line.chars().count() <= 100), "{text}");
    exits(&bench(folder.path(), &["--from", "2^8"]), 2);
}

#[test]
fn several_roughnesses_are_a_fault_and_short_ladders_a_mistake() {
    let several = folder(&TINY.replace("alpha = 0.3", "alpha = [0.1, 0.3]"));
    let output = bench(several.path(), &RUNGS);
    exits(&output, 2);
    assert!(String::from_utf8_lossy(&output.stderr).contains("surface.ggx.alpha"));
    let short = folder(TINY);
    exits(&bench(short.path(), &["--from", "2^12", "--to", "2^14"]), 2);
    exits(&bench(short.path(), &["--from", "many"]), 2);
    assert!(!short.path().join("out").exists());
}

#[test]
fn two_ways_are_compared_at_an_equal_error() {
    let folder = folder(TINY);
    let words = ["--against", "rays", "--replicates", "3"];
    let output = bench(folder.path(), &[&words[..], &["--json"]].concat());
    exits(&output, 0);
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let [planned, rays] = [0, 1].map(|way| &answer["ways"][way]);
    assert_eq!((&planned["name"], &rays["name"]), (&"planned".into(), &"rays".into()));
    let number = |way: &Value, key: &str| way[key].as_f64().expect("a number");
    for way in [planned, rays] {
        assert!(number(way, "cpu_s") > 0.0 && number(way, "noise") > 0.0);
        assert!(number(way, "error") > 0.0);
        let expected = number(way, "cpu_s") * (number(way, "noise") / 0.01).powi(2);
        assert!((number(way, "to_target_s") / expected - 1.0).abs() < 1e-12);
    }
    let ratio = number(rays, "to_target_s") / number(planned, "to_target_s");
    assert!((number(&answer, "ratio") / ratio - 1.0).abs() < 1e-12);
    // A ray for each start and one for each lit one that sends light up, either way.
    assert!(number(rays, "rays") > 0.8 * number(planned, "rays"));
    let output = bench(folder.path(), &words);
    exits(&output, 0);
    assert!(String::from_utf8_lossy(&output.stdout).contains("times as long by `rays` for the same error"));
    // What cannot be compared is said.
    for wrong in [
        &["--against", "hemisphere"][..],
        &["--against", "backward"],
        &["--against", "rays", "--replicates", "1"],
        &["--against", "rays", "--from", "2^8"],
        &["--cells", "64", "--against", "rays"],
        &["--cells", "7"],
    ] {
        exits(&bench(folder.path(), wrong), 2);
    }
}

#[test]
fn sizes_have_a_row_for_each_incidence_and_for_all_together() {
    let folder = folder(&TINY.replace("[40]", "[40, 85]"));
    let output = bench(folder.path(), &["--cells", "512,256", "--json"]);
    exits(&output, 0);
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = answer["rows"].as_array().expect("rows");
    let of = |row: &Value| (row["cells"].as_u64(), row["theta_i_deg"].to_string(), row["starts"].as_u64());
    let expected = [256u64, 512].iter().flat_map(|&side| {
        let starts = side * side;
        [("[40.0]", 1), ("[85.0]", 1), ("[40.0,85.0]", 2)]
            .map(|(theta, incidences)| (Some(side), theta.to_string(), Some(incidences * starts)))
    });
    assert_eq!(rows.iter().map(of).collect::<Vec<_>>(), expected.collect::<Vec<_>>());
    for patch in answer["patches"].as_array().expect("patches") {
        // The project's own limit, and the index's fixed tables: 65,537 firsts and as many sums of two f64.
        let cells = patch["cells"].as_f64().expect("a size").powi(2);
        let limit = 40.0 + 65_537.0 * (4.0 + 16.0) / cells;
        assert!(patch["tracing_bytes"].as_f64().is_some_and(|bytes| bytes <= limit), "{patch}");
    }
}
