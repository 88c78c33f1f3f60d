//! The files of a table: taken band by band or all at once, staged, and put in their places together.

use super::paths::TablePaths;
use crate::error::{Error, Result};
use crate::files::{self, NewFile};
use crate::measure::{Cost, Measured, Plan};
use crate::report::html::specimen::ShownSpecimen;
use crate::report::{self as pages, Facts, Page, Summary};
use crate::table::realisations::{self, GROUPS, StoredRealisations};
use crate::table::{BrdfTable, Realisations, TableRows, TableWriter};
use crate::validate::prediction::schlick_error::SchlickError;
use crate::validate::{Examination, Parts, Prediction, Verdict};

/// A table under way.
pub struct TableOutput<'a> {
    paths: &'a TablePaths,
    plan: &'a Plan,
    writer: TableWriter<NewFile>,
    examination: Examination,
    facts: Facts,
    schlick: Option<SchlickError>,
    kept: StoredRealisations,
    /// The table without its values, the incidences' results, and the realisations that are to be kept.
    measured: Measured,
    /// The table and what theory says of it, where one band is all of it.
    whole: Option<(BrdfTable, Option<Prediction>)>,
}

impl<'a> TableOutput<'a> {
    /// Begins the files of `paths` with a first band of it, not taken yet; realisations may take `limit` bytes.
    pub fn new(paths: &'a TablePaths, first: &Measured, plan: &'a Plan, limit: u64) -> Result<Self> {
        let Measured { table, campaign, .. } = first;
        let count = first.realisations.parts.len();
        Ok(TableOutput {
            paths,
            plan,
            writer: TableWriter::create(&paths.table, table, &plan.grid)?,
            examination: Examination::new(Some(campaign), &plan.grid),
            facts: Facts::new(&plan.grid, table.colours.len()),
            schlick: None,
            kept: realisations::kept(&plan.grid, realisations::channels_of(table), count, limit),
            measured: Measured {
                campaign: campaign.clone(),
                table: table.header(&plan.grid),
                realisations: Realisations::default(),
                incidences: Vec::new(),
            },
            whole: None,
        })
    }

    /// Takes the next band, which begins at `first_incidence`.
    pub fn take(&mut self, band: Measured, first_incidence: usize) -> Result<()> {
        let Measured { table, campaign, realisations, incidences } = band;
        self.writer.append(&table)?;
        let prediction = Prediction::of(&campaign, &table.grid);
        // The verdict is one that `validate` finds again in the files.
        let realisations = match self.kept {
            StoredRealisations::Groups => realisations::grouped(&realisations, GROUPS)?,
            StoredRealisations::All | StoredRealisations::Nothing => realisations,
        };
        let parts = Parts { all: &realisations, first_incidence: 0 };
        self.examination.add(&table, first_incidence, Some(parts), prediction.as_ref());
        self.facts.add(&table, first_incidence);
        if let Some(next) = SchlickError::of(&campaign, &table) {
            match &mut self.schlick {
                Some(before) => before.join(next),
                None => self.schlick = Some(next),
            }
        }
        self.measured.incidences.extend(incidences);
        match self.kept {
            StoredRealisations::All | StoredRealisations::Groups => {
                self.measured.realisations.append(realisations)
            }
            StoredRealisations::Nothing => {}
        }
        if table.grid.incidences() == self.plan.incidences {
            self.whole = Some((table, prediction));
        }
        Ok(())
    }

