//! The files that a run keeps until its tables are whole: checkpoints of the part that is measured, and a file of each
//! part that is finished.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::checkpoint::{Checkpoint, FoundCheckpoint};
use super::header::RunHeader;
use super::part::Part;
use super::run_state::{RunState, StoredRun};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::files::{self, Destination, FolderLook};
use crate::measure::plan::Plan;

/// What helps where the file of a band is damaged.
const ADVICE: &str = "without it --resume measures its band again, --force starts all again";

/// Where a run keeps what it has measured: files whose names begin with `stem`.
#[derive(Debug)]
pub struct RunFiles {
    /// Where they are.
    pub folder: PathBuf,
    stem: String,
    /// The blocks that are finished of a part under way.
    pub checkpoint: Checkpoint,
    /// Files of parts that lay there at first, or were put there since.
    parts: Mutex<FolderLook>,
}

/// The file of a finished part.
#[derive(Debug)]
pub struct PartFile {
    /// Its path.
    pub path: PathBuf,
    /// What it says of itself.
    pub header: RunHeader,
}

/// Files of finished bands, by number.
pub type FinishedBands = BTreeMap<u32, PartFile>;

/// A run that was ended before its tables were written: its finished bands, and the blocks of a further part.
#[derive(Debug, Default)]
pub struct ResumableRun {
    /// The newest checkpoint.
    pub under_way: Option<FoundCheckpoint>,
    /// The bands with a file.
    pub finished: FinishedBands,
}

impl RunFiles {
    /// Those of a run.
    pub fn of(folder: &Path, stem: &str) -> Self {
        RunFiles {
            folder: folder.into(),
            stem: stem.into(),
            checkpoint: Checkpoint::of(folder, stem),
            parts: Mutex::new(FolderLook::at(folder, |name| name == stem || is_band(name, stem))),
        }
    }

    fn parts(&self) -> MutexGuard<'_, FolderLook> {
        self.parts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What the names of its files begin with.
    pub fn stem(&self) -> &str {
        &self.stem
    }

    /// The file of a part: that of a shard has the stem for its name, which says already which shard it is.
    pub fn part(&self, part: Part) -> PathBuf {
        let name = if part.is_shard() { self.stem.clone() } else { part.file_name(&self.stem) };
        self.folder.join(name)
    }

    /// Writes the file of the part that `plan` is of.
    pub fn save(&self, run_state: &RunState, campaign: &Campaign, plan: &Plan) -> Result<PartFile> {
        let path = self.part(plan.part);
        let mut parts = self.parts();
        files::write_atomically(parts.destination(&path), &run_state.to_bytes(0, campaign, plan)?)?;
        parts.placed(&path);
        Ok(PartFile { path, header: run_state.header(0, campaign, plan) })
    }

    /// What there is to be resumed.
    ///
    /// Errors: `Io`; `Format`, which names a file that is damaged, or not of the same division as the others.
    pub fn load(&self) -> Result<ResumableRun> {
        let found = ResumableRun { under_way: self.checkpoint.load()?, finished: self.finished()? };
        let division = |header: &RunHeader| (header.part.of, header.part.division);
        if let Some(checkpoint) = &found.under_way {
            let here = division(&checkpoint.kept.header);
            if let Some(band) = found.finished.values().find(|band| division(&band.header) != here) {
                let band = band.path.display();
                let what = format!("is not of the run that {band} is a band of; --force starts again");
                return Err(Error::format(&checkpoint.path, what));
            }
        }
        Ok(found)
    }

    /// The bands that have a file.
    fn finished(&self) -> Result<FinishedBands> {
        let mut found = FinishedBands::new();
        for path in self.bands()? {
            let header = RunHeader::read(&path).map_err(with_advice)?;
            let band = header.part;
            if self.part(band) != path {
                return Err(Error::format(&path, format!("is not what its name says; {ADVICE}")));
            }
            let first = found.values().next().map_or(band, |first| first.header.part);
            if (first.of, first.division) != (band.of, band.division) {
                let what = format!("is {band}, there are others of {}; --force starts again", first.of);
                return Err(Error::format(&path, what));
            }
            found.insert(band.number, PartFile { path, header });
        }
        Ok(found)
    }

    /// The files of bands that are there, also of other numbers of bands.
    fn bands(&self) -> Result<Vec<PathBuf>> {
        files_named(&self.folder, |name| is_band(name, &self.stem))
    }

    /// One of the files, if any is there.
    pub fn any(&self) -> Result<Option<PathBuf>> {
        let checkpoint = self.checkpoint.path().map(Path::to_path_buf);
        Ok(checkpoint.or(self.bands()?.into_iter().next()))
    }

    /// Removes all of them. The file of a shard stays: it is a result.
    pub fn remove(&self) -> Result<()> {
        self.checkpoint.remove()?;
        let result = self.folder.join(&self.stem);
        self.parts().all().filter(|part| ***part != *result).try_for_each(Destination::remove)
    }

    /// Removes what a run keeps whose results are all there; that of another campaign stays.
    pub fn remove_finished(&self, campaign: &Campaign, shard: Option<Part>) -> Result<()> {
        let of_this = |header: &RunHeader| header.faults((campaign, shard), "", "").is_empty();
        match self.load() {
            Ok(found) if found.headers().all(|(_, header)| of_this(header)) => self.remove(),
            _ => Ok(()),
        }
    }
}

impl ResumableRun {
    /// What its files say of themselves, the checkpoint first.
    pub fn headers(&self) -> impl Iterator<Item = (&Path, &RunHeader)> {
        let found = self.under_way.iter().map(|found| (found.path.as_path(), &found.kept.header));
        found.chain(self.finished.values().map(|band| (band.path.as_path(), &band.header)))
    }

    /// How many incidences it measured at a time, where that was not all.
    pub fn band_incidences(&self) -> Option<u64> {
        let (_, header) = self.headers().next()?;
        header.part.band_incidences()
    }

    /// Refuses what cannot be resumed, by the key of the campaign's `file` that differs.
    pub fn check(&self, campaign: &Campaign, shard: Option<Part>, file: &Path) -> Result<()> {
        let file = file.display().to_string();
        let faults = |(path, header): (&Path, &RunHeader)| {
            header.faults((campaign, shard), &file, &path.display().to_string())
        };
        let refused = self.headers().map(faults).find(|faults| !faults.is_empty());
        refused.map_or(Ok(()), |faults| Err(Error::Campaign(faults)))
    }
}

/// Whether a file is named as the bands of a run are.
fn is_band(name: &str, stem: &str) -> bool {
    Part::whole(0).stem(name) == Some(stem)
}

/// The content of a finished part's file.
pub(crate) fn load_part(path: &Path) -> Result<StoredRun> {
    StoredRun::from_bytes(&files::read(path)?).map_err(|why| Error::format(path, why))
}

/// The files of a folder with such names, sorted.
pub(crate) fn files_named(folder: &Path, is_wanted: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|e| Error::io(folder, e))? {
        let path = entry.map_err(|e| Error::io(folder, e))?.path();
        if path.file_name().is_some_and(|name| is_wanted(&name.to_string_lossy())) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

fn with_advice(error: Error) -> Error {
    match error {
        Error::Format { path, what } => Error::format(&path, format!("{what}; {ADVICE}")),
        other => other,
    }
}
