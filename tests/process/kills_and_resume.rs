//! Promise: a run that is ended, in whatever way and at whatever time, is gone on with and ends with the bytes of one
//! that never stopped.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::thread;
use std::time::Duration;

use gonio::campaign;
use gonio::files::sealed;
use gonio::measure::persist::header::KIND;
use gonio::measure::{self, Checkpoint, Patches, Plan, RunState, Session, StoredRun};
use rustix::process::Signal;

use crate::support::ended::{self, Whole, digests, ended_by, run, signal_to, uninterrupted};
use crate::support::failing::Failing;
use crate::support::mutations;
use crate::support::program::{exits, folder};

/// A campaign of some seconds: two roughnesses, colours, two orders, incidences that share a sweep.
fn small(samples: u64, realisations: u32, stop: &str) -> String {
    format!(
        "name = \"small\"\nseed = 5\n\
         [surface]\nrealisations = {realisations}\ncells = 64\ncorrelation_cells = 4.0\n\
         [surface.ggx]\nalpha = [0.3, 0.5]\n\
         [light]\ntheta_i_deg = [0, 50]\n[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 12\n\
         [optics]\nmaterial = \"gold\"\n[trace]\nbounces = 2\n\
         [stop]\nsamples = {samples}\n{stop}\n"
    )
}

/// What the files of checkpoints have in their names.
const CHECKPOINT: &str = ".checkpoint_";
/// Long enough for several checkpoints.
const LONG: u64 = 131_072;

/// What the long campaign ends with.
fn whole() -> &'static BTreeMap<String, String> {
    static WHOLE: OnceLock<BTreeMap<String, String>> = OnceLock::new();
    WHOLE.get_or_init(|| uninterrupted(&small(LONG, 3, ""), &[]))
}

/// The checkpoints that are there.
fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    let paths = [0, 1].map(|slot| folder.join(format!("out/small.checkpoint_{slot}")));
    paths.into_iter().filter(|path| path.exists()).collect()
}

/// Kills the long campaign.
fn killed(kills: u32, chain: u32) {
    ended::killed(&Whole { text: &small(LONG, 3, ""), words: &[], files: whole() }, kills, chain);
}

#[test]
fn a_killed_run_ends_with_the_bytes_of_one_that_was_not() {
    killed(6, 3);
}

#[test]
fn a_killed_run_of_layered_facets_ends_with_the_same_bytes() {
    let layered = "facet = \"layered\"\neta = 1.5\nalbedo = [0.9, 0.5, 0.0]";
    let text = small(LONG, 3, "").replace("material = \"gold\"", layered);
    ended::killed(&Whole { text: &text, words: &[], files: &uninterrupted(&text, &[]) }, 2, 2);
}

#[test]
#[ignore = "takes minutes: cargo test --release --test process kills_and_resume -- --ignored fifty"]
fn fifty_killed_runs_end_with_the_bytes_of_one_that_was_not() {
    killed(50, 1);
}

#[test]
fn the_first_signal_keeps_what_is_measured_and_says_how_to_go_on() {
    let text = small(LONG, 3, "");
    let whole = whole();
    let folder = folder(&text);
    for (signal, words) in [(Signal::INT, &[][..]), (Signal::TERM, &["--resume", "--threads", "1"])] {
        let said = exits(&ended_by(folder.path(), words, signal, CHECKPOINT, 1), 130);
        let last = said.lines().last().expect("a line");
        assert!(last.starts_with("interrupted after ") && last.ends_with(" --resume"), "{said}");
        assert!(last.contains("resume with: gonio measure small.toml -o out"), "{said}");
    }
    // Not by mistake over what was measured.
    let refused = exits(&run(folder.path(), &[]), 3);
    assert!(refused.contains("small.checkpoint_") && refused.contains("--resume"), "{refused}");
    exits(&run(folder.path(), &["--resume", "--threads", "3"]), 0);
    assert_eq!(digests(folder.path()), *whole);
}

