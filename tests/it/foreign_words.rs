//! Promise: what a table, its summary or a bench says is shown as text, believed only where it is the table's, and never a
//! panic, whatever its types.

use std::fs;
use std::path::Path;

use gonio::instrument::Grid;
use gonio::interchange::{Format, Options, export, foreign_table, import};
use gonio::table::{BrdfTable, store};
use serde_json::{Value, json};

use crate::support::program::gonio;

/// An element, a cell, a listing's end, a link, an order to the terminal, and a turn of the direction of writing.
const WORDS: &str = "<img src=x onerror=alert(1)>|```[a](b)\u{1b}[2J\u{202e}";

/// Runs `gonio report t.exr` with more words; exit code, stdout and stderr.
fn report(folder: &Path, words: &[&str]) -> (i32, String) {
    let output = gonio(folder, &[&["report", "t.exr", "--force"], words].concat());
    let said = [output.stdout, output.stderr].concat();
    (output.status.code().unwrap_or(-1), String::from_utf8(said).expect("UTF-8"))
}

fn table() -> BrdfTable {
    let grid = Grid {
        theta_i_deg: vec![0.0, 30.0],
        phi_i_deg: vec![0.0],
        theta_r_edges_deg: vec![0.0, 45.0, 90.0],
        phi_r_edges_deg: vec![0.0, 90.0, 180.0, 270.0, 360.0],
        phi_r_relative: true,
        ..Grid::default()
    };
    BrdfTable { version: WORDS.into(), ..foreign_table(grid, vec![vec![0.25; 16]]).expect("a table") }
}

/// A summary of the table, which says [`WORDS`] wherever it may.
fn summary(digest: &str) -> Value {
    let incidence = |theta: f64| {
        json!({ "theta_i_deg": theta, "phi_i_deg": 0.0, "albedo_total": 0.5, "stopped_by": "samples",
            "looks": [{ "samples": 1, "relative_error": 0.1 }, { "samples": 2, "relative_error": 0.05 }] })
    };
    json!({
        "schema": 1, "name": WORDS, "seed": 0, "version": WORDS, "patch_digest": "", "table_digest": digest,
        "stopped_by": "seconds", "plan": { "samples": 4, "realisations": 2 }, "verdict": WORDS, "ok": true,
        "cost": { "wall_s": 1.0, "cpu_s": 1.0, "threads": 1 }, "stops": [incidence(0.0), incidence(30.0)],
        "judgements": [{ "law": WORDS, "verdict": "passed", "reason": WORDS }],
        "comparisons": [{ "masking": WORDS, "model": WORDS, "l1_model": 0.1 }], "nearest_masking": WORDS,
        "energy": { "largest_albedo": 0.5 }, "surface": {}, "failures": [WORDS],
    })
}

fn laid_out(folder: &Path, summary: &Value) {
    store::save(&folder.join("t.exr"), &table()).expect("saved");
    fs::write(folder.join("t.json"), summary.to_string()).expect("written");
}

#[test]
fn words_of_files_are_text_on_the_card_the_page_and_the_terminal() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let digest = store::digest(&table()).expect("a digest");
    laid_out(folder.path(), &summary(&digest));
    for file in ["t.md", "t.html"] {
        let (code, said) = report(folder.path(), &["-o", file]);
        assert_eq!(code, 0, "{said}");
        assert!(!said.contains("another table") && !said.contains(['\u{1b}', '\u{202e}']), "{said}");
        let text = fs::read_to_string(folder.path().join(file)).expect("a text");
        let acts = text.find("<img src=x").or(text.find(['\u{1b}', '\u{202e}']));
        let before: Option<String> = acts.map(|at| text[..at].chars().rev().take(80).collect());
        assert_eq!(before, None, "{file}, read backwards");
        assert!(text.contains("&lt;img src=x onerror=alert(1)&gt;"), "{file}");
        if file == "t.md" {
            assert!(
                text.contains("# &lt;img") && text.contains("passed: &lt;img") && !text.contains("[a](b)"),
                "{text}"
            );
            // Cells stay cells: each row of the table has three bars of its own.
            let rows = text.lines().filter(|line| line.starts_with("| "));
            assert!(rows.clone().count() > 5);
            assert!(rows.clone().all(|row| row.replace("\\|", "").matches('|').count() == 3), "{text}");
        }
    }
}

