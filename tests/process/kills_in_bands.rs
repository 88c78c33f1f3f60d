//! Promise: a run in bands of incidences, for want of memory, is kept and gone on with as any other, and in the bands that it
//! began with.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use gonio::campaign;
use gonio::measure;
use rustix::process::Signal;

use crate::support::ended::{self, Whole, digests, ended_by, run, uninterrupted};
use crate::support::program::{exits, folder};

/// Two roughnesses, two orders, colours, eight incidences at two azimuths; a second for all of them.
fn small(samples: u64) -> String {
    format!(
        "name = \"small\"\nseed = 5\n\
         [surface]\nrealisations = 2\ncells = 64\ncorrelation_cells = 4.0\n\
         [surface.ggx]\nalpha = [0.3, 0.5]\n\
         [light]\ntheta_i_deg = [0, 20, 40, 60]\nazimuth = \"absolute\"\nphi_i_deg = [0, 50]\n\
         [sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\n\
         [optics]\nmaterial = \"gold\"\n[trace]\nbounces = 2\n\
         [stop]\nsamples = {samples}\n"
    )
}

const LONG: u64 = 65_536;
const SHORT: u64 = 32_768;

/// MiB that give so many bands on two threads.
fn mb_of(bands: usize) -> String {
    let campaign = campaign::parse(small(LONG), "small", Path::new("")).expect("sound").campaign;
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    let fits =
        |mb: &u64| measure::plan_within(&campaign, mb << 20).is_ok_and(|plan| plan.bands().len() == bands);
    two.install(|| (1..1000).find(fits)).expect("a budget for so many bands").to_string()
}

/// The options of a run in three bands.
fn in_three() -> [&'static str; 4] {
    static MB: OnceLock<String> = OnceLock::new();
    ["--threads", "2", "--memory-mb", MB.get_or_init(|| mb_of(3))]
}

fn with<'a>(words: &[&'a str]) -> Vec<&'a str> {
    [&in_three()[..], words].concat()
}

/// What the long campaign ends with in three bands.
fn whole() -> &'static BTreeMap<String, String> {
    static WHOLE: OnceLock<BTreeMap<String, String>> = OnceLock::new();
    WHOLE.get_or_init(|| uninterrupted(&small(LONG), &in_three()))
}

fn band(folder: &Path, number: u32) -> PathBuf {
    folder.join(format!("out/small.band_{number}_of_3"))
}

/// Lines that are no notes.
fn errors(said: &str) -> usize {
    said.lines().filter(|line| !line.starts_with("note: ")).count()
}

/// A run of the long campaign that is ended in its second band.
fn begun(signal: Signal) -> (tempfile::TempDir, std::process::Output) {
    let folder = folder(&small(LONG));
    let output = ended_by(folder.path(), &in_three(), signal, "small.band_", 1);
    assert!(!band(folder.path(), 3).exists());
    (folder, output)
}

fn killed(kills: u32, chain: u32) {
    ended::killed(&Whole { text: &small(LONG), words: &in_three(), files: whole() }, kills, chain);
}

#[test]
fn a_run_in_bands_that_is_killed_ends_with_the_same_bytes() {
    killed(6, 3);
}

#[test]
#[ignore = "takes minutes: cargo test --release --test process kills_in_bands -- --ignored fifty"]
fn fifty_killed_runs_in_bands_end_with_the_same_bytes() {
    killed(50, 2);
}

#[test]
fn a_run_in_bands_has_the_tables_of_one_at_once() {
    let at_once = uninterrupted(&small(LONG), &["--threads", "1"]);
    let tables = |files: &BTreeMap<String, String>| {
        files.clone().into_iter().filter(|(name, _)| name.ends_with(".exr")).collect::<Vec<_>>()
    };
    assert_eq!((tables(&at_once).len(), tables(&at_once)), (4, tables(whole())));
    assert_eq!(at_once.keys().collect::<Vec<_>>(), *whole().keys().collect::<Vec<_>>(), "and nothing else");
}

