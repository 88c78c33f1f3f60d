//! Promise: whichever call to the system fails, at each single place, every file stays old or becomes new, and whole, and
//! one line says why.
//!
//! Tried are the first and the last call of every command, the first of every kind on every kind of file, and of the
//! others one in eight, which ones differing from command to command; with GONIO_LONG=1 all of them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use gonio::campaign;
use gonio::measure;

use crate::support::failing::Failing;
use crate::support::long::or_long;
use crate::support::outputs::{self, copied};
use crate::support::program::{command, exits, gonio, stderr};

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
[optics]
material = \"gold\"
[stop]
samples = 16_384
";

type Files = BTreeMap<String, String>;

/// A command over files that are there, and what becomes of them.
struct Case<'a> {
    folder: &'a Path,
    words: &'a [&'a str],
    /// The output folder as it was before, and as it is when nothing fails.
    old: PathBuf,
    before: Files,
    after: Files,
}

impl<'a> Case<'a> {
    /// `words` over what lies in `out`.
    fn new(folder: &'a Path, words: &'a [&'a str]) -> Self {
        let (out, old) = (folder.join("out"), folder.join("old"));
        copied(&out, &old);
        let before = outputs::digests(&out);
        exits(&gonio(folder, words), 0);
        let after = outputs::digests(&out);
        let same = before.iter().filter(|(name, digest)| after.get(*name) == Some(digest)).count();
        assert!(after.len() > same, "{words:?}: something is replaced");
        Case { folder, words, old, before, after }
    }

    /// Lets one call fail after the other (`all`: with every call after it but removals). Returns how many there are.
    fn each_call(&self, failing: &Failing, all: bool) -> u64 {
        let out = self.folder.join("out");
        copied(&self.old, &out);
        let calls = failing.calls(command(self.folder, self.words), &out);
        // Where several fail, those behind which only removals come make nothing fail.
        let may_fail = |call: &String| !all || !call.starts_with("unlink");
        let count = calls.iter().rposition(may_fail).map_or(0, |last| last as u64 + 1);
        for first in or_long(some_calls(&calls[..count as usize], self.words), (1..=count).collect()) {
            copied(&self.old, &out);
            let last = if all { u64::MAX >> 1 } else { first };
            let (output, failed) = failing.run(command(self.folder, self.words), &out, (first, last));
            let call = failed.first().unwrap_or_else(|| panic!("call {first} of {calls:?} was not made"));
            self.holds(&output, call, &format!("call {first} and the last one {last}: {failed:?}"));
        }
        copied(&self.old, &out);
        let (output, failed) =
            failing.run(command(self.folder, self.words), &out, (count + 1, u64::MAX >> 1));
        assert!(!all || failed.is_empty(), "{failed:?} behind {calls:?}");
        if failed.is_empty() {
            assert_eq!((output.status.code(), outputs::digests(&out)), (Some(0), self.after.clone()));
        }
        count
    }

    /// What must hold after this `call` failed.
    fn holds(&self, output: &Output, call: &str, at: &str) {
        let (text, mut files) = (stderr(output), outputs::digests(&self.folder.join("out")));
        // Finished bands are kept for a run that goes on.
        files.retain(|name, _| !name.starts_with("small.band_"));
        let at = format!("{:?}, {at}\n{text}{files:?}", self.words);
        if output.status.code() == Some(0) {
            // What a lock's file says is for the eye, and without their process lock and claim hold nobody.
            let eye = call.ends_with("-lock") && !call.starts_with("open");
            assert!(eye || (call.starts_with("unlink") && call.ends_with(".claim")), "{at}");
        } else {
            assert_eq!(output.status.code(), Some(3), "{at}");
            let errors: Vec<&str> = text.lines().filter(|line| !line.starts_with("note: ")).collect();
            let [error] = errors[..] else { panic!("one line: {at}") };
            assert!(error.starts_with("error: out") && error.contains("No space left on device"), "{at}");
        }
        let staged = ["measure", "recolour", "report"].contains(&self.words[0]);
        if staged && ["open", "write"].iter().any(|name| call.starts_with(name)) && !call.ends_with("-lock") {
            assert_eq!(files, self.before, "for want of room nothing is replaced: {at}");
        }
        // A file that is not to be removed stays; the run after it sees to it. Bands that are finished are kept for it.
        let may_stay =
            |name: &str| call.starts_with("unlink") && call.ends_with(name) || name.contains(".band_");
        for (name, digest) in &files {
            let is_old = self.before.get(name) == Some(digest);
            let is_new = self.after.get(name) == Some(digest);
            assert!(is_old || is_new || may_stay(name), "{name}: {at}");
        }
        // Only a summary goes before its new one comes: what lies there belongs to no finished table then.
        let gone: Vec<&String> = self.before.keys().filter(|name| !files.contains_key(*name)).collect();
        let unfinished = gone.iter().any(|name| name.ends_with(".json"));
        assert!(gone.iter().all(|name| name.ends_with(".json")), "{gone:?}: {at}");
        if !unfinished && self.before.contains_key("small.json") && self.words[0] == "measure" {
            let whole = |all: &Files| all.iter().all(|(name, digest)| files.get(name) == Some(digest));
            assert!(whole(&self.before) || whole(&self.after), "{at}");
        }
    }
}

/// The numbers of the first and the last call, of the first of every kind on every kind of file, and of one in eight.
fn some_calls(calls: &[String], words: &[&str]) -> Vec<u64> {
    let offset = words.concat().bytes().map(usize::from).sum::<usize>();
    let mut kinds = BTreeSet::new();
    let mut is_tried = |(place, call): (usize, &String)| {
        let (name, path) = call.split_once(' ').expect("a name and a file");
        let end = Path::new(path).file_name().and_then(|name| name.to_str()?.rsplit('.').next());
        // Bands and temporary files have their numbers at the end.
        let kind = end.unwrap_or_default().trim_end_matches(|c: char| !c.is_ascii_alphabetic());
        kinds.insert((name.to_string(), kind.to_string()))
            || place + 1 == calls.len()
            || (place + offset).is_multiple_of(8)
    };
    calls.iter().enumerate().filter(|call| is_tried(*call)).map(|(place, _)| place as u64 + 1).collect()
}

#[test]
fn every_call_of_a_measurement_may_fail() {
    let Some(failing) = Failing::built() else { return };
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("small.toml"), CAMPAIGN).expect("campaign");
    exits(&gonio(folder.path(), &["measure", "small.toml", "-o", "out"]), 0);
    let words = ["measure", "small.toml", "-o", "out", "--force", "--seed", "6"];
    let case = Case::new(folder.path(), &words);
    let calls = case.each_call(&failing, false);
    // The last calls remove the checkpoints, of which there are none, the lock and the claim.
    assert_eq!(case.each_call(&failing, true), calls - 4);
    // Five files: each is opened, written, flushed and renamed, and its folder is flushed.
    assert!(calls >= 25, "{calls}");
}

