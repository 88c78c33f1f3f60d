//! Promise: a command that is given the wrong thing says where the right one is.

use std::fs;

use crate::support::campaign_text::SMALL;
use crate::support::program::{exits, folder, gonio, stderr, stdout};

#[test]
fn an_option_of_another_command_is_named_with_its_own() {
    let folder = folder(SMALL);
    for (words, tip) in [
        (
            &["validate", "small.exr", "--seed", "3"][..],
            "--seed is an option of gonio surface, measure, study or albedo",
        ),
        (&["check", "small.toml", "--realisations=3"], "realisations is a key of the campaign, in [surface]"),
        (&["measure", "small.toml", "--bounces", "3"], "bounces is a key of the campaign, in [trace]"),
        (&["measure", "small.toml", "--forse"], "a similar argument exists: '--force'"),
    ] {
        let output = gonio(folder.path(), words);
        exits(&output, 2);
        let said = stderr(&output);
        assert!(said.contains(&format!("tip: {tip}\n")) && said.matches("tip:").count() == 1, "{said}");
    }
    let said = stderr(&gonio(folder.path(), &["check", "small.toml", "--fast"]));
    assert!(!said.contains("tip:"), "{said}");
}

#[test]
fn a_folder_is_no_file_to_replace() {
    let folder = folder(SMALL);
    exits(&gonio(folder.path(), &["measure", "small.toml", "-o", "."]), 0);
    for words in [&["render", "small.exr", "-o", "."][..], &["export", "small.exr", "--to", "csv", "-o", "."]]
    {
        let output = gonio(folder.path(), words);
        exits(&output, 3);
        assert!(stderr(&output).contains("error: .: is a folder; name a file in it"), "{}", stderr(&output));
    }
    // What `*.exr` names beside a table is left out.
    let output = gonio(folder.path(), &["report", "small.exr", "small.realisations.exr", "--force"]);
    exits(&output, 0);
    assert!(
        stdout(&output).contains("small.html")
            && stderr(&output).contains("note: left out: small.realisations.exr")
    );
}

#[test]
fn a_height_map_is_no_table() {
    let folder = folder(SMALL);
    fs::write(folder.path().join("scan.npy"), b"").expect("written");
    let output = gonio(folder.path(), &["import", "scan.npy", "-o", "scan.exr"]);
    exits(&output, 2);
    assert!(stderr(&output).contains("gonio init --surface scan --map scan.npy"), "{}", stderr(&output));
}
