//! A measurement as its caller asks for it.

use std::path::{Path, PathBuf};

use super::paths::{self, TablePaths};
use super::run::Run;
use super::sweep::SweepPaths;
use super::watcher::{Silent, Watcher};
use super::{resume, threads};
use crate::campaign::{self, Campaign};
use crate::error::{Error, Result};
use crate::files::lock::Lock;
use crate::files::{self, memory};
use crate::measure::persist::shards;
use crate::measure::{self, Cost, Measured, Pace, Part, Patches, Plan, RunFiles};
use crate::table::realisations;

/// A campaign, and how it is measured.
///
/// ```
/// use gonio::campaign;
/// use gonio::job::Measurement;
///
/// let text = "name = \"mirror\"\n\
///             [surface]\nrealisations = 2\n[surface.mirror]\n\
///             [light]\ntheta_i_deg = [30]\n[sensor.hemisphere]\n[optics]\nf0 = 1.0\n[stop]\nsamples = 4096\n";
/// let campaign = campaign::parse(text, "mirror.toml", ".".as_ref())?.campaign;
/// let tables = Measurement::new(campaign).threads(2).run()?;
/// assert_eq!(tables[0].table.grid.incidences(), 1);
/// # Ok::<(), gonio::error::Error>(())
/// ```
pub struct Measurement<'a> {
    campaign: Campaign,
    label: Option<String>,
    /// The files of all tables and what lay there, where that was looked at before.
    looked: Option<Vec<TablePaths>>,
    source: PathBuf,
    folder: Option<PathBuf>,
    threads: Option<usize>,
    patches: Option<PathBuf>,
    memory: u64,
    shard: Option<Part>,
    keep_realisations: bool,
    resume: bool,
    force: bool,
    pace: Pace,
    watcher: &'a dyn Watcher,
}

/// What a measurement has written.
pub enum Written {
    /// The files of all tables.
    Tables(Vec<TablePaths>),
    /// The sums of a shard, for [`crate::measure::Merge`].
    Shard {
        /// Its file.
        file: PathBuf,
        /// The plan of its incidences; `None` where they had been measured before.
        plan: Option<Box<Plan>>,
        /// Incidences of the whole campaign.
        incidences: usize,
        /// What they cost.
        cost: Cost,
    },
}

impl<'a> Measurement<'a> {
    /// All of a campaign, on the caller's threads, within half of the memory that is free.
    pub fn new(campaign: Campaign) -> Self {
        Measurement {
            source: PathBuf::from(&campaign.name),
            campaign,
            label: None,
            looked: None,
            folder: None,
            threads: None,
            patches: None,
            memory: memory::memory_limit(),
            shard: None,
            keep_realisations: false,
            resume: false,
            force: false,
            pace: Pace::Rare,
            watcher: &Silent,
        }
    }

    /// The campaign's file: named where the campaign is at fault, and never written over.
    pub fn source(self, path: &Path) -> Self {
        Measurement { source: path.into(), ..self }
    }

    /// What the names of all files get besides the campaign's, as one of several runs; these have one sweep together, which
    /// is not written here.
    pub fn label(self, label: Option<String>) -> Self {
        Measurement { label, ..self }
    }

    /// So many worker threads, 0 for one a core; results do not depend on it.
    pub fn threads(self, number: usize) -> Self {
        Measurement { threads: Some(number), ..self }
    }

    /// The folder of the files; `out/<name>` unless said.
    pub fn folder(self, path: impl Into<PathBuf>) -> Self {
        Measurement { folder: Some(path.into()), ..self }
    }

    /// Patches that `gonio surface` wrote to this folder, instead of making them.
    pub fn patches(self, folder: Option<PathBuf>) -> Self {
        Measurement { patches: folder, ..self }
    }

    /// Bytes of memory that may be used: larger tables are measured in bands.
    pub fn memory(self, bytes: u64) -> Self {
        Measurement { memory: bytes, ..self }
    }

    /// One shard of the campaign alone.
    pub fn shard(self, shard: Option<Part>) -> Self {
        Measurement { shard, ..self }
    }

    /// Whether all realisations are kept, however large their file.
    pub fn keep_realisations(self, keep: bool) -> Self {
        Measurement { keep_realisations: keep, ..self }
    }

    /// Whether a run that was ended is resumed.
    pub fn resume(self, resume: bool) -> Self {
        Measurement { resume, ..self }
    }

    /// Whether results and unfinished runs that already exist are replaced.
    pub fn force(self, force: bool) -> Self {
        Measurement { force, ..self }
    }

    /// How often finished blocks are kept.
    pub fn pace(self, pace: Pace) -> Self {
        Measurement { pace, ..self }
    }

    /// Who is told how it goes.
    pub fn watcher(self, watcher: &'a dyn Watcher) -> Self {
        Measurement { watcher, ..self }
    }

    /// The files that the run keeps until its results are written.
    pub fn files(&self) -> RunFiles {
        let name = paths::run_stem(&self.campaign.name, self.label.as_deref());
        let stem = self.shard.map_or_else(|| name.clone(), |shard| shard.file_name(&name));
        RunFiles::of(&paths::folder_of(self.folder.as_deref(), &self.campaign), &stem)
    }

    /// Looks now at what lies where its tables will, not only when it begins: of several runs the others come before.
    pub fn look(self) -> Self {
        Measurement { looked: Some(self.tables()), ..self }
    }

    /// The files of all its tables.
    pub fn tables(&self) -> Vec<TablePaths> {
        if let Some(looked) = &self.looked {
            return looked.clone();
        }
        let folder = paths::folder_of(self.folder.as_deref(), &self.campaign);
        TablePaths::of_run(&self.campaign, &folder, self.label.as_deref())
    }

