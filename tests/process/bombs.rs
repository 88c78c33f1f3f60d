//! Promise: no file makes the program take more memory than it says it may: sizes are judged before room is made for them.
//!
//! The program runs under `ulimit -v` of 2 GB, so that it may use at most half of that by its own rule; what it answers is
//! one line with exit code 3 or 4 (2 of a campaign), and what it takes stays below the limit itself, measured as VmHWM. Linux only.
#![cfg(target_os = "linux")]

#[path = "bombs/files.rs"]
mod files;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use files::Bomb;

/// Address space, KiB; the program uses at most half of what is left of it.
const SPACE_KIB: u64 = 2_000_000;

/// How a run ended.
struct Ended {
    code: Option<i32>,
    said: String,
    /// Largest resident memory that was seen, KiB.
    peak_kib: u64,
}

/// Runs the program in `folder` with its address space limited.
fn run(folder: &Path, arguments: &[&str]) -> Ended {
    let mut child = Command::new("sh")
        .args(["-c", &format!("ulimit -v {SPACE_KIB}; exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_gonio")])
        .args(arguments)
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("sh starts");
    let status = format!("/proc/{}/status", child.id());
    let mut peak_kib = 0;
    let code = loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
        peak_kib = peak_kib.max(kib.unwrap_or(0));
        if let Some(status) = child.try_wait().expect("a child") {
            break status.code();
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    let mut said = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().expect("piped"), &mut said).expect("a text");
    Ended { code, said, peak_kib }
}

/// What is wrong with the answer to a bomb, if anything.
fn fault(bomb: &Bomb, codes: &[i32]) -> Option<String> {
    let folder = tempfile::tempdir().expect("temporary folder");
    (bomb.write)(folder.path());
    let arguments: Vec<&str> = bomb.arguments.split(' ').collect();
    let Ended { code, said, peak_kib } = run(folder.path(), &arguments);
    println!("{:28} {code:?} {:5} MiB  {}", bomb.name, peak_kib >> 10, said.trim());
    let lines: Vec<&str> =
        said.lines().filter(|line| !line.starts_with("note:") && !line.starts_with("warning:")).collect();
    // A campaign has a line for each of its faults.
    let one_line = lines.len() == 1 || code == Some(0) || code == Some(2);
    let refused = code.is_some_and(|code| codes.contains(&code)) && one_line;
    let wrong = !refused || peak_kib > SPACE_KIB / 2 || said.contains("panic") || said.len() > 2000;
    wrong.then(|| format!("{}: {code:?}, {} MiB: {said}", bomb.name, peak_kib >> 10))
}

#[test]
fn bombs_are_refused_in_one_line_within_the_memory_that_may_be_used() {
    let bombs = files::all(1.0);
    assert!(bombs.len() >= 20);
    let faults: Vec<String> = bombs.iter().filter_map(|bomb| fault(bomb, &[2, 3, 4])).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Nothing is wrong with such a file: another machine may read it.
#[test]
fn what_would_take_too_much_memory_is_refused_for_that() {
    let names = ["csv gaps of colours", "rgl lights", "exr table", "exr maps", "map exr"];
    let bombs: Vec<Bomb> = files::all(1.0).into_iter().filter(|bomb| names.contains(&&*bomb.name)).collect();
    assert_eq!(bombs.len(), names.len());
    let faults: Vec<String> = bombs.iter().filter_map(|bomb| fault(bomb, &[4])).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The same in six sizes; some of the small ones are files that can be read.
#[test]
#[ignore = "200 files of up to 600 MB"]
fn bombs_of_every_size_stay_within_the_memory_that_may_be_used() {
    let sizes = [0.05, 0.1, 0.2, 0.4, 0.7, 2.0];
    let bombs: Vec<Bomb> = sizes.into_iter().flat_map(files::all).collect();
    assert!(bombs.len() >= 200, "{}", bombs.len());
    let faults: Vec<String> = bombs.iter().filter_map(|bomb| fault(bomb, &[0, 2, 3, 4])).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