    /// Puts the files in their places. `specimen` shows the first patch under this campaign.
    pub fn finish(
        self,
        memory: u64,
        cost: &Cost,
        specimen: impl Fn(&Measured) -> Result<ShownSpecimen>,
    ) -> Result<WrittenTable<'a>> {
        let TableOutput { paths, plan, writer, examination, facts, schlick, kept, measured, whole } = self;
        let verdict = examination.verdict();
        let (file, digest) = writer.finish()?;
        let summary = Summary::measured(&measured, (plan, cost), &verdict, schlick.clone(), digest.clone())?;
        let file = file.on_disk()?;
        let shown = match whole {
            Some((table, prediction)) => ShownTable { table, prediction, summary: summary.clone() },
            None => ShownTable::of_rows(&file, &measured, summary.clone(), memory)?,
        };
        let (campaign, prediction) = (Some(&measured.campaign), shown.prediction.as_ref());
        let page = Page::of(&shown.table, campaign, prediction, &shown.summary, specimen(&measured)?);
        // Of a table that is shown thinned the realisations belong to other incidences.
        let parts = (shown.table.grid.incidences() == plan.incidences).then_some(&measured.realisations);
        let look = pages::html::appearance::shown(&shown.table, parts);
        let page = pages::page(&Page { appearance: look.as_ref(), ..page });
        let card = pages::card(&measured.table, &digest, facts, &summary);
        let staged = Staged {
            table: file,
            realisations: staged_realisations(&measured, paths, &digest, (kept, plan))?,
            others: [
                NewFile::with(&paths.page, page.as_bytes())?,
                NewFile::with(&paths.card, card.as_bytes())?,
                NewFile::with(&paths.summary, format!("{}\n", json_text(&summary)?).as_bytes())?,
            ],
        };
        staged.commit(paths)?;
        let ShownTable { table, prediction, .. } = shown;
        Ok(WrittenTable { paths, plan, measured, verdict, schlick, kept, table, prediction })
    }
}

/// A table whose files are in their places, and what there is to say of it.
pub struct WrittenTable<'a> {
    /// Its files.
    pub paths: &'a TablePaths,
    /// How it was measured.
    pub plan: &'a Plan,
    /// The table without its values, and the results of each incidence.
    pub measured: Measured,
    /// How it stands against laws and models.
    pub verdict: Verdict,
    /// What Schlick's formula costs for its material.
    pub schlick: Option<SchlickError>,
    /// Which realisations its file has.
    pub kept: StoredRealisations,
    /// The table, or some incidences of one that does not fit the memory.
    pub table: BrdfTable,
    /// What theory says of these.
    pub prediction: Option<Prediction>,
}

/// What the page and the terminal show: the whole table, or some incidences of one that does not fit the memory.
struct ShownTable {
    table: BrdfTable,
    prediction: Option<Prediction>,
    /// The summary of these incidences.
    summary: Summary,
}

impl ShownTable {
    fn of_rows(file: &NewFile, measured: &Measured, summary: Summary, memory: u64) -> Result<Self> {
        let (table, incidences) = pages::thinned(&mut TableRows::open(file.under_way())?, memory)?;
        let prediction = Prediction::of(&measured.campaign, &table.grid);
        Ok(ShownTable { table, prediction, summary: summary.thinned(&incidences) })
    }
}

/// All files of a table on the disk, none in its place yet: for want of room nothing is replaced.
struct Staged {
    table: NewFile,
    realisations: Option<NewFile>,
    /// Page, card and summary.
    others: [NewFile; 3],
}

impl Staged {
    /// Without its summary a table counts as unfinished, whatever happens from the first line on; it comes last.
    fn commit(self, paths: &TablePaths) -> Result<()> {
        let [page, card, summary] = &self.others;
        for file in [Some(&self.table), self.realisations.as_ref(), Some(page), Some(card), Some(summary)] {
            file.map_or(Ok(()), NewFile::check_place)?;
        }
        files::remove(&paths.summary)?;
        self.table.commit()?;
        self.realisations.map_or_else(|| files::remove(&paths.realisations), NewFile::commit)?;
        self.others.into_iter().try_for_each(NewFile::commit)
    }
}

fn staged_realisations(
    measured: &Measured,
    paths: &TablePaths,
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
    NewFile::with(&paths.realisations, &bytes).map(Some)
}

fn json_text(summary: &Summary) -> Result<String> {
    serde_json::to_string_pretty(summary).map_err(|e| Error::Internal(format!("printing JSON: {e}")))
}