#[test]
fn a_citation_has_the_words_of_a_file_in_their_places() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let table = BrdfTable { version: "X}\n# H".into(), ..table() };
    store::save(&folder.path().join("t.exr"), &table).expect("saved");
    let cited = gonio(folder.path(), &["cite", "t.exr"]);
    let text = String::from_utf8(cited.stdout).expect("UTF-8");
    assert!(text.contains("gonio X} # H, a"), "{text}");
    assert!(text.contains("{Software, version X\\} \\# H},"), "{text}");
}

#[test]
fn the_campaign_of_a_foreign_file_must_be_one() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let table = BrdfTable { campaign: "name = 3\n".into(), ..table() };
    for format in [Format::ExrParts, Format::Npz] {
        let path = folder.path().join(format.name());
        export(&table, format, &Options::default(), &path).expect("written");
        let why = import(&path, format, &Options::default(), None).expect_err("refused").to_string();
        assert!(
            why.starts_with(&path.display().to_string()) && why.contains("campaign:1:1: name = 3"),
            "{why}"
        );
    }
}

#[test]
fn a_summary_of_another_table_or_schema_is_passed_over_with_a_warning() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let digest = store::digest(&table()).expect("a digest");
    let changes: [(&str, Value, &str); 8] = [
        ("table_digest", json!("0".repeat(64)), "belongs to another table"),
        ("table_digest", json!(7), "no summary of schema 1"),
        ("seed", json!("0"), "no summary of schema 1"),
        ("seed", json!(1), "belongs to another table"),
        ("stops", json!([1, 2]), "no summary of schema 1"),
        ("stopped_by", json!(WORDS), "no summary of schema 1"),
        ("schema", json!(2), "no summary of schema 1"),
        ("schema", json!({}), "no summary of schema 1"),
    ];
    for (key, value, said) in changes {
        let mut summary = summary(&digest);
        summary[key] = value;
        laid_out(folder.path(), &summary);
        let (code, text) = report(folder.path(), &["-o", "t.md"]);
        assert!(code == 0 && text.contains(said), "{key}: {code} {text}");
        let card = fs::read_to_string(folder.path().join("t.md")).expect("a card");
        assert!(!card.contains("ended by") && card.starts_with("<!--"), "{card}");
    }
}

/// Every value of the documents becomes each wrong type in its turn.
#[test]
fn wrong_types_never_panic() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let digest = store::digest(&table()).expect("a digest");
    let own = ["schema", "seed", "patch_digest", "table_digest", "stops"];
    let sound = summary(&digest);
    let keys = sound.as_object().expect("an object").keys().filter(|key| !own.contains(&key.as_str()));
    for key in keys {
        for value in [json!(null), json!([[]]), json!({ "a": 1 }), json!(-1e300)] {
            let mut summary = sound.clone();
            summary[key] = value;
            laid_out(folder.path(), &summary);
            let (code, said) = report(folder.path(), &[]);
            assert!(code == 0 && !said.contains("internal"), "{key}: {code} {said}");
        }
    }
    laid_out(folder.path(), &sound);
    let row = json!({ "varies": "samples", "samples": "many", "error": -1 });
    for bench in [
        json!([]),
        json!({ "rows": [], "ladders": [] }),
        json!({ "schema": 2, "rows": [], "ladders": [] }),
        json!({ "schema": 1, "rows": 1, "ladders": [] }),
        json!({ "schema": 1, "rows": [1, row], "ladders": [1, { "varies": "samples", "fit": [] }] }),
    ] {
        fs::write(folder.path().join("b.json"), bench.to_string()).expect("written");
        let (code, said) = report(folder.path(), &["--bench", "b.json"]);
        assert!(code == 3 && !said.contains("internal"), "{bench}: {code} {said}");
        assert!(said.contains("b.json: is no answer of `gonio bench`"), "{said}");
    }
}
