//! The program as a user starts it, and what it hits.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// `gonio` with these words in `folder`, not yet started.
pub fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    command.current_dir(folder).args(words);
    command
}

/// Runs `gonio` with these words in `folder`.
pub fn gonio(folder: &Path, words: &[&str]) -> Output {
    command(folder, words).output().expect("runs")
}

/// A folder with the campaign `small.toml` of this text.
pub fn folder(text: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("small.toml"), text).expect("campaign");
    folder
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

/// What a run that ended with this code said on stderr.
#[track_caller]
pub fn exits(output: &Output, code: i32) -> String {
    assert_eq!(output.status.code(), Some(code), "{}\n{}", stdout(output), stderr(output));
    stderr(output)
}

/// What a run that went well said on stdout.
#[track_caller]
pub fn done(output: &Output) -> String {
    exits(output, 0);
    stdout(output)
}

/// What a run said on stdout, and nothing else there.
#[track_caller]
pub fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {}", stdout(output)))
}
