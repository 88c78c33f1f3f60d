//! The program under a C library whose calls fail: `tests/data/failing_calls.c`, compiled and preloaded.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use rustix::process::Signal;
use tempfile::TempDir;

/// The compiled source, made once; where Rust can link, there is a C compiler.
pub fn preloaded() -> &'static Failing {
    static BUILT: OnceLock<Failing> = OnceLock::new();
    BUILT.get_or_init(|| Failing::built().expect("a C compiler"))
}

/// The compiled source.
pub struct Failing {
    folder: TempDir,
}

impl Failing {
    /// Compiles it; where no C compiler is there, says so.
    pub fn built() -> Option<Self> {
        let folder = tempfile::tempdir().expect("temporary folder");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/failing_calls.c");
        let built = Command::new("cc")
            .args(["-O1", "-shared", "-fPIC", "-o"])
            .arg(folder.path().join("failing.so"))
            .arg(source)
            .arg("-ldl")
            .output();
        match built {
            Ok(output) => {
                assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
                Some(Failing { folder })
            }
            Err(why) => {
                println!("skipped: no C compiler is here ({why})");
                None
            }
        }
    }

    fn preloaded(&self, mut command: Command, below: &Path) -> Command {
        let below = fs::canonicalize(below).expect("there");
        command.env("LD_PRELOAD", self.folder.path().join("failing.so")).env("FAILING_BELOW", below);
        command.env("FAILING_LOG", self.log());
        command
    }

    fn log(&self) -> PathBuf {
        self.folder.path().join("log")
    }

    /// Runs `command`, whose calls on files below a folder fail from the first to the last of these numbers; and which
    /// calls those were.
    pub fn run(&self, command: Command, below: &Path, (first, last): (u64, u64)) -> (Output, Vec<String>) {
        fs::remove_file(self.log()).ok();
        let mut command = self.preloaded(command, below);
        command.env("FAILING_FIRST", first.to_string()).env("FAILING_LAST", last.to_string());
        let output = command.output().expect("runs");
        (output, self.failed())
    }

    /// Every call on files below a folder that `command` makes where none fails.
    pub fn calls(&self, command: Command, below: &Path) -> Vec<String> {
        fs::remove_file(self.log()).ok();
        let output = self.preloaded(command, below).env("FAILING_LISTS", "1").output().expect("runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        self.failed()
    }

    /// `command`, whose `fsync` of files below a folder waits while the file `flag` is there.
    pub fn waiting_while(&self, command: Command, below: &Path, flag: &Path) -> Command {
        let mut command = self.preloaded(command, below);
        command.env("FAILING_WAITS", flag);
        command
    }

    /// `command`, which sends itself a signal after the call of this number.
    pub fn signalled(&self, command: Command, below: &Path, signal: i32, call: u64) -> Command {
        let mut command = self.preloaded(command, below);
        command.env("FAILING_SIGNAL", signal.to_string()).env("FAILING_FIRST", call.to_string());
        command
    }

    /// Runs `command` until so many files below a folder whose names have `part` in them have been put in their places,
    /// and then ends it by a signal: between two calls to the system, whatever the machine does besides.
    pub fn ended(&self, command: Command, below: &Path, signal: Signal, part: &str, times: u64) -> Output {
        let mut command = self.signalled(command, below, signal.as_raw(), times);
        command.env("FAILING_CALL", "rename").env("FAILING_NAME", part);
        command.output().expect("runs")
    }

    /// Calls that failed or wait since the last run began.
    pub fn failed(&self) -> Vec<String> {
        let text = fs::read_to_string(self.log()).unwrap_or_default();
        text.lines().map(str::to_string).collect()
    }
}
