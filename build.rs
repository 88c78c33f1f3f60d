//! Hands the compiler, the target and, of release builds, the commit to `gonio --version -v`.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let compiler = env::var("RUSTC").ok().and_then(|rustc| first_line(&rustc, &["--version"]));
    println!("cargo:rustc-env=GONIO_COMPILER={}", compiler.unwrap_or("not known".into()));
    println!("cargo:rustc-env=GONIO_TARGET={}", env::var("TARGET").unwrap_or_default());
    // A build for development would be made anew at every commit.
    if env::var("PROFILE").is_ok_and(|profile| profile == "release") {
        if let Some(log) = first_line("git", &["rev-parse", "--git-path", "logs/HEAD"]) {
            println!("cargo:rerun-if-changed={log}");
        }
        if let Some(commit) = first_line("git", &["rev-parse", "--short=12", "HEAD"]) {
            println!("cargo:rustc-env=GONIO_COMMIT={commit}");
        }
    }
}

/// The first line that a program prints, if it can be run.
fn first_line(program: &str, words: &[&str]) -> Option<String> {
    let done = Command::new(program).args(words).output().ok().filter(|done| done.status.success())?;
    String::from_utf8(done.stdout).ok()?.lines().next().map(str::to_string)
}
