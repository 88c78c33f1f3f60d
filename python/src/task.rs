//! Work on a thread of its own, which Python waits for in short steps: so that its signals and its other threads are
//! served meanwhile.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use gonio::budget;
use gonio::cli;
use gonio::error::{Error, Result};
use gonio::job::{Measurement, TablePaths, Watcher, Written, WrittenTable};
use gonio::measure::Disk;
use pyo3::prelude::*;
use serde::Serialize;

use crate::campaign::Source;
use crate::failure::raised;

/// What the thread and Python share.
#[derive(Default)]
struct Shared {
    stop: AtomicBool,
    done: AtomicU64,
    total: AtomicU64,
    said: Mutex<Vec<String>>,
    outcome: Mutex<Option<Result<String>>>,
    finished: Condvar,
}

fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    fn say(&self, text: String) {
        locked(&self.said).push(text);
    }

    fn finish(&self, outcome: Result<String>) {
        *locked(&self.outcome) = Some(outcome);
        self.finished.notify_all();
    }
}

impl Watcher for Shared {
    fn warn(&self, text: &str) {
        self.say(format!("warning: {text}"));
    }

    fn note(&self, text: &str) {
        self.say(format!("note: {text}"));
    }

    fn resumes(&self, file: &Path, samples: u64, total: u64) {
        self.note(&format!("resumes {}: {samples} of {total} samples", file.display()));
    }

    fn little_room(&self, folder: &Path, disk: Disk, free: u64) {
        let (folder, needed) = (folder.display(), disk.bytes());
        self.warn(&format!("{folder}: {free} bytes are free, the run may take {needed}"));
    }

    fn measuring(&self, before: u64, total: u64) {
        self.done.store(before, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
    }

    fn samples(&self, more: u64) {
        self.done.fetch_add(more, Ordering::Relaxed);
    }

    fn written(&self, table: &WrittenTable) -> Result<()> {
        table.verdict.failures.iter().for_each(|failure| self.warn(failure));
        Ok(())
    }

    fn interrupted(&self) -> Option<&AtomicBool> {
        Some(&self.stop)
    }
}

/// How a campaign is measured.
#[derive(FromPyObject)]
struct Options {
    #[pyo3(item)]
    output: Option<PathBuf>,
    #[pyo3(item)]
    threads: usize,
    #[pyo3(item)]
    memory_mb: Option<u64>,
    #[pyo3(item)]
    resume: bool,
    #[pyo3(item)]
    force: bool,
    #[pyo3(item)]
    keep_realisations: bool,
    /// Whether more than one table is expected.
    #[pyo3(item)]
    several: bool,
}

/// Work under way.
#[pyclass(frozen)]
pub struct Task(Arc<Shared>);

#[pymethods]
impl Task {
    /// Begins to measure a campaign; the result is a JSON list of the tables' files.
    #[staticmethod]
    fn measure(py: Python<'_>, source: Source, options: Options) -> PyResult<Task> {
        begin(py, move |shared| measured(&source, &options, shared))
    }

    /// Begins a command; the result is what it prints. One that disagrees has an answer like others.
    #[staticmethod]
    fn command(py: Python<'_>, words: Vec<PathBuf>) -> PyResult<Task> {
        begin(py, move |shared| {
            let (ended, printed) = cli::answer(words.into_iter().map(PathBuf::into_os_string));
            printed.said.into_iter().for_each(|line| shared.say(line));
            match ended {
                Err(Error::Disagreement(_)) if !printed.out.is_empty() => Ok(printed.out),
                ended => ended.map(|_| printed.out),
            }
        })
    }

    /// Begins an uncertainty budget; the result is its JSON.
    #[staticmethod]
    fn budget(py: Python<'_>, source: Source) -> PyResult<Task> {
        begin(py, move |shared| {
            let parsed = source.read()?;
            parsed.notes.iter().for_each(|note| shared.warn(note));
            let uncertainty = parsed.required_uncertainty(&source.name())?;
            let found = budget::budget(&parsed.campaign, uncertainty, &|_| ())?;
            found.notes.iter().for_each(|note| shared.warn(note));
            json(&found)
        })
    }

    /// Waits for so many seconds at most: whether the work is over.
    fn wait(&self, py: Python<'_>, seconds: f64) -> bool {
        let time = Duration::try_from_secs_f64(seconds).unwrap_or_default();
        py.detach(|| {
            let outcome = locked(&self.0.outcome);
            let waited = self.0.finished.wait_timeout_while(outcome, time, |outcome| outcome.is_none());
            waited.unwrap_or_else(PoisonError::into_inner).0.is_some()
        })
    }

    /// Samples that are measured, and all of them; 0 of 0 before it begins.
    fn progress(&self) -> (u64, u64) {
        (self.0.done.load(Ordering::Relaxed), self.0.total.load(Ordering::Relaxed))
    }

    /// What was said since the last time: lines that begin with `warning:` or `note:`.
    fn said(&self) -> Vec<String> {
        std::mem::take(&mut *locked(&self.0.said))
    }

    /// Asks a measurement to end.
    fn stop(&self) {
        self.0.stop.store(true, Ordering::Relaxed);
    }

    /// The result of work that is over, once.
    fn result(&self, py: Python<'_>) -> PyResult<String> {
        let unfinished = || Err(Error::Internal("no result".into()));
        let outcome = locked(&self.0.outcome).take();
        raised(py, outcome.unwrap_or_else(unfinished))
    }
}

fn json(answer: &impl Serialize) -> Result<String> {
    serde_json::to_string(answer).map_err(|e| Error::Internal(format!("printing JSON: {e}")))
}

fn begin(py: Python<'_>, work: impl FnOnce(&Shared) -> Result<String> + Send + 'static) -> PyResult<Task> {
    let shared = Arc::new(Shared::default());
    let theirs = Arc::clone(&shared);
    let run = move || theirs.finish(cli::guarded(|| work(&theirs)));
    let started = thread::Builder::new().name("gonio".into()).spawn(run);
    raised(py, started.map_err(|e| Error::Refused(format!("a thread cannot be started: {e}"))))?;
    Ok(Task(shared))
}

fn measured(source: &Source, options: &Options, shared: &Shared) -> Result<String> {
    let parsed = source.read()?;
    parsed.notes.iter().for_each(|note| shared.warn(note));
    let tables = TablePaths::of(&parsed.campaign, Path::new("")).len();
    if tables > 1 && !options.several {
        let name = &parsed.campaign.name;
        return Err(Error::Usage(format!(
            "{name}: {tables} tables, one for each roughness, material or side; measure_all measures them"
        )));
    }
    let mut job = Measurement::new(parsed.campaign)
        .threads(options.threads)
        .keep_realisations(options.keep_realisations)
        .resume(options.resume)
        .force(options.force)
        .watcher(shared);
    if let Some(path) = &source.path {
        job = job.source(path);
    }
    if let Some(folder) = &options.output {
        job = job.folder(folder);
    }
    if let Some(mb) = options.memory_mb {
        job = job.memory(mb.saturating_mul(1 << 20));
    }
    match job.write()? {
        Written::Tables(all) => {
            let paths: Vec<&Path> = all.iter().map(|paths| &*paths.table).collect();
            json(&paths)
        }
        Written::Shard { .. } => Err(Error::Internal("a shard was measured".into())),
    }
}
