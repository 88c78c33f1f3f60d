//! A table from its first band of stops to its files in their places: taken band by band, or all at once.

use super::report::{Sources, page_of};
use super::results::{Results, files_written, lobes, report};
use super::targets::TablePaths;
use super::text::optics;
use super::text::output::{Output, json_text, warn};
use crate::error::Result;
use crate::files::{self, NewFile};
use crate::measure::{Cost, Measured, Plan};
use crate::report::html::specimen::ShownSpecimen;
use crate::report::{self as pages, Facts, Summary};
use crate::table::realisations::{self, GROUPS, StoredRealisations};
use crate::table::{BrdfTable, Realisations, TableRows, TableWriter};
use crate::validate::prediction::schlick_error::SchlickError;
use crate::validate::{Examination, Parts, Prediction, Verdict};

/// A table under way.
pub struct TableOutput<'a> {
    target: &'a TablePaths,
    plan: &'a Plan,
    writer: TableWriter<NewFile>,
    examination: Examination,
    facts: Facts,
    schlick: Option<SchlickError>,
    kept: StoredRealisations,
    /// The table without its values, the stops' results, and the realisations that are to be kept.
    measured: Measured,
    /// The table and what theory says of it, where one band is all of it.
    whole: Option<(BrdfTable, Option<Prediction>)>,
}

impl<'a> TableOutput<'a> {
    /// Begins the files of `target` with a first band of it, not taken yet; realisations may take `limit` bytes.
    pub fn new(target: &'a TablePaths, first: &Measured, plan: &'a Plan, limit: u64) -> Result<Self> {
        let Measured { table, campaign, .. } = first;
        let count = first.realisations.parts.len();
        Ok(TableOutput {
            target,
            plan,
            writer: TableWriter::create(&target.table, table, &plan.grid)?,
            examination: Examination::new(Some(campaign), &plan.grid),
            facts: Facts::new(&plan.grid, table.colours.len()),
            schlick: None,
            kept: realisations::kept(&plan.grid, realisations::channels_of(table), count, limit),
            measured: Measured {
                campaign: campaign.clone(),
                table: table.header(&plan.grid),
                realisations: Realisations::default(),
                stops: Vec::new(),
            },
            whole: None,
        })
    }

    /// Takes the next band, which begins at `first_stop`.
    pub fn take(&mut self, band: Measured, first_stop: usize) -> Result<()> {
        let Measured { table, campaign, realisations, stops } = band;
        self.writer.append(&table)?;
        let prediction = Prediction::of(&campaign, &table.grid);
        // The verdict is one that `validate` finds again in the files.
        let realisations = match self.kept {
            StoredRealisations::Groups => realisations::grouped(&realisations, GROUPS)?,
            StoredRealisations::All | StoredRealisations::Nothing => realisations,
        };
        let parts = Parts { all: &realisations, first_stop: 0 };
        self.examination.add(&table, first_stop, Some(parts), prediction.as_ref());
        self.facts.add(&table, first_stop);
        if let Some(next) = SchlickError::of(&campaign, &table) {
            match &mut self.schlick {
                Some(before) => before.join(next),
                None => self.schlick = Some(next),
            }
        }
        self.measured.stops.extend(stops);
        match self.kept {
            StoredRealisations::All | StoredRealisations::Groups => {
                self.measured.realisations.append(realisations)
            }
            StoredRealisations::Nothing => {}
        }
        if table.grid.stops() == self.plan.stops {
            self.whole = Some((table, prediction));
        }
        Ok(())
    }

    /// Puts the files in their places, and prints what they show. `specimen` is the first patch under this campaign.
    pub fn finish(
        self,
        job: &Results,
        cost: &Cost,
        specimen: impl Fn(&Measured) -> Result<ShownSpecimen>,
        out: &mut Output,
    ) -> Result<()> {
        let TableOutput { target, plan, writer, examination, facts, schlick, kept, measured, whole } = self;
        let verdict = examination.verdict();
        let (file, digest) = writer.finish()?;
        let summary = Summary::measured(&measured, (plan, cost), &verdict, schlick.clone(), digest.clone())?;
        let file = file.on_disk()?;
        let shown = match whole {
            Some((table, prediction)) => ShownTable { table, prediction, summary: summary.clone() },
            None => ShownTable::of_rows(&file, &measured, summary.clone(), job.memory)?,
        };
        let ShownTable { table, prediction, .. } = &shown;
        let specimen = specimen(&measured)?;
        let (campaign, predicted) = (Some(&measured.campaign), prediction.as_ref());
        let page =
            page_of(Sources { table, campaign, prediction: predicted, specimen }, &shown.summary, None);
        let staged = Staged {
            table: file,
            realisations: staged_realisations(&measured, target, &digest, (kept, plan))?,
            others: [
                NewFile::with(&target.page, page.as_bytes())?,
                NewFile::with(
                    &target.card,
                    pages::card(&measured.table, &digest, facts, &summary).as_bytes(),
                )?,
                NewFile::with(&target.summary, format!("{}\n", json_text(&summary)?).as_bytes())?,
            ],
        };
        staged.commit(target)?;
        verdict.failures.iter().for_each(warn);
        if job.json {
            return Ok(());
        }
        said(&measured, (plan, &verdict), &shown, schlick.as_ref(), out)?;
        out.lines(files_written(target, kept))
    }
}

/// What the page and the terminal show: the whole table, or some stops of one that does not fit the memory.
struct ShownTable {
    table: BrdfTable,
    prediction: Option<Prediction>,
    /// The summary of these stops.
    summary: Summary,
}

impl ShownTable {
    fn of_rows(file: &NewFile, measured: &Measured, summary: Summary, memory: u64) -> Result<Self> {
        let (table, stops) = pages::thinned(&mut TableRows::open(file.under_way())?, memory)?;
        let prediction = Prediction::of(&measured.campaign, &table.grid);
        Ok(ShownTable { table, prediction, summary: summary.thinned(&stops) })
    }
}

fn said(
    measured: &Measured,
    (plan, verdict): (&Plan, &Verdict),
    shown: &ShownTable,
    schlick: Option<&SchlickError>,
    out: &mut Output,
) -> Result<()> {
    report(out, measured, plan, verdict)?;
    out.lines(schlick.into_iter().flat_map(optics::schlick_lines))?;
    out.lines(lobes(&measured.campaign, &shown.table, shown.prediction.as_ref()))
}

/// All files of a table on the disk, none in its place yet: for want of room nothing is replaced.
struct Staged {
    table: NewFile,
    realisations: Option<NewFile>,
    /// Page, card and summary.
    others: [NewFile; 3],
}

impl Staged {
    /// Without its summary a table counts as resumable, whatever happens from the first line on; it comes last.
    fn commit(self, target: &TablePaths) -> Result<()> {
        files::remove(&target.summary)?;
        self.table.commit()?;
        self.realisations.map_or_else(|| files::remove(&target.realisations), NewFile::commit)?;
        self.others.into_iter().try_for_each(NewFile::commit)
    }
}

fn staged_realisations(
    measured: &Measured,
    target: &TablePaths,
    digest: &str,
    (kept, plan): (StoredRealisations, &Plan),
) -> Result<Option<NewFile>> {
    let group_size = match kept {
        StoredRealisations::All => 1,
        StoredRealisations::Groups => plan.realisations as usize / GROUPS,
        StoredRealisations::Nothing => return Ok(None),
    };
    // Names and axes are those of the table; its values are not needed.
    let bytes = realisations::encode_of(&measured.realisations, &measured.table, digest, group_size)?;
    NewFile::with(&target.realisations, &bytes).map(Some)
}
