//! A measurement as its user sees it: what it is told goes to stdout and stderr, and signals end it.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, OnceLock, PoisonError};

use super::numbers::{bytes, grouped};
use super::output::{Output, inform, note, warn};
use super::progress::{RunProgress, Stage};
use super::{measured, plan};
use crate::campaign::Campaign;
use crate::cli::process::ending;
use crate::cli::process::ending::Leaving;
use crate::error::{Error, Result};
use crate::job::{SweepPaths, Watcher, WrittenTable};
use crate::measure::{Cost, Disk, Plan, ProcessEnd};
use crate::validate::prediction::aperture::worst;

/// The function makes of a run's error what is said.
type Advised<'a> = &'a (dyn Fn(Error) -> Error + Sync);

/// Tells a user on a terminal.
pub struct Terminal<'a> {
    /// Whether stdout is for a JSON document alone.
    json: bool,
    out: Mutex<Output>,
    progress: OnceLock<RunProgress>,
    /// What is done where no bar is shown.
    stage: Mutex<Option<Stage>>,
    leaving: Leaving<Advised<'a>>,
}

impl<'a> Terminal<'a> {
    /// Everything on stdout, or nothing but what the caller prints as JSON.
    pub fn new(json: bool, advised: Advised<'a>) -> Self {
        Terminal {
            json,
            out: Mutex::default(),
            progress: OnceLock::new(),
            stage: Mutex::default(),
            leaving: Leaving(advised),
        }
    }

    /// stdout, for what follows.
    pub fn into_output(self) -> Output {
        self.out.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Shows a line of its own, or none.
    fn show(&self, stage: Option<Stage>) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage;
    }

    fn print(&self, print: impl FnOnce(&mut Output) -> Result<()>) -> Result<()> {
        self.show(None);
        if self.json { Ok(()) } else { print(&mut self.out.lock().unwrap_or_else(PoisonError::into_inner)) }
    }
}

impl Watcher for Terminal<'_> {
    fn warn(&self, text: &str) {
        warn(text);
    }

    fn note(&self, text: &str) {
        note(text);
    }

    fn finished(&self, file: &Path) -> Result<()> {
        let text = format!("{} is finished: nothing to do", file.display());
        if self.json {
            inform(&text);
        }
        self.print(|out| out.line(text))
    }

    fn resumes(&self, file: &Path, samples: u64, total: u64) {
        let percent = 100.0 * samples as f64 / total.max(1) as f64;
        self.note(&format!("resumes {}: {} samples, {percent:.1} %", file.display(), grouped(samples)));
    }

    fn little_room(&self, folder: &Path, disk: Disk, free: u64) {
        let [results, kept, free] = [disk.results_bytes, disk.until_then_bytes, free].map(bytes);
        let folder = folder.display();
        warn(format_args!(
            "{folder}: {free} are free, results may take {results} and what is kept until then {kept}"
        ));
    }

    fn begins(&self, campaign: &Campaign, planned: &Plan, disk: Disk) -> Result<()> {
        self.print(|out| {
            out.lines(plan::facts(campaign, planned, disk))?;
            out.lines(worst(campaign).iter().flat_map(plan::aperture))
        })
    }

    fn measuring(&self, before: u64, total: u64) {
        self.progress.get_or_init(|| RunProgress::after(before, total, "samples"));
    }

    fn samples(&self, more: u64) {
        self.progress.get().into_iter().for_each(|progress| progress.add(more));
    }

    fn stage(&self, text: &str) {
        match self.progress.get() {
            Some(progress) if !progress.is_finished() => progress.say(text),
            _ => self.show((!text.is_empty()).then(|| Stage::begin(text))),
        }
    }

    fn measured(&self) {
        self.progress.get().into_iter().for_each(RunProgress::finish);
        self.stage("adding up the realisations");
    }

    fn written(&self, table: &WrittenTable) -> Result<()> {
        table.verdict.failures.iter().for_each(warn);
        self.print(|out| measured::print(table, out))
    }

    fn swept(&self, files: &SweepPaths) -> Result<()> {
        self.print(|out| {
            out.line(format_args!("sweep         {}: a line a table and incidence", files.csv.display()))?;
            out.line(format_args!("              {}: the same", files.netcdf.display()))?;
            out.line(format_args!("              {}: joint plots", files.page.display()))
        })
    }

    fn cost(&self, cost: &Cost) -> Result<()> {
        self.print(|out| out.lines(measured::cost_lines(cost)))
    }

    fn interrupted(&self) -> Option<&AtomicBool> {
        Some(ending::asked())
    }

    fn process_end(&self) -> Option<&dyn ProcessEnd> {
        Some(&self.leaving)
    }
}
