//! `gonio measure` of a table that does not fit the memory: bands of stops are measured, examined and written one after
//! the other. Table, realisations, card and figures are those of a run that had the memory.

use super::output::{self, Output, json_text, warn};
use super::progress::Progress;
use super::report::{Sources, page_of};
use super::results::{cost_lines, files_written, lobes, report};
use super::{optics_text, targets::Target};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::files::{self, NewFile};
use crate::measure::{self, Cost, Measured, Patches, Plan, StopResult};
use crate::report::summary::summary;
use crate::report::{self as pages, Facts, specimen};
use crate::table::realisations::{self, GROUPS, Kept, SIZE_LIMIT};
use crate::table::{Realisations, TableRows, TableWriter};
use crate::validate::schlick_error::SchlickError;
use crate::validate::{Examination, Parts, Prediction};

/// A run in bands.
pub struct Banded<'a> {
    pub campaign: &'a Campaign,
    pub plan: &'a Plan,
    pub open: &'a [&'a Target],
    pub json: bool,
    /// Bytes that it may use.
    pub memory: u64,
}

impl Banded<'_> {
    /// Measures band by band, then completes every table's files.
    pub fn run(&self, patches: Patches, progress: &Progress, out: &mut Output) -> Result<()> {
        let patches = patches.for_bands(self.campaign, self.memory)?;
        let mut sheets: Vec<Option<Sheet>> = self.open.iter().map(|_| None).collect();
        let mut cost: Option<Cost> = None;
        for stops in self.plan.bands() {
            let first_stop = stops.start;
            let plan = self.plan.of_stops(&stops.collect::<Vec<_>>()).ok_or_else(no_bands)?;
            let (results, next) =
                measure::measure(self.campaign, &plan, &patches, &|starts| progress.add(starts))?;
            cost = Some(match cost {
                Some(before) => before.plus(next),
                None => next,
            });
            for measured in results {
                let Some(at) = self.open.iter().position(|target| target.is_of(&measured.table)) else {
                    // A table that was finished before may be among the results.
                    continue;
                };
                if sheets[at].is_none() {
                    sheets[at] = Some(Sheet::new(self.open[at], &measured, self.plan)?);
                }
                if let Some(sheet) = &mut sheets[at] {
                    sheet.take(measured, first_stop)?;
                }
            }
        }
        progress.finish();
        let cost = cost.ok_or_else(no_bands)?;
        for (sheet, target) in sheets.into_iter().zip(self.open) {
            sheet.ok_or_else(no_bands)?.finish(self, target, &cost, &patches, out)?;
        }
        if self.json { Ok(()) } else { out.lines(cost_lines(&cost)) }
    }
}

fn no_bands() -> Error {
    Error::Internal("a table without bands of stops".into())
}

/// A table under way.
struct Sheet {
    writer: TableWriter<NewFile>,
    examination: Examination,
    facts: Facts,
    schlick: Option<SchlickError>,
    kept: Kept,
    /// The table without its values, the stops' results, and the realisations that are to be kept.
    measured: Measured,
}

impl Sheet {
    fn new(target: &Target, first: &Measured, plan: &Plan) -> Result<Self> {
        let Measured { table, campaign, .. } = first;
        let count = first.realisations.parts.len();
        Ok(Sheet {
            writer: TableWriter::create(&target.table, table, &plan.grid)?,
            examination: Examination::new(Some(campaign), &plan.grid),
            facts: Facts::new(&plan.grid, table.colours.len()),
            schlick: None,
            kept: realisations::kept(&plan.grid, realisations::channels_of(table), count, SIZE_LIMIT),
            measured: Measured {
                campaign: campaign.clone(),
                table: table.heading(&plan.grid),
                realisations: Realisations::default(),
                stops: Vec::new(),
            },
        })
    }

    /// Takes the next band.
    fn take(&mut self, band: Measured, first_stop: usize) -> Result<()> {
        let Measured { table, campaign, realisations, stops } = band;
        self.writer.append(&table)?;
        let prediction = Prediction::of(&campaign, &table.grid);
        let parts = Parts { all: &realisations, first_stop: 0 };
        self.examination.add(&table, first_stop, Some(parts), prediction.as_ref());
        self.facts.add(&table, first_stop);
        if let Some(next) = SchlickError::of(&campaign, &table) {
            match &mut self.schlick {
                Some(before) => before.join(next),
                None => self.schlick = Some(next),
            }
        }
        self.measured.stops.extend::<Vec<StopResult>>(stops);
        match self.kept {
            Kept::All => self.measured.realisations.append(realisations),
            Kept::Groups => {
                self.measured.realisations.append(realisations::grouped(&realisations, GROUPS)?);
            }
            Kept::Nothing => {}
        }
        Ok(())
    }

    /// Puts the files in their places, data first, the summary last.
    fn finish(
        self,
        job: &Banded,
        target: &Target,
        cost: &Cost,
        patches: &Patches,
        out: &mut Output,
    ) -> Result<()> {
        let Sheet { writer, examination, facts, schlick, kept, measured } = self;
        let verdict = examination.verdict();
        let mut document = summary(&measured, job.plan, cost, &verdict);
        document["fresnel"] = output::to_json(&schlick)?;
        // Without its summary a table counts as unfinished, whatever happens from here on.
        files::remove(&target.summary)?;
        let (file, digest) = writer.finish()?;
        file.commit()?;
        write_realisations(&measured, target, &digest, (kept, job.plan))?;
        let (table, stops) = pages::thinned(&mut TableRows::open(&target.table)?, job.memory)?;
        let prediction = Prediction::of(&measured.campaign, &table.grid);
        let specimen = specimen::of_patches(patches, &measured.campaign)?;
        let (campaign, predicted) = (Some(&measured.campaign), prediction.as_ref());
        let sources = Sources { table: &table, campaign, prediction: predicted, specimen };
        let page = page_of(sources, &pages::thinned_summary(&document, &stops), None);
        files::write_atomically(&target.page, page.as_bytes())?;
        let card = pages::card_of(&measured.table, &digest, facts, &document);
        files::write_atomically(&target.card, card.as_bytes())?;
        files::write_atomically(&target.summary, format!("{}\n", json_text(&document)?).as_bytes())?;
        verdict.failures.iter().for_each(warn);
        if job.json {
            return Ok(());
        }
        report(out, &measured, job.plan, &verdict)?;
        out.lines(schlick.iter().flat_map(optics_text::schlick_lines))?;
        let shown = Measured { table, stops: Vec::new(), realisations: Realisations::default(), ..measured };
        out.lines(lobes(&shown, prediction.as_ref()))?;
        out.lines(files_written(target, kept))
    }
}

fn write_realisations(
    measured: &Measured,
    target: &Target,
    digest: &str,
    (kept, plan): (Kept, &Plan),
) -> Result<()> {
    let group_size = match kept {
        Kept::All => 1,
        Kept::Groups => plan.realisations as usize / GROUPS,
        Kept::Nothing => return files::remove(&target.realisations),
    };
    // Names and axes are those of the table; its values are not needed.
    let bytes = realisations::encode_of(&measured.realisations, &measured.table, digest, group_size)?;
    files::write_atomically(&target.realisations, &bytes)
}