#[test]
fn the_second_signal_ends_at_once() {
    let Some(failing) = Failing::built() else { return };
    let folder = folder(&small(LONG, 3, ""));
    let (out, flag) = (folder.path().join("out"), folder.path().join("waits"));
    fs::create_dir(&out).expect("folder");
    fs::write(&flag, "").expect("the disk does not answer from now on");
    let mut child =
        failing.waiting_while(ended::measure(folder.path(), &[]), &out, &flag).spawn().expect("starts");
    while failing.failed().is_empty() {
        assert!(child.try_wait().expect("ours").is_none(), "ended before a checkpoint");
        thread::sleep(Duration::from_millis(5));
    }
    // The run cannot end by itself: its checkpoint waits. Two kinds, for two of a kind may be told as one.
    signal_to(&child, Signal::TERM);
    signal_to(&child, Signal::INT);
    exits(&child.wait_with_output().expect("ends"), 130);
    assert!(flag.exists() && checkpoints(folder.path()).is_empty());
}

#[test]
fn a_checkpoint_of_an_earlier_format_is_refused_by_a_line() {
    let folder = folder(&small(LONG, 3, ""));
    let out = folder.path().join("out");
    fs::create_dir(&out).expect("made");
    let checkpoint = out.join("small.checkpoint_1");
    fs::write(&checkpoint, "gonio checkpoint 3\nand its sums, longer than the head of today's")
        .expect("written");
    let said = exits(&run(folder.path(), &["--resume"]), 3);
    assert!(said.contains("out/small.checkpoint_1: is of another version or kind"), "{said}");
    assert!(said.contains("--force") && said.lines().count() == 1 && checkpoint.exists(), "{said}");
}

#[test]
fn a_damaged_checkpoint_gives_way_to_the_one_before() {
    let text = small(LONG, 3, "");
    let whole = whole();
    let folder = folder(&text);
    exits(&ended_by(folder.path(), &[], Signal::INT, CHECKPOINT, 2), 130);
    let found = Checkpoint::of(&folder.path().join("out"), "small").load().expect("whole").expect("there");
    let mut bytes = fs::read(&found.path).expect("readable");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    fs::write(&found.path, &bytes).expect("damaged");
    let both = tempfile::tempdir().expect("temporary folder");
    fs::create_dir(both.path().join("out")).expect("folder");
    fs::copy(folder.path().join("small.toml"), both.path().join("small.toml")).expect("copied");
    for (path, length) in checkpoints(folder.path()).iter().zip([0, 40]) {
        let cut = &fs::read(path).expect("readable")[..length];
        fs::write(both.path().join("out").join(path.file_name().expect("name")), cut).expect("cut off");
    }
    let said = exits(&run(folder.path(), &["--resume"]), 0);
    assert!(said.contains("checksum is wrong") && said.contains("note: resumes "), "{said}");
    assert_eq!(digests(folder.path()), *whole);
    let said = exits(&run(both.path(), &["--resume"]), 3);
    assert!(said.contains("small.checkpoint_") && said.contains("cut off"), "{said}");
    assert_eq!(checkpoints(both.path()).len(), 2, "what is damaged stays for whoever can mend it");
}

#[test]
fn another_campaign_is_refused_by_the_key_that_differs() {
    let text = small(LONG, 3, "");
    let folder = folder(&text);
    exits(&ended_by(folder.path(), &[], Signal::INT, CHECKPOINT, 1), 130);
    let changes = [
        ("alpha = [0.3, 0.5]", "alpha = [0.3, 0.6]", "surface.ggx.alpha = [0.3, 0.6]: [0.3, 0.5] in"),
        ("cells = 64", "cells = 128", "surface.cells = 128: 64 in"),
        ("seed = 5", "seed = 6", "seed = 6: 5 in"),
        ("[0, 50]", "[0, 51]", "light.theta_i_deg = [0.0, 51.0]: [0.0, 50.0] in"),
        ("samples = 131072", "samples = 65536", "of which more are allowed, not fewer"),
        ("realisations = 3", "realisations = 2", "surface.realisations = 2: 3 in"),
    ];
    for (old, new, said) in changes {
        assert!(text.contains(old), "{old}");
        fs::write(folder.path().join("small.toml"), text.replace(old, new)).expect("campaign");
        let refused = exits(&run(folder.path(), &["--resume"]), 2);
        assert!(refused.contains(said) && refused.contains("small.checkpoint_"), "{refused}");
    }
    // The same campaign, begun again on purpose.
    fs::write(folder.path().join("small.toml"), text.replace("131072", "65536")).expect("campaign");
    exits(&run(folder.path(), &["--force"]), 0);
    assert!(checkpoints(folder.path()).is_empty());
}

