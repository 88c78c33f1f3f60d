//! Promise: shards that run in containers of their own and are killed at any moment share one folder without harm: each
//! sees only its own processes, and takes nobody's file under way for what a dead process left.

#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use crate::support::outputs;
use crate::support::program::{exits, gonio};

const CAMPAIGN: &str = "name = \"small\"\nseed = 7\n[surface]\ncells = 64\nrealisations = 4\n[surface.ggx]\nalpha = 0.3\n\
    [light]\ntheta_i_deg = [0, 10, 20, 30, 40, 50, 60, 70]\n[sensor.hemisphere]\ntheta_r_bins = 9\nphi_r_bins = 12\n\
    [stop]\nsamples = 65_536\n";
const SHARDS: usize = 8;

/// Runs the program with processes, mounts and network of its own, where that is allowed.
fn contained(folder: &Path, words: &[String]) -> Command {
    let mut command = Command::new("unshare");
    command
        .args(["--pid", "--fork", "--kill-child", "--mount-proc", "--net"])
        .arg(env!("CARGO_BIN_EXE_gonio"));
    command.current_dir(folder).args(words).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn words(text: &str) -> Vec<String> {
    text.split(' ').map(String::from).collect()
}

fn finished(folder: &Path, shard: usize) -> bool {
    folder.join(format!("shards/small.shard_{shard}_of_{SHARDS}")).exists()
}

/// Starts shards two at a time, kills some at moments that a small generator draws, and goes on until all are whole.
fn harassed(kills: usize) {
    let folder = tempfile::tempdir().expect("folder");
    let here = folder.path();
    fs::write(here.join("small.toml"), CAMPAIGN).expect("written");
    if !contained(here, &words("--version")).status().is_ok_and(|status| status.success()) {
        println!("skipped: no namespaces can be made here");
        return;
    }
    let done = |text: &str| {
        exits(&gonio(here, &text.split(' ').collect::<Vec<_>>()), 0);
    };
    done("measure small.toml -o whole");
    let (mut state, mut killed, mut started) = (1u64, 0, 0);
    let mut draw = |below: u64| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) % below
    };
    while !(1..=SHARDS).all(|shard| finished(here, shard)) || killed < kills {
        let start = |shard: &usize| -> Child {
            let text = format!("measure small.toml -o shards --threads 1 --resume --shard {shard}/{SHARDS}");
            contained(here, &words(&text)).spawn().expect("starts")
        };
        let mut pair = [1 + draw(SHARDS as u64) as usize; 2];
        pair[1] = 1 + (pair[0] + draw(SHARDS as u64 - 1) as usize) % SHARDS;
        if killed < kills {
            // What is finished would have nothing left to be killed at.
            pair.iter().for_each(|shard| {
                fs::remove_file(here.join(format!("shards/small.shard_{shard}_of_{SHARDS}"))).ok();
            });
        }
        let mut children: Vec<Child> = pair.iter().map(start).collect();
        started += children.len();
        if killed < kills {
            thread::sleep(Duration::from_millis(draw(400)));
            children[0].kill().expect("a process");
            killed += 1;
        }
        for (index, child) in children.into_iter().enumerate() {
            let output = child.wait_with_output().expect("ends");
            let was_killed = index == 0 && output.status.code().is_none();
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            // The killed one's lock may be held until its container has gone.
            let waits = said.contains("is writing this output");
            assert!(was_killed || output.status.success() || waits, "{pair:?}: {said}");
        }
    }
    println!("{started} starts, {killed} kills");
    done("merge shards -o merged");
    let tables = |folder: &str| {
        let mut all = outputs::digests(&here.join(folder));
        all.retain(|name, _| name.ends_with(".exr"));
        all
    };
    assert_eq!(tables("merged"), tables("whole"));
    // What the killed ones left went with the next start.
    let left = fs::read_dir(here.join("shards")).expect("readable");
    let names = left.map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned());
    let strange: Vec<String> = names.filter(|name| name.starts_with(".gonio-")).collect();
    assert_eq!(strange, Vec::<String>::new());
}

#[test]
fn shards_in_containers_share_a_folder() {
    harassed(6);
}

#[test]
#[ignore = "takes minutes: cargo test --test process two_hosts -- --ignored"]
fn shards_in_containers_survive_fifty_kills() {
    harassed(50);
}
