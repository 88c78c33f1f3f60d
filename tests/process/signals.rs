//! Promise: whatever a command does, SIGTERM ends it within a second, with code 130 and one line; no file under way and no
//! lock stays, and `--resume` ends with the bytes of a run that never stopped.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::Signal;
use tempfile::TempDir;

use crate::support::long::or_long;
use crate::support::program::exits;
use crate::support::{ended, outputs, processor_time};

/// No answer at all.
const HANGS: Duration = Duration::from_secs(60);

/// Patches take most of the time, each of them about a second of a test build.
const PATCHES: &str = "\
name = \"small\"
seed = 5
[surface]
realisations = 2
cells = 768
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = [0, 50]
[sensor.hemisphere]
[stop]
samples = 65_536
";

/// So do the map and its refinement.
const MAP: &str = "\
name = \"small\"
seed = 5
[surface.file]
path = \"map.npy\"
pitch_x_um = 1
pitch_y_um = 1
height_unit_um = 1
periodic = true
refine = 4
tiles = 2
[light]
theta_i_deg = [0, 50]
azimuth = \"absolute\"
phi_i_deg = [0]
[sensor.hemisphere]
[stop]
samples = 262_144
";

/// So do paths, theory and results.
const INCIDENCES: &str = "\
name = \"small\"
seed = 5
[surface]
realisations = 4
cells = 128
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = [0, 20, 40, 60, 80]
[sensor.hemisphere]
theta_r_bins = 30
phi_r_bins = 72
[optics]
material = \"gold\"
[stop]
samples = 131_072
";

/// A command over a campaign, in a folder of its own.
struct Case {
    campaign: &'static str,
    words: &'static [&'static str],
    /// What goes on after it was ended.
    again: &'static [&'static str],
    /// Its threads, or cores where it has no such option: what it may use of the processor in a second.
    threads: u32,
}

// One after the other, patches take longer than a second of the processor from most of the times at which a signal comes.
const MEASURE_BY_ONE: &[&str] = &["measure", "small.toml", "-o", "out", "--threads", "1"];
const RESUME_BY_ONE: &[&str] = &["measure", "small.toml", "-o", "out", "--threads", "1", "--resume"];
const MEASURE: &[&str] = &["measure", "small.toml", "-o", "out", "--threads", "2"];
const RESUME: &[&str] = &["measure", "small.toml", "-o", "out", "--threads", "2", "--resume"];
const SURFACE: &[&str] = &["surface", "small.toml", "-o", "out", "--threads", "1"];
const VALIDATE: &[&str] = &["validate", "table/small.exr"];

const CASES: [Case; 5] = [
    Case { campaign: PATCHES, words: MEASURE_BY_ONE, again: RESUME_BY_ONE, threads: 1 },
    Case { campaign: MAP, words: MEASURE, again: RESUME, threads: 2 },
    Case { campaign: INCIDENCES, words: MEASURE, again: RESUME, threads: 2 },
    Case { campaign: PATCHES, words: SURFACE, again: SURFACE, threads: 1 },
    Case { campaign: INCIDENCES, words: VALIDATE, again: VALIDATE, threads: 2 },
];

impl Case {
    /// What the command reads.
    fn folder(&self, table: &Path) -> TempDir {
        let folder = ended::folder(self.campaign);
        if self.campaign == MAP {
            fs::write(folder.path().join("map.npy"), map()).expect("map");
        }
        if self.words == VALIDATE {
            let to = folder.path().join("table");
            fs::create_dir(&to).expect("folder");
            for entry in fs::read_dir(table).expect("a finished table") {
                let path = entry.expect("entry").path();
                fs::copy(&path, to.join(path.file_name().expect("name"))).expect("copied");
            }
        }
        folder
    }
}

/// A rough map of 300 x 200 heights.
fn map() -> Vec<u8> {
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (200, 300), }\n";
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    let wave = |x: usize, y: usize| (0.3 * x as f32).sin() * (0.21 * y as f32).cos();
    bytes.extend((0..200 * 300).flat_map(|i| wave(i % 300, i / 300).to_le_bytes()));
    bytes
}

