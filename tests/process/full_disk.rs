//! Promise: what a run takes on the disk is said before; a disk that is full for a while costs checkpoints, not the run.

use std::fs;
use std::path::Path;
use std::process::Command;

use gonio::campaign;
use gonio::measure::{self, Checkpoint, Disk};
use gonio::table::realisations::SIZE_LIMIT;
use rustix::process::Signal;

use crate::support::failing::Failing;
use crate::support::outputs;
use crate::support::program::{command, exits, folder};

/// Long enough for several checkpoints.
const CAMPAIGN: &str = "\
name = \"small\"
seed = 5
[surface]
realisations = 3
cells = 64
correlation_cells = 4.0
[surface.ggx]
alpha = [0.3, 0.5]
[light]
theta_i_deg = [0, 50]
[sensor.hemisphere]
theta_r_bins = 6
phi_r_bins = 12
[trace]
bounces = 2
[stop]
samples = 262_144
";

fn measure(folder: &Path, output: &str) -> Command {
    command(folder, &["measure", "small.toml", "-o", output])
}

/// Which attempts at a checkpoint find the disk full.
const FULL: (u64, u64) = (3, 5);

#[test]
fn a_run_whose_disk_is_full_for_a_while_goes_on_and_is_kept_again() {
    let Some(failing) = Failing::built() else { return };
    let folder = folder(CAMPAIGN);
    let here = folder.path();
    let often = |output: &str| {
        fs::create_dir(here.join(output)).expect("folder");
        let mut command = measure(here, output);
        // After every block; one thread, so that each has an attempt of its own.
        command.args(["--threads", "1"]).env("GONIO_CHECKPOINT_S", "0.001");
        command
    };
    let mut full = often("out");
    full.env("FAILING_CALL", "open").env("FAILING_NAME", "/.gonio-");
    let (output, failed) = failing.run(full, &here.join("out"), FULL);
    let said = exits(&output, 0);
    let warnings: Vec<&str> = said.lines().filter(|line| line.starts_with("warning: ")).collect();
    let [warning] = warnings[..] else { panic!("one warning: {said}") };
    assert!(
        warning.contains("no checkpoint could be written, the run goes on: out/small.checkpoint_"),
        "{said}"
    );
    assert!(warning.contains("No space left on device"), "{said}");
    assert_eq!(failed.len() as u64, 1 + FULL.1 - FULL.0, "{failed:?}");
    exits(&measure(here, "undisturbed").output().expect("runs"), 0);
    assert_eq!(outputs::digests(&here.join("out")), outputs::digests(&here.join("undisturbed")));

    // The same, killed after the first checkpoint that there is room for again: it is there, and gone on with.
    let below = here.join("killed");
    let mut killed = often("killed");
    killed.env("FAILING_LAST", FULL.1.to_string());
    let killed = failing.ended(killed, &below, Signal::KILL, ".checkpoint_", FULL.0);
    assert_eq!(killed.status.code(), None, "ended before it was killed");
    let kept = Checkpoint::of(&below, "small").load().expect("whole").expect("there");
    assert_eq!(kept.kept.header.number, FULL.0, "two before, and the one after");
    let output = measure(here, "killed").arg("--resume").output().expect("runs");
    assert!(exits(&output, 0).contains("note: resumes "));
    assert_eq!(outputs::digests(&below), outputs::digests(&here.join("undisturbed")));
}

/// Bytes of all files in a folder whose names hold one of these words.
fn size(folder: &Path, words: &[&str]) -> u64 {
    let entries = fs::read_dir(folder).expect("readable").map(|entry| entry.expect("entry"));
    let held =
        entries.filter(|entry| words.iter().any(|word| entry.file_name().to_string_lossy().contains(word)));
    held.map(|entry| entry.metadata().expect("size").len()).sum()
}

#[test]
fn what_a_run_takes_on_the_disk_is_said_before() {
    let short = CAMPAIGN.replace("262_144", "65_536");
    let cases = [
        short.clone(),
        short.replace("theta_r_bins = 6", "theta_r_bins = 36").replace("phi_r_bins = 12", "phi_r_bins = 72"),
        format!("{short}[optics]\nmaterials = [\"gold\", \"copper\"]\n"),
        format!("{short}[optics]\nmaterial = \"gold\"\n")
            .replace("bounces = 2", "bounces = 4\nby_order = true"),
    ];
    for text in cases {
        let folder = tempfile::tempdir().expect("temporary folder");
        fs::write(folder.path().join("small.toml"), &text).expect("campaign");
        let campaign = campaign::parse(&text, "small", folder.path()).expect("sound").campaign;
        let disk = Disk::of(&campaign, &measure::plan(&campaign).expect("fits"), SIZE_LIMIT);
        exits(&measure(folder.path(), "out").output().expect("runs"), 0);
        let results = size(&folder.path().join("out"), &["small"]);
        // Values are counted as if they did not compress; half of these and more are zero or alike.
        let said = disk.results_bytes;
        assert!(results <= said && said <= 4 * results, "{said} said, {results} taken: {text}");
        let shard = measure(folder.path(), "shards").args(["--shard", "1/1"]).output().expect("runs");
        exits(&shard, 0);
        let (kept, said) = (3 * size(&folder.path().join("shards"), &["shard"]), disk.until_then_bytes);
        assert!(kept <= said && said <= 4 * kept, "{said} said, {kept} taken: {text}");
    }
}

#[test]
fn a_file_system_with_too_little_room_is_warned_of_and_fills_without_harm() {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("small.toml"), CAMPAIGN.replace("262_144", "65_536")).expect("campaign");
    fs::create_dir(folder.path().join("out")).expect("folder");
    let script = "mount -t tmpfs -o size=64k tmpfs out || exit 99; \"$0\" measure small.toml -o out; code=$?; \
                  ls out; exit $code";
    let mut command = Command::new("unshare");
    command.current_dir(folder.path()).args(["-rm", "sh", "-c", script, env!("CARGO_BIN_EXE_gonio")]);
    // However slow the machine, no checkpoint is there to be kept.
    command.env("GONIO_CHECKPOINT_S", "86400");
    let output = command.output();
    let Some(output) = output.ok().filter(|output| matches!(output.status.code(), Some(0..=4))) else {
        println!("skipped: no file system of its own can be mounted here");
        return;
    };
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    let [warning, error] = said.lines().collect::<Vec<_>>()[..] else { panic!("two lines: {said}") };
    // Of 64 KiB, the folder and the lock take some.
    assert!(
        warning.starts_with("warning: out: ") && warning.contains(" KiB are free, results may take "),
        "{said}"
    );
    assert!(error.starts_with("error: out/small") && error.contains("No space left on device"), "{said}");
    let listed = String::from_utf8_lossy(&output.stdout);
    let left: Vec<&str> = listed.lines().filter(|line| line.starts_with("small")).collect();
    assert!(left.is_empty(), "nothing is left behind: {left:?}");
}
