//! Tests that look at their whole process, such as its memory.

use std::env;
use std::process::Command;

/// Set in a process that runs one test alone.
const ALONE: &str = "GONIO_TEST_ALONE";

/// What the test `name` of a module (`module_path!()`) is called on a command line.
pub fn path_of(module: &str, name: &str) -> String {
    let (_, module) = module.split_once("::").expect("a module of a test program");
    format!("{module}::{name}")
}

/// Does `work`, which is all of a test, in a process of its own.
pub fn alone(module: &str, name: &str, work: impl FnOnce()) {
    if env::var_os(ALONE).is_some() {
        return work();
    }
    let mut command = Command::new(env::current_exe().expect("this program"));
    command.args(["--exact", &path_of(module, name), "--nocapture"]).env(ALONE, "1");
    let output = command.output().expect("runs");
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    assert!(output.status.success() && said.contains("1 passed"), "{said}");
}
