//! Promise: what the fuzz targets of `fuzz/` have found stays found; and where they start from.

#[path = "../../fuzz/src/readers.rs"]
mod readers;
#[path = "../../fuzz/src/scans.rs"]
mod scans;
#[path = "../../fuzz/src/traced.rs"]
mod traced;

mod seeds;

use std::fs;
use std::path::Path;

use seeds::Corpus;

/// Every file of `tests/data/fuzz/<target>/` once made a reader panic, hang or speak in several lines.
#[test]
fn findings_of_the_fuzzer_are_answered_in_one_line() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/fuzz");
    let mut tried = 0;
    for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
        let target = entry.file_name().to_string_lossy().into_owned();
        for file in fs::read_dir(entry.path()).expect("a folder of findings").flatten() {
            readers::read(&target, &fs::read(file.path()).expect("a finding"));
            tried += 1;
        }
    }
    assert!(tried > 0 || !folder.exists());
}

/// Targets are compiled by the fuzzer alone: what each of them calls must be there.
#[test]
fn every_target_has_a_reader() {
    let names = include_str!("../../fuzz/Cargo.toml")
        .lines()
        .filter_map(|line| line.strip_prefix("path = \"targets/"));
    let names: Vec<&str> = names.filter_map(|line| line.strip_suffix(".rs\"")).collect();
    assert!(names.len() > 20, "{names:?}");
    for name in names {
        let path = format!("{}/fuzz/targets/{name}.rs", env!("CARGO_MANIFEST_DIR"));
        let text = fs::read_to_string(&path).expect("a target");
        assert!(text.contains(&format!("|bytes: &[u8]| gonio_fuzz::read(\"{name}\", bytes)")), "{path}");
        readers::read(name, b"");
    }
}

/// The targets link the versions that the program links: what is fuzzed is what is shipped.
#[test]
fn the_lock_of_the_targets_names_the_programs_versions() {
    let versions = |text: &str| -> Vec<(String, String)> {
        let package = |block: &str| {
            let value = |key: &str| Some(block.lines().find_map(|line| line.strip_prefix(key))?.to_string());
            Some((value("name = ")?, value("version = ")?))
        };
        text.split("[[package]]").filter_map(package).collect()
    };
    let ours = versions(include_str!("../../Cargo.lock"));
    for package in versions(include_str!("../../fuzz/Cargo.lock")) {
        let known = ours.iter().any(|(name, _)| *name == package.0);
        assert!(
            !known || ours.contains(&package),
            "{package:?} is no version of Cargo.lock: `cp Cargo.lock fuzz/ && cargo metadata --manifest-path \
             fuzz/Cargo.toml > /dev/null` mends it"
        );
    }
}

#[test]
#[ignore = "writes fuzz/corpus: cargo test --test it fuzzed -- --ignored"]
fn seeds_of_the_fuzz_targets_are_written() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    let corpus = Corpus(&folder);
    corpus.formats().and_then(|()| corpus.write_small()).expect("seeds");
}

/// A seed that its reader refuses leads no fuzzer anywhere.
#[test]
fn seeds_are_sound() {
    let folder = tempfile::tempdir().expect("folder");
    Corpus(folder.path()).write_small().expect("seeds");
}
