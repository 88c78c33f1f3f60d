//! Promise: the commands beside the main job say what there is and write what they say: a campaign to begin with, lists of
//! names, a citation, completions, manual pages, the version in full; formats are told by the names of files.

use std::fs;

use gonio::campaign;
use serde_json::Value;

use crate::support::campaign_text::SMALL;
use crate::support::program::{exits, folder, gonio, json, stderr, stdout};

#[test]
fn a_campaign_to_begin_with_is_checked_and_kept() {
    let folder = tempfile::tempdir().expect("folder");
    let at = folder.path();
    exits(&gonio(at, &["init", "first", "--purpose", "render", "--surface", "brushed"]), 0);
    exits(&gonio(at, &["check", "first.toml"]), 0);
    // What is there stays.
    let text = fs::read_to_string(at.join("first.toml")).expect("written");
    let again = gonio(at, &["init", "first"]);
    exits(&again, 3);
    assert!(
        stderr(&again).contains("first.toml") && stderr(&again).contains("--force"),
        "{}",
        stderr(&again)
    );
    assert_eq!(fs::read_to_string(at.join("first.toml")).expect("there"), text);
    exits(&gonio(at, &["init", "first", "--force"]), 0);
    // To stdout; nobody is asked where no terminal is.
    let printed = stdout(&gonio(at, &["init", "-", "--purpose", "glass"]));
    campaign::parse(&printed, "campaign", at).expect("no fault");
    // Lines that wait behind a # are sound.
    let arm = stdout(&gonio(at, &["init", "-", "--instrument", "plane", "--purpose", "formula"]));
    let whole: String = arm
        .lines()
        .map(|line| {
            line.strip_prefix("# ").filter(|rest| rest.contains(['=', '['])).unwrap_or(line).to_string()
                + "\n"
        })
        .collect();
    let parsed = campaign::parse(&whole, "campaign", at).expect("no fault");
    assert!(
        parsed.uncertainty.is_some_and(|given| given.inputs.len() == 2) && whole.contains("\nmaterial = "),
        "{whole}"
    );
    // What does not go together is said by its key, and nothing is written.
    let refused = gonio(at, &["init", "layout", "--surface", "brushed", "--instrument", "merl"]);
    exits(&refused, 2);
    assert!(stderr(&refused).contains("preset") && !at.join("layout.toml").exists(), "{}", stderr(&refused));
}

#[test]
fn lists_name_everything_and_fit_the_terminal() {
    let at = tempfile::tempdir().expect("folder");
    for (verb, some) in [
        ("materials", &["gold", "diamond", "ice"][..]),
        ("presets", &["utia", "klems_full", "not emulated"]),
        ("formats", &["npz", "tensor_tree", "pabopto", "R and T"]),
    ] {
        let text = stdout(&gonio(at.path(), &[verb]));
        assert!(some.iter().all(|word| text.contains(word)), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
        let Value::Array(entries) = json(&gonio(at.path(), &[verb, "--json"])) else {
            panic!("{verb}: a list")
        };
        assert!(entries.iter().all(|entry| entry["name"].is_string()), "{entries:?}");
    }
}

/// BK7 of the catalogue has n = 1.5185 at 550 nm; Johnson and Christy's gold ends at 821.1 nm.
#[test]
fn the_list_of_materials_has_what_campaigns_use() {
    let at = tempfile::tempdir().expect("folder");
    let all = json(&gonio(at.path(), &["materials", "--json"]));
    let of = |name: &str| {
        let all = all.as_array().expect("a list");
        all.iter().find(|entry| entry["name"] == name).cloned().expect("there")
    };
    let n = of("glass")["clear_n_550"].as_f64().expect("a number");
    assert!((n - 1.5185).abs() < 5e-5, "{n}");
    assert_eq!(of("gold")["index_nm"], serde_json::json!([367.9, 821.1]));
    assert_eq!(of("skin")["index_nm"], Value::Null);
}

#[test]
fn a_table_is_cited_by_what_makes_it_again() {
    let folder = folder(SMALL);
    let at = folder.path();
    exits(&gonio(at, &["measure", "small.toml", "--json"]), 0);
    let cited = json(&gonio(at, &["cite", "out/small/small.exr", "--json"]));
    let summary: Value =
        serde_json::from_slice(&fs::read(at.join("out/small/small.json")).expect("there")).expect("JSON");
    assert_eq!(cited["digest"], summary["table_digest"]);
    let text = stdout(&gonio(at, &["cite", "out/small/small.exr"]));
    let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(flat.contains("measured with gonio") && flat.contains("@misc{gonio_small,"), "{text}");
    assert_eq!(text.matches('{').count(), text.matches('}').count(), "{text}");
    exits(&gonio(at, &["cite", "small.toml"]), 3);
}

#[test]
fn completions_pages_and_the_version_are_made() {
    let folder = tempfile::tempdir().expect("folder");
    let at = folder.path();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(stdout(&gonio(at, &["completions", shell])).contains("recolour"), "{shell}");
    }
    exits(&gonio(at, &["man", "pages"]), 0);
    let page = fs::read_to_string(at.join("pages/gonio-measure.1")).expect("written");
    assert!(page.contains(".TH gonio-measure 1") && page.contains("resume"), "{page}");
    exits(&gonio(at, &["man", "pages"]), 3);
    exits(&gonio(at, &["man", "pages", "--force"]), 0);
    for words in [["--version", "-v"], ["-v", "--version"], ["-V", "--verbose"]] {
        let text = stdout(&gonio(at, &words));
        assert!(["compiler rustc 1.", "target ", "lanes "].iter().all(|word| text.contains(word)), "{text}");
    }
}

#[test]
fn names_of_files_tell_the_format() {
    let folder = folder(SMALL);
    let at = folder.path();
    exits(&gonio(at, &["measure", "small.toml", "--json"]), 0);
    for (file, format) in [("t.npz", "npz"), ("t.csv", "csv"), ("t.astm", "astm")] {
        let said = json(&gonio(at, &["export", "out/small/small.exr", "-o", file, "--json"]));
        assert_eq!(said["format"], format);
        exits(&gonio(at, &["import", file, "-o", &format!("{format}.exr")]), 0);
    }
    // Two formats of Radiance have one ending: written they are asked for, read they are told by their content.
    let which = gonio(at, &["export", "out/small/small.exr", "-o", "t.xml"]);
    exits(&which, 2);
    assert!(stderr(&which).contains("t.xml: --to klems or --to tensor_tree?"), "{}", stderr(&which));
    let klems = ["--to", "klems", "--klems", "quarter", "--allow-albedo-error", "100"];
    exits(&gonio(at, &[&["export", "out/small/small.exr", "-o", "t.xml"], &klems[..]].concat()), 0);
    assert!(stdout(&gonio(at, &["import", "t.xml", "-o", "x.exr"])).contains("(patches)"));
    let none = gonio(at, &["export", "out/small/small.exr", "-o", "table"]);
    exits(&none, 2);
    assert!(stderr(&none).contains("the name does not say which format; --to npz|"), "{}", stderr(&none));
    // The American spelling.
    let recoloured = gonio(at, &["recolor", "--help"]);
    exits(&recoloured, 0);
}
