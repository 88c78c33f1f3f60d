//! Promise: whatever lies where a command would write stays as it is, unless the command wrote it itself or `--force`
//! says that a plain file may go.

#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::support::long::is_long;
use crate::support::program::{exits, gonio, stderr};

const CAMPAIGN: &str = "name = \"small\"\nseed = 7\n[surface]\ncells = 16\nrealisations = 2\n[surface.beckmann]\nalpha = 0.3\n\
    [optics]\nmaterial = \"gold\"\n[light]\ntheta_i_deg = [0.0, 40.0]\n[sensor.hemisphere]\ntheta_r_bins = 3\nphi_r_bins = 4\n\
    [stop]\nsamples = 256\n";

const KINDS: [&str; 6] = ["a file", "a link", "a link to nothing", "a folder", "a pipe", "a read-only file"];

/// Puts something at `path`.
fn put(path: &Path, kind: &str, elsewhere: &Path) {
    fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    match kind {
        "a link" => symlink(elsewhere, path).expect("linked"),
        "a link to nothing" => symlink(elsewhere.with_extension("gone"), path).expect("linked"),
        "a folder" => fs::create_dir(path).expect("made"),
        "a pipe" => {
            let made = Command::new("mkfifo").arg(path).status().expect("mkfifo");
            assert!(made.success());
        }
        _ => fs::write(path, "a year of work").expect("written"),
    }
    if kind == "a read-only file" {
        fs::set_permissions(path, fs::Permissions::from_mode(0o444)).expect("set");
    }
}

/// What is at `path`, and where a link leads.
fn seen(path: &Path, elsewhere: &Path) -> (String, Option<PathBuf>, Option<String>, String, bool) {
    let meta = fs::symlink_metadata(path).expect("still there");
    let content = if meta.is_file() { fs::read_to_string(path).ok() } else { None };
    (
        format!("{:?} {:o}", meta.file_type(), meta.permissions().mode()),
        fs::read_link(path).ok(),
        content,
        fs::read_to_string(elsewhere).expect("a file"),
        elsewhere.with_extension("gone").exists(),
    )
}

/// A folder with a campaign, its table, a list of it, and its shards.
fn inputs() -> TempDir {
    let folder = tempfile::tempdir().expect("folder");
    fs::write(folder.path().join("small.toml"), CAMPAIGN).expect("written");
    // A law needs no heights: what `bench` spends most of its time on.
    let law = CAMPAIGN.replace("cells = 16\n", "").replace("surface.beckmann", "surface.smith");
    fs::write(folder.path().join("law.toml"), law).expect("written");
    for words in [
        &["measure", "small.toml", "-o", "in"][..],
        &["measure", "small.toml", "-o", "shards", "--shard", "1/2"],
        &["measure", "small.toml", "-o", "shards", "--shard", "2/2"],
        &["export", "in/small.exr", "--to", "csv", "-o", "list.csv"],
    ] {
        exits(&gonio(folder.path(), words), 0);
    }
    folder
}

const TABLE: [&str; 6] =
    ["small.exr", "small.realisations.exr", "small.json", "small.html", "small.card.md", ".small.gonio-lock"];

/// Each command, and what it may write below `out`.
fn commands() -> Vec<(Vec<&'static str>, Vec<&'static str>)> {
    let words = |text: &'static str| text.split(' ').collect::<Vec<_>>();
    vec![
        (
            words("measure small.toml -o out"),
            [&TABLE[..], &["small.checkpoint_0", "small.checkpoint_1", "small.band_1_of_2"]].concat(),
        ),
        (
            words("measure small.toml -o out --shard 1/2"),
            vec!["small.shard_1_of_2", ".small.shard_1_of_2.gonio-lock"],
        ),
        (words("merge shards -o out"), TABLE.to_vec()),
        (
            words("surface small.toml -o out --npy --glb"),
            vec!["patch_001.exr", "patch_001.npy", "patch_001.glb", "certificate.json"],
        ),
        (words("export in/small.exr --to npz -o out/small.npz"), vec!["small.npz"]),
        (words("export in/small.exr --to pabopto -o out/folder"), vec!["folder"]),
        (words("import list.csv --from csv -o out/list.exr"), vec!["list.exr"]),
        (
            words("recolour in/small.exr --material copper -o out/copper.exr"),
            vec!["copper.exr", "copper.realisations.exr"],
        ),
        (words("report in/small.exr -o out/page.html"), vec!["page.html"]),
        (words("report in/small.exr -o out/card.md"), vec!["card.md"]),
        (
            words("bench law.toml -o out --from 4 --to 64 --realisations-to 16 --replicates 2"),
            vec!["bench.json", "bench.svg"],
        ),
    ]
}

#[test]
fn what_lies_at_an_output_stays() {
    let folder = inputs();
    let (out, elsewhere) = (folder.path().join("out"), folder.path().join("elsewhere"));
    fs::write(&elsewhere, "a target").expect("written");
    for (words, outputs) in commands() {
        for (place, name) in outputs.into_iter().enumerate() {
            for (number, kind) in KINDS.into_iter().enumerate() {
                // What lies there is looked at in one way, whatever is to be written: all kinds at the first output of
                // every command, one at each of the others, with GONIO_LONG=1 all.
                if !is_long() && place > 0 && (place + number) % KINDS.len() != 0 {
                    continue;
                }
                let path = out.join(name);
                put(&path, kind, &elsewhere);
                let before = seen(&path, &elsewhere);
                let ended = gonio(folder.path(), &words);
                let said = stderr(&ended);
                let case = format!("{words:?} over {kind} {name}: {said}");
                assert_eq!(seen(&path, &elsewhere), before, "{case}");
                assert_eq!(ended.status.code(), Some(3), "{case}");
                assert!(said.contains(name) && said.lines().count() == 1, "{case}");
                // By force a plain file goes, and nothing else.
                if kind != "a file" && words[0] != "import" {
                    let forced = gonio(folder.path(), &[&words[..], &["--force"]].concat());
                    let said = stderr(&forced);
                    assert_eq!(seen(&path, &elsewhere), before, "{case} by force: {said}");
                }
                fs::remove_dir_all(&out).expect("removed");
            }
        }
    }
}

/// A second run of each command finds what the first has written.
#[test]
fn what_a_command_wrote_itself_it_writes_again() {
    let folder = inputs();
    for words in ["report in/small.exr -o out.html", "report in/small.exr -o out.md"] {
        let words: Vec<&str> = words.split(' ').collect();
        for _ in 0..2 {
            exits(&gonio(folder.path(), &words), 0);
        }
    }
    // Ended before its summary: table, page and card are made again.
    fs::remove_file(folder.path().join("in/small.json")).expect("there");
    exits(&gonio(folder.path(), &["measure", "small.toml", "-o", "in"]), 0);
}