    /// Measures all tables in memory, one for each roughness and material; no file is written.
    ///
    /// Errors: `Refused` where they do not fit the memory at once; as [`measure::measure`].
    pub fn run(self) -> Result<Vec<Measured>> {
        self.on_threads(|job| {
            let plan = measure::plan_within(&job.campaign, job.memory)?;
            if plan.parts().len() > 1 {
                return Err(Error::Refused(format!(
                    "{}: does not fit the memory at once",
                    job.campaign.name
                )));
            }
            let patches = match &job.patches {
                Some(folder) => Patches::from_folder(&job.campaign, folder)?,
                None => Patches::prepare(&job.campaign, &mut Vec::new())?,
            };
            let samples = |more| job.watcher.samples(more);
            measure::measure(&job.campaign, &plan, &patches, &samples).map(|(tables, _)| tables)
        })
    }

    /// Measures what is not there yet, and writes tables, realisations, summaries, pages and cards, or a shard's sums.
    ///
    /// Errors: `Campaign`, `Refused` before anything is measured; `Format` where a file already exists that is not of this
    /// campaign; `Interrupted`, after which [`Self::resume`] ends with the same bytes; as [`measure::measure_missing`].
    pub fn write(self) -> Result<Written> {
        self.on_threads(|job| {
            // Refused before a folder is made.
            let plan = job.plan(&job.campaign)?;
            let folder = paths::folder_of(job.folder.as_deref(), &job.campaign);
            let _claim = files::create_folder(&folder)?;
            let kept = job.files();
            let _lock = Lock::take(&folder, kept.stem())?;
            match job.shard {
                Some(shard) => job.write_shard(shard, plan, &kept),
                None => job.write_tables(plan, &kept),
            }
        })
    }

    fn on_threads<T: Send>(self, work: impl FnOnce(&Self) -> Result<T> + Send) -> Result<T> {
        match self.threads {
            Some(number) => threads::pool(number)?.install(|| work(&self)),
            None => work(&self),
        }
    }

    fn plan(&self, campaign: &Campaign) -> Result<Plan> {
        measure::plan_of(campaign, self.shard, self.memory)
    }

    fn of<'b>(&'b self, campaign: &'b Campaign, plan: &'b Plan, files: &'b RunFiles) -> Run<'b> {
        Run {
            campaign,
            plan,
            files,
            patches: self.patches.as_deref(),
            memory: self.memory,
            realisations_limit: realisations::limit(self.keep_realisations),
            pace: self.pace,
            watcher: self.watcher,
        }
    }

    /// Measures and writes the tables that are not there yet.
    fn write_tables(&self, plan: Plan, kept: &RunFiles) -> Result<Written> {
        let all = self.tables();
        let mut open = Vec::new();
        for paths in &all {
            paths::spare_inputs(&paths.paths(), &self.source, &self.campaign)?;
        }
        let sweep = match self.label {
            None => SweepPaths::of(&self.campaign.name, &kept.folder, &all),
            Some(_) => None,
        };
        if let Some(sweep) = &sweep {
            paths::spare_inputs(&sweep.paths(), &self.source, &self.campaign)?;
            if !self.force {
                sweep.spare_foreign()?;
            }
        }
        for paths in &all {
            if self.force || !paths.is_finished(self.watcher)? {
                open.push(paths)
            } else {
                self.watcher.finished(&paths.table)?
            }
        }
        if open.is_empty() {
            kept.remove_finished(&self.campaign, None)?;
            return Ok(Written::Tables(all));
        }
        let found = resume::find(kept, self.resume, self.force, self.watcher)?;
        let campaign = resume::campaign_of(&self.campaign, &resume::measured(&found, &all, &open));
        found.check(&campaign, None, &self.source)?;
        let plan = if found.headers().next().is_some() {
            // Whatever memory is free by now.
            measure::resumed(&campaign, found.band_incidences(), self.memory)?
        } else if campaign == self.campaign {
            plan
        } else {
            self.plan(&campaign)?
        };
        self.of(&campaign, &plan, kept).measure_and_write(found, &open)?;
        if let Some(sweep) = &sweep {
            sweep.write(&self.campaign.name, &all)?;
            self.watcher.swept(sweep)?;
        }
        kept.remove()?;
        Ok(Written::Tables(all))
    }

    /// Measures the incidences of one shard, and keeps their sums.
    fn write_shard(&self, shard: Part, plan: Plan, kept: &RunFiles) -> Result<Written> {
        let file = kept.part(shard);
        paths::spare_inputs(&[&file], &self.source, &self.campaign)?;
        if !self.force && files::is_there(&file) {
            let there = shards::open(&file)
                .map_err(|e| paths::already_exists(&file, &format!("is no shard ({e})")))?
                .header;
            let source = self.source.display().to_string();
            let faults = there.faults((&self.campaign, Some(shard)), &source, "this file");
            if !faults.is_empty() || there.campaign != campaign::to_toml(&self.campaign) {
                return Err(paths::already_exists(
                    &file,
                    "was measured by another campaign, version or seed",
                ));
            }
            kept.remove_finished(&self.campaign, Some(shard))?;
            self.watcher.finished(&file)?;
            return Ok(Written::Shard {
                file,
                plan: None,
                incidences: measure::incidences(&self.campaign),
                cost: there.cost(),
            });
        }
        let found = resume::find(kept, self.resume, self.force, self.watcher)?;
        found.check(&self.campaign, Some(shard), &self.source)?;
        let (measured, _) = self.of(&self.campaign, &plan, kept).measure(found, &|_| ())?;
        kept.remove()?;
        let cost = measured.cost(&plan);
        Ok(Written::Shard {
            file,
            plan: Some(Box::new(plan)),
            incidences: measure::incidences(&self.campaign),
            cost,
        })
    }
}
