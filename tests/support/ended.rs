//! Runs of the program that are ended, by a signal or otherwise, and gone on with.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use gonio::rng::uniform;
use rustix::process::{Pid, Signal, kill_process};

use super::failing::preloaded;
use super::program;
pub use super::program::{exits, folder};
use super::{measuring, outputs};

/// Calls that put something on the disk, of a run with some checkpoints: fewer than its last one.
const MOST_CALLS: f64 = 60.0;

/// The run, which keeps what it has after every 0.02 s of processor time.
pub fn measure(folder: &Path, words: &[&str]) -> Command {
    let mut command = program::command(folder, &["measure", "small.toml", "-o", "out"]);
    command.args(words);
    command.env("GONIO_CHECKPOINT_S", "0.02").stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

pub fn start(folder: &Path, words: &[&str]) -> Child {
    measure(folder, words).spawn().expect("starts")
}

pub fn run(folder: &Path, words: &[&str]) -> Output {
    start(folder, words).wait_with_output().expect("ends")
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
/// signal.
pub fn ended_by(folder: &Path, words: &[&str], signal: Signal, part: &str, times: u64) -> Output {
    let out = folder.join("out");
    fs::create_dir_all(&out).expect("folder");
    preloaded().ended(measure(folder, words), &out, signal, part, times)
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
            let output = preloaded().signalled(command, &out, Signal::KILL.as_raw(), call).output();
            ended_before += u32::from(output.expect("runs").status.code() == Some(0));
        }
        let output = run(folder.path(), &words);
        resumed += u32::from(exits(&output, 0).contains("note: resumes "));
        let ended = digests(folder.path());
        assert!(ended == *whole.files, "after kill {first}: {ended:?}\nnot {:?}", whole.files);
    }
    println!("{kills} kills: {ended_before} after its end, {resumed} runs resumed from what was kept");
    assert!(resumed > 0 && 2 * ended_before <= kills);
}
