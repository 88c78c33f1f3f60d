//! Promise: what the fuzz targets of `fuzz/` have found stays found; and where they start from.

#[path = "../../fuzz/src/scans.rs"]
mod scans;
#[path = "../../fuzz/src/traced.rs"]
mod traced;

mod seeds;

use std::fs;
use std::path::Path;

use gonio::campaign::{self, Campaign};
use gonio::error::Error;
use gonio::files::sealed;
use gonio::interchange::{self, Checked, Format, Options};
use gonio::measure::persist::header::KIND;
use gonio::measure::{self, Plan, StoredRun};
use gonio::surface::io::map_file;
use gonio::table::{realisations, store};

/// Every file of `tests/data/fuzz/<target>/` once made a reader panic, hang or speak in several lines.
#[test]
fn findings_of_the_fuzzer_are_answered_in_one_line() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/fuzz");
    let mut tried = 0;
    for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
        let target = entry.file_name().to_string_lossy().into_owned();
        for file in fs::read_dir(entry.path()).expect("a folder of findings").flatten() {
            let bytes = fs::read(file.path()).expect("a finding");
            if let Err(why) = read(&target, &bytes) {
                let why = Error::format(Path::new("fuzzed"), why).to_string();
                let line = !why.is_empty() && !why.contains('\n') && why.chars().count() <= 500;
                assert!(line, "{}: {why:?}", file.path().display());
            }
            tried += 1;
        }
    }
    assert!(tried > 0 || !folder.exists());
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

/// What the target's reader says.
fn read(target: &str, bytes: &[u8]) -> Checked<()> {
    let here = Path::new("fuzzed");
    match target {
        "table" => {
            let table = store::decode(here, bytes)?.table;
            if let Ok(again) = store::encode(&table) {
                assert!(store::decode(here, &again).expect("its own bytes").table == table);
            }
            Ok(())
        }
        "realisations" => Ok(realisations::decode(here, bytes).map(drop)?),
        "height_map" => map_file::read(bytes).map(drop),
        "map_gsf" => map_file::read(&[b"Gwyddion Simple Field 1.0\n", bytes].concat()).map(drop),
        "map_xyz" => map_file::read(&[b"0 0 0\n", bytes].concat()).map(drop),
        "map_gwy" | "map_sur" | "map_sdf" | "map_zygo" | "map_picture" | "map_x3p" => {
            map_file::read(&scans::file(target, bytes)).map(drop)
        }
        "pabopto" => interchange::text::pabopto::read(bytes).map(drop),
        "checkpoint" => {
            let (campaign, plan) = checkpoint_of();
            let sealed = sealed::seal(KIND, bytes.len(), |head| Ok::<_, String>([&head, bytes].concat()))?;
            Ok(StoredRun::from_bytes(&sealed)?.run_state(&campaign, &plan).map(drop)?)
        }
        "campaign" => match campaign::parse(bytes, "c.toml", here) {
            Ok(parsed) => {
                let text = campaign::to_toml(&parsed.campaign);
                let again = campaign::parse(&text, "c.toml", here).expect("its own text");
                assert!(again.campaign == parsed.campaign);
                Ok(())
            }
            Err(gonio::error::Error::Campaign(faults)) => {
                Ok(faults.iter().try_for_each(|fault| Err(fault.to_string()))?)
            }
            Err(other) => Err(other.into()),
        },
        "maps" => {
            let (length, rest) = bytes
                .split_first_chunk()
                .map_or((0, bytes), |(&two, rest)| (usize::from(u16::from_le_bytes(two)), rest));
            let (alpha, f0) = rest.split_at(length.min(rest.len()));
            interchange::maps::read(alpha, f0).map(drop)
        }
        "index_file" => {
            let folder = tempfile::tempdir().expect("a folder");
            fs::write(folder.path().join("index.csv"), bytes).expect("written");
            let text = include_str!("../../fuzz/src/index_file.toml");
            Ok(campaign::parse(text, "c.toml", folder.path()).map(drop)?)
        }
        "traced_map" => {
            traced::trace(bytes);
            Ok(())
        }
        format => {
            let format: Format = format.parse().expect("a target");
            interchange::decode(format, &Options::default(), bytes).map(drop)
        }
    }
}

/// The campaign whose checkpoints are read.
fn checkpoint_of() -> (Campaign, Plan) {
    let text = include_str!("../data/checkpoint.toml");
    let campaign = campaign::parse(text, "small.toml", Path::new("")).expect("sound").campaign;
    let plan = measure::plan(&campaign).expect("small");
    (campaign, plan)
}

#[test]
#[ignore = "writes fuzz/corpus: cargo test --test it fuzzed -- --ignored"]
fn seeds_of_the_fuzz_targets_are_written() {
    seeds::write().expect("seeds");
}
