//! Runs of the program that are ended, by a signal or otherwise, and gone on with.

// Each test program uses its own part.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::OnceLock;

use gonio::rng::uniform;
use rustix::process::{Pid, Signal, kill_process};
use tempfile::TempDir;

use super::failing::Failing;
use super::{measuring, outputs};

/// A folder with a campaign of the name `small`.
pub fn folder(text: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("small.toml"), text).expect("campaign");
    folder
}

/// Calls that put something on the disk, of a run with some checkpoints: fewer than its last one.
const MOST_CALLS: f64 = 60.0;

/// The run, which keeps what it has after every 0.02 s of processor time.
pub fn measure(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    command.current_dir(folder).args(["measure", "small.toml", "-o", "out"]).args(words);
    command.env("GONIO_CHECKPOINT_S", "0.02").stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

pub fn start(folder: &Path, words: &[&str]) -> Child {
    measure(folder, words).spawn().expect("starts")
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

/// Runs until so many files whose names have `part` in them have been put in their places, and then ends the run by a
/// signal: between two calls to the system, whatever the machine does besides.
pub fn ended_by(folder: &Path, words: &[&str], signal: Signal, part: &str, times: u64) -> Output {
    fs::create_dir_all(folder.join("out")).expect("folder");
    let command = measure(folder, words);
    let mut command = failing().signalled(command, &folder.join("out"), signal.as_raw(), times);
    command.env("FAILING_CALL", "rename").env("FAILING_NAME", part);
    command.output().expect("runs")
}

/// The preloaded library; where Rust can link, there is a C compiler.
fn failing() -> &'static Failing {
    static BUILT: OnceLock<Failing> = OnceLock::new();
    BUILT.get_or_init(|| Failing::built().expect("a C compiler"))
}

pub fn signal_to(child: &Child, signal: Signal) {
    let pid = Pid::from_raw(child.id().cast_signed()).expect("a process");
    kill_process(pid, signal).expect("alive");
}

/// A campaign with its options, and what it ends with.
pub struct Whole<'a> {
    pub text: &'a str,
    pub words: &'a [&'a str],
    pub files: &'a BTreeMap<String, String>,
}

/// Kills a run and what resumes it after random calls to the system, `kills` in all, a fresh run for every `chain` of
/// them.
pub fn killed(whole: &Whole, kills: u32, chain: u32) {
    let words = [whole.words, &["--resume"]].concat();
    let mut rng = measuring::test_rng(8);
    let (mut resumed, mut ended_before) = (0, 0);
    for first in (0..kills).step_by(chain as usize) {
        let folder = folder(whole.text);
        let out = folder.path().join("out");
        fs::create_dir(&out).expect("folder");
        for _ in first..kills.min(first + chain) {
            let call = 1 + (uniform(&mut rng) * MOST_CALLS) as u64;
            let command = measure(folder.path(), &words);
            let output = failing().signalled(command, &out, Signal::KILL.as_raw(), call).output();
            ended_before += u32::from(output.expect("runs").status.code() == Some(0));
        }
        let output = run(folder.path(), &words);
        resumed += u32::from(exits(&output, 0).contains("goes on from"));
        let ended = digests(folder.path());
        assert!(ended == *whole.files, "after kill {first}: {ended:?}\nnot {:?}", whole.files);
    }
    println!("{kills} kills: {ended_before} after its end, {resumed} runs resumed from what was kept");
    assert!(resumed > 0 && 2 * ended_before <= kills);
}