#[test]
fn every_call_of_a_run_in_bands_may_fail() {
    let Some(failing) = Failing::built() else { return };
    let folder = tempfile::tempdir().expect("temporary folder");
    // As many bins as a budget in MiB needs to tell three bands apart.
    let text =
        CAMPAIGN.replace("theta_r_bins = 6", "theta_r_bins = 36").replace("[0, 50]", "[0, 20, 40, 50, 60]");
    let text = text.replace("phi_r_bins = 12", "phi_r_bins = 72").replace("65_536", "4096");
    fs::write(folder.path().join("small.toml"), &text).expect("campaign");
    let campaign = campaign::parse(text, "small", folder.path()).expect("sound").campaign;
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("threads");
    let fits = |mb: &u64| measure::plan_within(&campaign, mb << 20).is_ok_and(|plan| plan.bands().len() == 3);
    let mb = one.install(|| (1..1000).find(fits)).expect("a budget for three bands").to_string();
    let words =
        |seed| ["measure", "small.toml", "-o", "out", "--threads", "1", "--memory-mb", &mb, "--seed", seed];
    exits(&gonio(folder.path(), &words("5")), 0);
    let words = [&words("6")[..], &["--force"]].concat();
    let case = Case::new(folder.path(), &words);
    // Each band has a file besides, which is opened, written, flushed, renamed and removed.
    let calls = case.each_call(&failing, false);
    assert!(calls >= 40, "{calls}");
}

#[test]
fn every_call_of_the_other_commands_may_fail() {
    let Some(failing) = Failing::built() else { return };
    let folder = tempfile::tempdir().expect("temporary folder");
    let here = folder.path();
    fs::write(here.join("small.toml"), CAMPAIGN).expect("campaign");
    for (name, seed) in [("one", "5"), ("two", "6")] {
        exits(&gonio(here, &["measure", "small.toml", "-o", name, "--seed", seed]), 0);
    }
    let mut cases: Vec<Vec<&str>> = vec![
        vec!["recolour", "TABLE", "--material", "silver", "-o", "out/silver.exr", "--force"],
        vec!["report", "TABLE", "-o", "out/small.html"],
        vec!["report", "TABLE", "-o", "out/small.md"],
        vec!["surface", "small.toml", "-o", "out", "--npy", "--seed", "SEED", "--force"],
    ];
    // The text formats of trees and patches are made whole before a file is opened, as RGL is: one way to write.
    for format in ["npy", "csv", "npz", "rgl", "astm", "exr_parts"] {
        cases.push(vec!["export", "TABLE", "--to", format, "-o", "out/exported", "--force"]);
    }
    for words in &cases {
        let of = |table: &'static str, seed: &'static str| {
            let word = |&word: &&'static str| match word {
                "TABLE" => table,
                "SEED" => seed,
                other => other,
            };
            words.iter().map(word).collect::<Vec<&str>>()
        };
        fs::remove_dir_all(here.join("out")).ok();
        fs::create_dir(here.join("out")).expect("a folder");
        exits(&gonio(here, &of("one/small.exr", "5")), 0);
        let second = of("two/small.exr", "6");
        let case = Case::new(here, &second);
        let calls = case.each_call(&failing, false);
        assert!((1..=calls).contains(&case.each_call(&failing, true)), "{words:?}");
        assert!(calls >= 4, "{words:?}: {calls}");
    }
}