#[test]
fn more_samples_give_the_bytes_of_a_fresh_run() {
    // More realisations; and more samples where errors are looked at after 1, 2, 4, ... blocks, the third being the last
    // of the shorter run alone. What ends it before its time decides how much of it there is.
    let rule = "relative_error = 1e-4";
    let wide = |text: String| text.replace("cells = 64", "cells = 256");
    let of = [
        (small(65_536, 3, ""), small(LONG, 4, "")),
        (wide(small(150_000, 3, rule)), wide(small(5 * 65_536, 3, rule))),
    ];
    for (less, more) in of {
        let whole = uninterrupted(&more, &[]);
        let folder = folder(&less);
        exits(&ended_by(folder.path(), &[], Signal::INT, CHECKPOINT, 1), 130);
        fs::write(folder.path().join("small.toml"), &more).expect("campaign");
        let said = exits(&run(folder.path(), &["--resume"]), 0);
        assert!(said.contains("note: resumes "), "{said}");
        assert_eq!(digests(folder.path()), whole, "{less}");
    }
}

#[test]
fn tables_that_were_written_before_the_end_are_not_measured_again() {
    let text = small(LONG, 3, "");
    let (folder, whole) = (folder(&text), folder(&text));
    exits(&run(whole.path(), &[]), 0);
    assert_eq!(ended_by(folder.path(), &[], Signal::KILL, CHECKPOINT, 1).status.code(), None);
    for end in ["exr", "realisations.exr", "json", "html", "card.md"] {
        let name = format!("out/small_alpha_0.3.{end}");
        fs::copy(whole.path().join(&name), folder.path().join(&name)).expect("copied");
    }
    let said = exits(&run(folder.path(), &["--resume"]), 0);
    assert!(said.contains("note: resumes "), "{said}");
    assert_eq!(digests(folder.path()), digests(whole.path()));
}

/// A campaign of the library, and what it keeps after its end.
fn kept_bytes() -> (campaign::Campaign, Plan, Vec<u8>) {
    let text = small(65_536, 1, "").replace("[0.3, 0.5]", "0.3");
    let folder = folder(&text);
    let parsed = campaign::parse(&text, "small.toml", folder.path()).expect("a campaign");
    let plan = measure::plan(&parsed.campaign).expect("small");
    let patches = Patches::prepare(&parsed.campaign, &mut Vec::new()).expect("patches");
    let (empty, session) = (RunState::new(&parsed.campaign, &plan), Session::plain(&|_| ()));
    let run_state =
        measure::measure_missing(&parsed.campaign, &plan, &patches, empty, &session).expect("no ray is lost");
    let bytes = run_state.to_bytes(1, &parsed.campaign, &plan).expect("encodes");
    (parsed.campaign, plan, bytes)
}

#[test]
fn damaged_checkpoints_are_errors_and_never_panic() {
    let (campaign, plan, bytes) = kept_bytes();
    let whole = StoredRun::from_bytes(&bytes).expect("whole");
    assert!(whole.header.faults((&campaign, None), "small.toml", "out").is_empty());
    whole.run_state(&campaign, &plan).expect("fits");
    let content = sealed::open(KIND, &bytes).expect("whole").to_vec();
    // A checksum that fits, as if somebody had meant it: what it holds is wrong, or could be a run_state all the same.
    let refused = mutations::survives(&content, 20_000, |damaged| {
        let sealed = sealed::seal(KIND, damaged.len(), |head| Ok::<_, String>([&head, damaged].concat()))?;
        let kept = StoredRun::from_bytes(&sealed)?;
        match kept.header.faults((&campaign, None), "small.toml", "out").first() {
            Some(fault) => Err(fault.to_string()),
            None => kept.run_state(&campaign, &plan).map(|_| ()),
        }
    });
    assert!(refused > 10_000, "{refused}");
}
