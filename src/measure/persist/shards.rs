//! Shards that belong together, wherever they were measured.

use std::path::{Path, PathBuf};

use super::header::RunHeader;
use super::part::{Division, Part};
use super::run_files::{PartFile, files_named};
use crate::campaign;
use crate::error::{Error, Result};

/// Shards of one campaign, one of each number at most.
pub struct Shards(Vec<PartFile>);

/// The file of a shard and what it says of itself; it is read to its end and checked against its checksum, a piece at a time.
pub fn open(path: &Path) -> Result<PartFile> {
    let header = RunHeader::read(path)?;
    if !header.part.is_shard() {
        return Err(Error::format(path, "says of no shard"));
    }
    Ok(PartFile { path: path.into(), header })
}

/// The files of shards that lie in a folder, by name; a file is taken as it is.
pub fn find(at: &Path) -> Result<Vec<PathBuf>> {
    if at.is_file() {
        return Ok(vec![at.into()]);
    }
    let any = Part { number: 1, of: 1, division: Division::Shards };
    let mut found = files_named(at, |name| any.stem(name).is_some())?;
    found.retain(|path| path.is_file());
    Ok(found)
}

impl Shards {
    /// Holds shards against each other, in whatever order they come.
    ///
    /// Errors: `Format`, which names the file that is there twice, of another campaign, version or number of shards, or
    /// of other patches.
    pub fn new(mut all: Vec<PartFile>) -> Result<Self> {
        all.sort_by(|a, b| (a.header.part, &a.path).cmp(&(b.header.part, &b.path)));
        let Some((first, others)) = all.split_first() else {
            return Err(Error::Usage("no shard is there to be merged".into()));
        };
        others.iter().try_for_each(|other| agree(first, other))?;
        for (one, other) in all.iter().zip(&all[1..]) {
            if one.header.part == other.header.part {
                let what = format!("is shard {}, and so is {}", other.header.part, one.path.display());
                return Err(Error::format(&other.path, what));
            }
        }
        Ok(Shards(all))
    }

    /// The resolved campaign that all of them are of.
    pub fn campaign(&self) -> &str {
        &self.0[0].header.campaign
    }

    /// The file of the first.
    pub fn path(&self) -> &Path {
        &self.0[0].path
    }

    /// How many belong together.
    pub fn of(&self) -> u32 {
        self.0[0].header.part.of
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Those that are not there.
    pub fn missing(&self) -> Vec<Part> {
        let all = (1..=self.of()).map(|number| Part { number, ..self.0[0].header.part });
        all.filter(|shard| self.0.iter().all(|there| there.header.part != *shard)).collect()
    }

    /// Their files.
    pub(crate) fn files(self) -> Vec<PartFile> {
        self.0
    }
}

/// Whether a shard is of the run that the first is of.
fn agree(first: &PartFile, other: &PartFile) -> Result<()> {
    let at = first.path.display();
    let refused = |key: &str, here: &str, there: &str| {
        Err(Error::format(&other.path, format!("{key} = {here}, in {at} it is {there}: not of one run")))
    };
    let (there, here) = (&first.header, &other.header);
    if let Some(differs) = campaign::differences(&there.campaign, &here.campaign).first() {
        let value = |value: &Option<String>| value.clone().unwrap_or("not there".into());
        return refused(&differs.key, &value(&differs.second), &value(&differs.first));
    }
    if here.version != there.version {
        return refused("version", &here.version, &there.version);
    }
    if here.part.of != there.part.of {
        return refused("shard", &here.part.to_string(), &there.part.to_string());
    }
    match here.digests.iter().zip(&there.digests).position(|(here, there)| here != there) {
        Some(patch) => Err(Error::format(
            &other.path,
            format!(
                "patch {patch} is not that of {at}: made on another kind of processor; make the patches once, with \
                 `gonio surface`, and measure with --patches"
            ),
        )),
        None => Ok(()),
    }
}
