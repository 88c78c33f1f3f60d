//! Promise: a file that comes to an output's name while a command works stays as it is; what was measured is kept, and
//! `--resume` ends with the same bytes.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use gonio::campaign::{self, Campaign};
use gonio::error::{Error, Result};
use gonio::job::{Measurement, Watcher};
use gonio::measure::Part;

use crate::support::campaign_text::SMALL;
use crate::support::outputs::digests;

const FOREIGN: &str = "a year of work";

/// Puts a foreign file somewhere when the first samples are measured.
struct Latecomer {
    path: Mutex<Option<PathBuf>>,
}

impl Latecomer {
    fn to(path: PathBuf) -> Self {
        Latecomer { path: Mutex::new(Some(path)) }
    }
}

impl Watcher for Latecomer {
    fn samples(&self, _more: u64) {
        if let Some(path) = self.path.lock().expect("whole").take() {
            fs::write(path, FOREIGN).expect("written");
        }
    }
}

fn campaign() -> Campaign {
    campaign::parse(SMALL, "small.toml", Path::new("")).expect("a campaign").campaign
}

/// The run is refused because of the file at `path`, which stays.
fn is_refused(written: Result<()>, path: &Path) {
    let why = written.expect_err("refused");
    assert!(matches!(why, Error::Io { .. }), "{why}");
    let why = why.to_string();
    assert!(why.starts_with(&path.display().to_string()) && why.contains("has come or changed"), "{why}");
    assert_eq!(fs::read_to_string(path).expect("there"), FOREIGN);
}

#[test]
fn what_comes_to_a_tables_names_stays_and_the_run_is_resumed() {
    let whole = tempfile::tempdir().expect("folder");
    Measurement::new(campaign()).folder(whole.path()).write().expect("written");
    let names = digests(whole.path());
    assert_eq!(names.len(), 5);
    for (name, force) in names.keys().flat_map(|name| [(name, false), (name, true)]) {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join(name);
        let watcher = Latecomer::to(path.clone());
        let job = Measurement::new(campaign()).folder(folder.path()).force(force).watcher(&watcher);
        is_refused(job.write().map(drop), &path);
        // Nothing has taken its name beside it.
        let others: Vec<PathBuf> = names.keys().map(|name| folder.path().join(name)).collect();
        assert!(others.iter().all(|other| *other == path || !other.exists()), "{name}");
        fs::remove_file(&path).expect("moved away");
        let resumed = Measurement::new(campaign()).folder(folder.path()).resume(true).write();
        resumed.expect("written");
        assert_eq!(digests(folder.path()), names, "{name}");
    }
}

/// Of several runs the later ones look before the first begins.
#[test]
fn what_comes_between_the_look_and_the_run_stays() {
    let folder = tempfile::tempdir().expect("folder");
    let job = Measurement::new(campaign()).folder(folder.path()).force(true).look();
    let path = folder.path().join("small.json");
    fs::write(&path, FOREIGN).expect("written");
    is_refused(job.write().map(drop), &path);
}

#[test]
fn what_comes_to_a_shards_name_stays() {
    let folder = tempfile::tempdir().expect("folder");
    let shard: Part = "1/2".parse().expect("a shard");
    let path = folder.path().join(shard.file_name("small"));
    let watcher = Latecomer::to(path.clone());
    let job = Measurement::new(campaign()).folder(folder.path()).shard(Some(shard)).watcher(&watcher);
    is_refused(job.write().map(drop), &path);
}
