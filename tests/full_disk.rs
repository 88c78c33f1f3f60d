//! Promise: a disk that is full for a while costs checkpoints, not the run.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use gonio::measure::Checkpoint;

#[path = "common/failing.rs"]
mod failing;
#[path = "common/outputs.rs"]
mod outputs;
use failing::Failing;

/// Long enough for several checkpoints, which are written once a second at most.
const CAMPAIGN: &str = "\
name = \"small\"
seed = 5
[surface]
realisations = 3
cells = 64
correlation_cells = 4.0
[surface.ggx]
alpha = [0.3, 0.5]
[light]
theta_i_deg = [0, 50]
[sensor.hemisphere]
theta_r_bins = 6
phi_r_bins = 12
[trace]
bounces = 2
[stop]
samples = 3_000_000
";

fn measure(folder: &Path, output: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    command.current_dir(folder).args(["measure", "small.toml", "-o", output]);
    command
}

/// Waits until it is so, while the run goes on.
fn until(child: &mut Child, what: &str, is_so: impl Fn() -> bool) {
    while !is_so() {
        assert!(child.try_wait().expect("ours").is_none(), "ended before: {what}");
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_run_whose_disk_is_full_for_a_while_goes_on_and_is_kept_again() {
    let Some(failing) = Failing::built() else { return };
    let folder = tempfile::tempdir().expect("temporary folder");
    let (here, out) = (folder.path(), folder.path().join("out"));
    fs::write(here.join("small.toml"), CAMPAIGN).expect("campaign");
    fs::create_dir(&out).expect("folder");
    let flag = here.join("full");
    let mut command = failing.while_there(measure(here, "out"), &out, &flag);
    // One thread: the run outlasts a few checkpoints on any machine.
    command.args(["--threads", "1"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("starts");
    let checkpoint = Checkpoint::of(&out, "small");
    let number = || checkpoint.load().expect("whole").map_or(0, |found| found.kept.heading.number);
    until(&mut child, "a first checkpoint", || number() > 0);
    fs::write(&flag, "").expect("full from now on");
    until(&mut child, "a checkpoint that fails", || !failing.failed().is_empty());
    let before = number();
    assert!(before > 0, "the one before stays whole");
    fs::remove_file(&flag).expect("room again");
    until(&mut child, "a later checkpoint", || number() > before);
    let output = child.wait_with_output().expect("ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    let warnings: Vec<&str> = said.lines().filter(|line| line.starts_with("warning: ")).collect();
    let [warning] = warnings[..] else { panic!("one warning: {said}") };
    assert!(
        warning.contains("no checkpoint could be written, the run goes on: out/small.checkpoint_"),
        "{said}"
    );
    assert!(warning.contains("No space left on device"), "{said}");
    assert!(failing.failed().iter().all(|call| call.contains("small.checkpoint_")), "{:?}", failing.failed());
    assert_eq!(measure(here, "undisturbed").output().expect("runs").status.code(), Some(0));
    assert_eq!(outputs::digests(&out), outputs::digests(&here.join("undisturbed")));
}