#[test]
fn the_first_signal_says_how_to_go_on_and_the_bands_stay_as_they_were() {
    let (folder, output) = begun(Signal::INT);
    let said = exits(&output, 130);
    let last = said.lines().last().expect("a line");
    // The second band may not have begun yet: then the first one's results were not waited for.
    let at = last.contains(" band 2 of 3") || last.starts_with("interrupted before its end; ");
    assert!(last.starts_with("interrupted ") && at, "{said}");
    let again = format!("gonio measure small.toml -o out --memory-mb {} --threads 2 --resume", in_three()[3]);
    assert!(last.ends_with(&again), "{said}");
    // Not by mistake over what was measured.
    let refused = exits(&run(folder.path(), &in_three()), 3);
    assert!(refused.contains("out/small.") && refused.contains("--resume"), "{refused}");
    // Less memory than a band needs.
    let refused = exits(&run(folder.path(), &["--resume", "--threads", "2", "--memory-mb", &mb_of(8)]), 4);
    assert!(
        refused.contains("incidences, as it began, which needs about ") && refused.contains("MiB"),
        "{refused}"
    );
    assert_eq!(errors(&refused), 1, "{refused}");
    // More than the whole needs.
    let said = exits(&run(folder.path(), &["--resume", "--threads", "1"]), 0);
    assert!(said.contains("resumes out/small."), "{said}");
    assert_eq!(digests(folder.path()), *whole());
}

#[test]
fn a_run_of_all_stops_is_not_gone_on_with_in_bands() {
    let folder = folder(&small(LONG));
    let checkpoint = folder.path().join("out/small.checkpoint_1");
    let output = ended_by(folder.path(), &["--threads", "2"], Signal::INT, ".checkpoint_", 1);
    exits(&output, 130);
    let refused = exits(&run(folder.path(), &with(&["--resume"])), 4);
    assert!(refused.contains("is resumed with all incidences at once, as it began"), "{refused}");
    assert_eq!(errors(&refused), 1, "{refused}");
    assert!(checkpoint.exists());
    exits(&run(folder.path(), &["--resume"]), 0);
}

#[test]
fn a_damaged_band_is_named_and_can_be_measured_again() {
    let (folder, _) = begun(Signal::KILL);
    let first = band(folder.path(), 1);
    let kept = fs::read(&first).expect("readable");
    let mut flipped = kept.clone();
    flipped[kept.len() / 2] ^= 4;
    for (damaged, said) in
        [(&flipped[..], "checksum is wrong"), (&kept[..kept.len() / 3], "needed"), (&[], "cut off")]
    {
        fs::write(&first, damaged).expect("damaged");
        let refused = exits(&run(folder.path(), &with(&["--resume"])), 3);
        assert!(refused.contains("out/small.band_1_of_3: ") && refused.contains(said), "{refused}");
        assert!(refused.contains("--force") && errors(&refused) == 1, "{refused}");
        assert!(first.exists(), "what is damaged stays for whoever can mend it");
    }
    // Another band's file in its place.
    fs::write(band(folder.path(), 3), &kept).expect("copied");
    fs::remove_file(&first).expect("there");
    let refused = exits(&run(folder.path(), &with(&["--resume"])), 3);
    assert!(refused.contains("small.band_3_of_3: is not what its name says"), "{refused}");
    fs::remove_file(band(folder.path(), 3)).expect("there");
    exits(&run(folder.path(), &with(&["--resume"])), 0);
    assert_eq!(digests(folder.path()), *whole());
}

#[test]
fn bands_of_another_campaign_are_refused_by_its_key_and_removed_by_force() {
    let (folder, _) = begun(Signal::KILL);
    fs::write(folder.path().join("small.toml"), small(LONG).replace("seed = 5", "seed = 6"))
        .expect("campaign");
    let refused = exits(&run(folder.path(), &with(&["--resume"])), 2);
    assert!(refused.contains("seed = 6: 5 in the run that out/small."), "{refused}");
    let short = small(SHORT).replace("seed = 5", "seed = 6");
    fs::write(folder.path().join("small.toml"), &short).expect("campaign");
    exits(&run(folder.path(), &with(&["--force"])), 0);
    assert_eq!(digests(folder.path()), uninterrupted(&short, &in_three()));
}

#[test]
fn more_samples_go_on_in_every_band() {
    let (folder, _) = begun(Signal::KILL);
    let more = small(LONG + SHORT);
    fs::write(folder.path().join("small.toml"), &more).expect("campaign");
    // Ended again in a band that had been finished with fewer samples.
    ended_by(folder.path(), &with(&["--resume"]), Signal::KILL, "out/small.", 1);
    let said = exits(&run(folder.path(), &with(&["--resume"])), 0);
    assert!(said.contains("note: resumes "), "{said}");
    assert_eq!(digests(folder.path()), uninterrupted(&more, &in_three()));
}