fn start(folder: &Path, words: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    command.current_dir(folder).args(words).stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("starts")
}

fn ends(folder: &Path, words: &[&str]) -> Output {
    start(folder, words).wait_with_output().expect("ends")
}

/// All files of the output; nothing but whole ones may be there.
fn digests(folder: &Path) -> BTreeMap<String, String> {
    let out = folder.join("out");
    if out.exists() { outputs::digests(&out) } else { BTreeMap::new() }
}

/// Waits until a process answers SIGTERM: one that has not come so far yet has made nothing, and ends as any other.
fn listens(child: &Child) {
    let path = format!("/proc/{}/status", child.id());
    loop {
        let status = fs::read_to_string(&path).expect("a child that was not waited for");
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).expect("a mask");
        let mask = u64::from_str_radix(mask.trim(), 16).expect("a mask");
        if mask >> (Signal::TERM.as_raw() - 1) & 1 == 1 || processor_time::used(child).1 {
            return;
        }
        thread::sleep(Duration::from_millis(1));
    }
}

/// How long it takes a command to end after SIGTERM, on the wall and of the processor.
fn answer(child: &Child) -> (Duration, Duration) {
    let (before, _) = processor_time::used(child);
    ended::signal_to(child, Signal::TERM);
    let asked = Instant::now();
    loop {
        let (used, is_ended) = processor_time::used(child);
        if is_ended {
            return (asked.elapsed(), used - before);
        }
        assert!(asked.elapsed() < HANGS, "no answer");
        thread::sleep(Duration::from_millis(2));
    }
}

/// Ends each command `tries` times, at times that are spread evenly over its run: the golden ratio's sequence.
fn answered(tries: u32) {
    let mut times = (1..).map(|number| (f64::from(number) * 0.618_033_988_749_894_9).fract());
    let finished = ended::folder(INCIDENCES);
    exits(&ends(finished.path(), MEASURE), 0);
    let table = finished.path().join("out");
    let mut all = 0;
    for case in &CASES {
        let whole = case.folder(&table);
        let begin = Instant::now();
        exits(&ends(whole.path(), case.words), 0);
        let (takes, files) = (begin.elapsed(), digests(whole.path()));
        let (mut wall, mut processor, mut ended_early) = (Duration::ZERO, Duration::ZERO, 0);
        for number in 0..tries {
            let folder = case.folder(&table);
            let child = start(folder.path(), case.words);
            listens(&child);
            thread::sleep(takes.mul_f64(times.next().expect("endless")));
            let took = answer(&child);
            (wall, processor) = (wall.max(took.0), processor.max(took.1));
            let output = child.wait_with_output().expect("ends");
            if output.status.code() != Some(0) {
                let said = exits(&output, 130);
                let last = said.lines().last().unwrap_or_default();
                assert!(last.starts_with("interrupted "), "{:?}, try {number}: {said}", case.words);
                ended_early += 1;
            }
            let left = digests(folder.path());
            assert!(
                !left.keys().any(|name| name.starts_with('.')),
                "{:?}, try {number}: {left:?}",
                case.words
            );
            exits(&ends(folder.path(), case.again), 0);
            assert!(digests(folder.path()) == files, "{:?}, try {number}: other bytes", case.words);
        }
        println!(
            "{:?}: {ended_early} of {tries} ended early, after {wall:?} at most, {processor:?} of the processor",
            case.words
        );
        // A second of every thread, and two ticks of rounding.
        assert!(
            processor <= case.threads * Duration::from_secs(1) + Duration::from_millis(20),
            "{processor:?}"
        );
        all += ended_early;
    }
    // Power: a signal at a time that is anywhere in the run finds most of them under way; a short one ends by itself.
    assert!(4 * all >= tries * CASES.len() as u32, "{all} ended early");
}

#[test]
fn every_command_answers_a_signal_within_a_second() {
    answered(or_long(1, 3));
}

#[test]
#[ignore = "takes minutes: cargo test --release --test process a_hundred_signals -- --ignored"]
fn a_hundred_signals_are_answered_within_a_second() {
    answered(20);
}
