//! Finished bands of a run, each in a file of its own until the tables are whole.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::band_run::FinishedBands;
use super::header::RunHeader;
use super::run_state::{RunState, StoredRun};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::files;
use crate::measure::plan::Plan;
use crate::measure::plan::bands::Band;

/// What the files begin with; another number is another format.
const KIND: &str = "gonio band 2";

/// What helps where a file is damaged.
const ADVICE: &str = "without it --resume measures its band again, --force starts all again";

/// Where a run keeps its finished bands: `<stem>.band_<K>_of_<N>` in a folder.
#[derive(Debug, Clone)]
pub struct BandFiles {
    folder: PathBuf,
    stem: String,
}

impl BandFiles {
    /// Those of a run.
    pub fn of(folder: &Path, stem: &str) -> Self {
        BandFiles { folder: folder.into(), stem: stem.into() }
    }

    /// The file of a band.
    pub fn path(&self, band: Band) -> PathBuf {
        self.folder.join(band.file_name(&self.stem))
    }

    /// All files that are there, also of other numbers of bands.
    pub fn paths(&self) -> Result<Vec<PathBuf>> {
        let mut found = Vec::new();
        for entry in std::fs::read_dir(&self.folder).map_err(|e| Error::io(&self.folder, e))? {
            let path = entry.map_err(|e| Error::io(&self.folder, e))?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if Band::is_file_name(&name, &self.stem) {
                found.push(path);
            }
        }
        found.sort();
        Ok(found)
    }

    /// What is there, by number: headers of whole files of one run in bands.
    ///
    /// Errors: `Io`; `Format`, which names the file that is damaged, or of bands of another length.
    pub fn headers(&self) -> Result<FinishedBands> {
        let mut found = BTreeMap::new();
        let mut first: Option<Band> = None;
        for path in self.paths()? {
            let header = RunHeader::read(KIND, &path).map_err(with_advice)?;
            let band = header.band.filter(|band| self.path(*band) == path);
            let band =
                band.ok_or_else(|| Error::format(&path, format!("is not what its name says; {ADVICE}")))?;
            let first = first.get_or_insert(band);
            if (first.of, first.stops) != (band.of, band.stops) {
                let what = format!("is band {band}, there are others of {}; --force starts again", first.of);
                return Err(Error::format(&path, what));
            }
            found.insert(band.number, (path, header));
        }
        Ok(found)
    }

    /// Writes the file of the band that `plan` is of.
    pub fn save(&self, run_state: &RunState, campaign: &Campaign, plan: &Plan) -> Result<()> {
        let band = plan.band.ok_or_else(|| Error::Internal("a band without its number".into()))?;
        files::write_atomically(&self.path(band), &run_state.to_bytes(KIND, 0, campaign, plan)?)
    }

    /// Removes all files that are there.
    pub fn remove(&self) -> Result<()> {
        self.paths()?.iter().try_for_each(|path| files::remove(path))
    }
}

/// The content of a band's file.
pub fn load(path: &Path) -> Result<StoredRun> {
    StoredRun::from_bytes(KIND, &files::read(path)?).map_err(|why| with_advice(Error::format(path, why)))
}

fn with_advice(error: Error) -> Error {
    match error {
        Error::Format { path, what } => Error::format(&path, format!("{what}; {ADVICE}")),
        other => other,
    }
}
