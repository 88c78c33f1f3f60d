//! Promise: a failure to write leaves every file old or new, and whole; two processes do not write one output.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use gonio::files::lock::Lock;
use gonio::table::{realisations, store};

use crate::support::outputs::{self, copied};
use crate::support::program::{exits, stderr};

const CAMPAIGN: &str = "\
name = \"small\"
seed = 5
[surface]
realisations = 2
cells = 32
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = [0, 50]
[sensor.hemisphere]
theta_r_bins = 6
phi_r_bins = 12
[stop]
samples = 65_536
";

/// Measures with `words`, files of `kib` at most.
fn measured(folder: &Path, words: &str, kib: Option<u32>) -> Output {
    let limit = kib.map_or(String::new(), |kib| format!("ulimit -f {kib}; "));
    let line = format!("{limit}exec \"$0\" measure small.toml -o out {words}");
    let mut shell = Command::new("bash");
    shell.current_dir(folder).args(["-c", &line, env!("CARGO_BIN_EXE_gonio")]).output().expect("runs")
}

#[test]
fn a_file_that_may_not_grow_leaves_the_old_files_whole() {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("small.toml"), CAMPAIGN).expect("campaign");
    let out = folder.path().join("out");
    let run = |words: &str, kib| {
        let output = measured(folder.path(), words, kib);
        (output.status.code(), outputs::digests(&out), stderr(&output))
    };
    let (code, new, _) = run("--seed 6", None);
    assert_eq!(code, Some(0));
    let (code, old, _) = run("--force", None);
    assert_eq!(code, Some(0));
    let kept = folder.path().join("old");
    copied(&out, &kept);
    let largest =
        fs::read_dir(&out).expect("readable").map(|file| file.expect("file").metadata().expect("size").len());
    let largest = largest.max().expect("files").div_ceil(1024) as u32;
    // Every size at which one of the files is cut off, up to one that all fit.
    let sizes: Vec<u32> =
        (0..=largest + 8).filter(|kib| *kib <= 24 || kib % 64 == 0 || *kib > largest).collect();
    let mut failed = 0;
    for kib in sizes {
        let (code, files, text) = run("--seed 6 --force", Some(kib));
        let whole = |(name, digest): (&String, &String)| {
            assert!(
                old.get(name) == Some(digest) || new.get(name) == Some(digest),
                "{kib} KiB: {name}\n{text}"
            );
        };
        files.iter().for_each(whole);
        assert!(store::load(&out.join("small.exr")).is_ok(), "{kib} KiB");
        assert!(realisations::load(&out.join("small.realisations.exr")).is_ok(), "{kib} KiB");
        match code {
            Some(0) => assert_eq!(files, new),
            Some(3) => {
                failed += 1;
                assert_eq!(files, old, "{kib} KiB: nothing was replaced");
                assert!(
                    // Without any room not even a claim on the folder is made.
                    text.lines().last().is_some_and(|line| line.starts_with(if kib > 0 {
                        "error: out/small."
                    } else {
                        "error: out:"
                    })),
                    "{text}"
                );
            }
            other => panic!("{kib} KiB: {other:?}: {text}"),
        }
        copied(&kept, &out);
    }
    assert!(failed >= 10, "{failed}");
}

#[test]
fn a_second_process_is_refused_and_a_dead_one_is_not_waited_for() {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("small.toml"), CAMPAIGN).expect("campaign");
    let out = folder.path().join("out");
    fs::create_dir(&out).expect("folder");
    let lock = Lock::take(&out, "small").expect("free");
    let refused = measured(folder.path(), "", None);
    exits(&refused, 3);
    let by = format!("out/.small.gonio-lock: process {} is writing this output", std::process::id());
    assert!(stderr(&refused).contains(&by), "{}", stderr(&refused));
    drop(lock);
    // What a killed process leaves is a file without a lock.
    fs::write(out.join(".small.gonio-lock"), "gonio lock of process 4194305\n").expect("left behind");
    exits(&measured(folder.path(), "", None), 0);
    let files: BTreeMap<_, _> = outputs::digests(&out);
    assert!(files.contains_key("small.exr") && !files.contains_key(".small.gonio-lock"), "{files:?}");
}
