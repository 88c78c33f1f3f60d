//! Promise: no file makes the program take more memory than it says it may: sizes are judged before room is made for them.
//!
//! The program runs under `ulimit -v` of 2 GB, so that it may use at most half of that by its own rule; what it answers is
//! one line with exit code 3 or 4 (2 of a campaign), and what it takes stays below the limit itself, measured as VmHWM. Linux only.
//! Every change is tried with a quarter of that memory and of the files; with GONIO_LONG=1 all of both.
#![cfg(target_os = "linux")]

#[path = "bombs/files.rs"]
mod files;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use files::Bomb;

use crate::support::long::or_long;

/// Address space, KiB; the program uses at most half of what is left of it.
const SPACE_KIB: u64 = 2_000_000;
/// What part of it is given by default.
const PART: f64 = 0.25;

/// How a run ended.
struct Ended {
    code: Option<i32>,
    said: String,
    /// Largest resident memory that was seen, KiB.
    peak_kib: u64,
}

/// Runs the program in `folder` with its address space limited to so many KiB.
fn run(folder: &Path, arguments: &[&str], space_kib: u64) -> Ended {
    let mut child = Command::new("sh")
        .args(["-c", &format!("ulimit -v {space_kib}; exec \"$0\" \"$@\""), env!("CARGO_BIN_EXE_gonio")])
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

/// What is wrong with the answer to a bomb in so many KiB of address space, if anything.
fn fault(bomb: &Bomb, codes: &[i32], space_kib: u64) -> Option<String> {
    let folder = tempfile::tempdir().expect("temporary folder");
    (bomb.write)(folder.path());
    let arguments: Vec<&str> = bomb.arguments.split(' ').collect();
    let Ended { code, said, peak_kib } = run(folder.path(), &arguments, space_kib);
    println!("{:28} {code:?} {:5} MiB  {}", bomb.name, peak_kib >> 10, said.trim());
    let lines: Vec<&str> =
        said.lines().filter(|line| !line.starts_with("note:") && !line.starts_with("warning:")).collect();
    // A campaign has a line for each of its faults.
    let one_line = lines.len() == 1 || code == Some(0) || code == Some(2);
    let refused = code.is_some_and(|code| codes.contains(&code)) && one_line;
    let wrong = !refused || peak_kib > space_kib / 2 || said.contains("panic") || said.len() > 2000;
    wrong.then(|| format!("{}: {code:?}, {} MiB: {said}", bomb.name, peak_kib >> 10))
}

/// As large as ever: the number of gaps or values is a limit of its own, and a shorter image is refused for its length.
const WHOLE: [&str; 6] = ["csv gaps", "toml values", "exr wide", "exr table", "exr maps", "map exr"];

/// All bombs in the sizes that are tried, and the address space.
fn sized() -> (Vec<Bomb>, u64) {
    let part = or_long(PART, 1.0);
    let both = files::all(part).into_iter().zip(files::all(1.0));
    let bombs = both.map(|(small, large)| if WHOLE.contains(&&*small.name) { large } else { small });
    (bombs.collect(), (part * SPACE_KIB as f64) as u64)
}

#[test]
fn bombs_are_refused_in_one_line_within_the_memory_that_may_be_used() {
    let (bombs, space_kib) = sized();
    assert!(bombs.len() >= 20);
    let faults: Vec<String> = bombs.iter().filter_map(|bomb| fault(bomb, &[2, 3, 4], space_kib)).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Nothing is wrong with such a file: another machine may read it.
#[test]
fn what_would_take_too_much_memory_is_refused_for_that() {
    let names = ["csv gaps of colours", "rgl lights", "exr table", "exr maps", "map exr"];
    let (all, space_kib) = sized();
    let bombs: Vec<Bomb> = all.into_iter().filter(|bomb| names.contains(&&*bomb.name)).collect();
    assert_eq!(bombs.len(), names.len());
    let faults: Vec<String> = bombs.iter().filter_map(|bomb| fault(bomb, &[4], space_kib)).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The same in six sizes; some of the small ones are files that can be read.
#[test]
#[ignore = "200 files of up to 600 MB"]
fn bombs_of_every_size_stay_within_the_memory_that_may_be_used() {
    let sizes = [0.05, 0.1, 0.2, 0.4, 0.7, 2.0];
    let bombs: Vec<Bomb> = sizes.into_iter().flat_map(files::all).collect();
    assert!(bombs.len() >= 200, "{}", bombs.len());
    let faults: Vec<String> = bombs.iter().filter_map(|bomb| fault(bomb, &[0, 2, 3, 4], SPACE_KIB)).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
