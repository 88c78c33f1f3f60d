//! Runs of the program that are ended, by a signal or otherwise, and gone on with.

// Each test program uses its own part.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::Duration;

use gonio::measure::Checkpoint;
use gonio::rng::uniform;
use rustix::process::{Pid, Signal, kill_process};
use tempfile::TempDir;

use super::{measuring, outputs};

/// A folder with a campaign of the name `small`.
pub fn folder(text: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("small.toml"), text).expect("campaign");
    folder
}

pub fn start(folder: &Path, words: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    command.current_dir(folder).args(["measure", "small.toml", "-o", "out"]).args(words);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("starts")
}

pub fn run(folder: &Path, words: &[&str]) -> Output {
    start(folder, words).wait_with_output().expect("ends")
}

/// What a run said on stderr that ended with this code.
#[track_caller]
pub fn exits(output: &Output, code: i32) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{text}");
    text
}

/// All files in the output folder.
pub fn digests(folder: &Path) -> BTreeMap<String, String> {
    outputs::digests(&folder.join("out"))
}

/// What a campaign ends with that nothing interrupts.
pub fn uninterrupted(text: &str, words: &[&str]) -> BTreeMap<String, String> {
    let folder = folder(text);
    exits(&run(folder.path(), words), 0);
    digests(folder.path())
}

/// Runs until so many new checkpoints have been written, and then ends the run by a signal.
pub fn ended_by(folder: &Path, words: &[&str], signal: Signal, seen: u64) -> Output {
    let checkpoint = Checkpoint::of(&folder.join("out"), "small");
    let number = || checkpoint.load().expect("whole").map_or(0, |found| found.kept.heading.number);
    let before = number();
    ended_when(folder, words, signal, || number() >= before + seen)
}

/// Runs until it is time, and then ends the run by a signal.
pub fn ended_when(folder: &Path, words: &[&str], signal: Signal, is_time: impl Fn() -> bool) -> Output {
    let mut child = start(folder, words);
    while !is_time() {
        assert!(child.try_wait().expect("ours").is_none(), "ended before it was to be ended");
        thread::sleep(Duration::from_millis(20));
    }
    signal_to(&child, signal);
    child.wait_with_output().expect("ends")
}

pub fn signal_to(child: &Child, signal: Signal) {
    let pid = Pid::from_raw(child.id().cast_signed()).expect("a process");
    kill_process(pid, signal).expect("alive");
}

/// A campaign with its options, what it ends with, and how long that takes.
pub struct Whole<'a> {
    pub text: &'a str,
    pub words: &'a [&'a str],
    pub files: &'a BTreeMap<String, String>,
    pub takes: Duration,
}

/// Kills a run and what goes on with it at random times, `kills` in all, a fresh run for every `chain` of them.
pub fn killed(whole: &Whole, kills: u32, chain: u32) {
    let words = [whole.words, &["--resume"]].concat();
    let mut rng = measuring::test_rng(8);
    let mut resumed = 0;
    for first in (0..kills).step_by(chain as usize) {
        let folder = folder(whole.text);
        for _ in first..kills.min(first + chain) {
            let mut child = start(folder.path(), &words);
            thread::sleep(whole.takes.mul_f64(uniform(&mut rng)));
            child.kill().expect("still ours");
            child.wait().expect("ends");
        }
        let output = run(folder.path(), &words);
        resumed += u32::from(exits(&output, 0).contains("goes on from"));
        let ended = digests(folder.path());
        assert!(ended == *whole.files, "after kill {first}: {ended:?}\nnot {:?}", whole.files);
    }
    assert!(resumed > 0, "no run went on from what was kept");
}
