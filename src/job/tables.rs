//! The tables of a run, band after band, into their files.

use std::ops::Range;

use super::paths::TablePaths;
use super::table_output::TableOutput;
use super::watcher::Watcher;
use crate::error::{Error, Result};
use crate::measure::{Cost, Disk, Measured, Plan};
use crate::report::html::specimen::ShownSpecimen;
use crate::table::realisations;

/// How the tables of a run are written.
pub struct TableWriting<'a> {
    /// What was measured.
    pub plan: &'a Plan,
    /// The tables that are written.
    pub open: &'a [&'a TablePaths],
    /// Bytes that may be used.
    pub memory: u64,
    /// Bytes that a file of realisations may take.
    pub realisations_limit: u64,
    /// Who is told.
    pub watcher: &'a dyn Watcher,
}

/// Refuses realisations that would not fit the memory: they are held three times while their file is made.
pub fn realisations_fit(disk: Disk, memory: u64) -> Result<()> {
    let needed = disk.realisations_bytes.saturating_mul(3);
    if disk.realisations_bytes <= realisations::SIZE_LIMIT || needed <= memory {
        return Ok(());
    }
    Err(Error::Refused(format!(
        "--keep-realisations: they take {} MiB of memory, {} MiB may be used; give --memory-mb more, or leave it out",
        needed >> 20,
        memory >> 20
    )))
}

impl TableWriting<'_> {
    /// Writes the open tables, each with its summary, data first. `band` gives the tables of some incidences, and what
    /// these have cost; `specimen` shows a patch under a table's campaign.
    pub fn write(
        &self,
        mut band: impl FnMut(Range<usize>) -> Result<(Vec<Measured>, Cost)>,
        specimen: impl Fn(&Measured) -> Result<ShownSpecimen>,
    ) -> Result<()> {
        let mut outputs: Vec<Option<TableOutput>> = self.open.iter().map(|_| None).collect();
        let mut cost = Cost::default();
        for incidences in self.plan.bands() {
            let (first, is_last) = (incidences.start, incidences.end == self.plan.incidences);
            let (results, next) = band(incidences)?;
            cost = cost.plus(next);
            for measured in results {
                // A table that was finished before may be among the results.
                let Some(at) = self.open.iter().position(|paths| paths.is_of(&measured.table)) else {
                    continue;
                };
                let mut output = match outputs[at].take() {
                    Some(output) => output,
                    None => TableOutput::new(self.open[at], &measured, self.plan, self.realisations_limit)?,
                };
                self.watcher.stage("comparing the table with the formula");
                output.take(measured, first)?;
                if is_last {
                    self.watcher.stage("writing table, page and summary");
                    self.watcher.written(&output.finish(self.memory, &cost, &specimen)?)?;
                } else {
                    outputs[at] = Some(output);
                }
            }
        }
        self.watcher.cost(&cost)
    }
}
