//! Shards: a campaign's stops dealt to several machines, and their sums put together again.
//!
//! A stop is measured as a whole, by one shard, on the patches that all shards have: its sums are those of a run that
//! measures all stops.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::header::RunHeader;
use super::run_state::{RunState, StoredRun};
use crate::campaign;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::files;
use crate::instrument::Grid;
use crate::measure::cost::Cost;
use crate::measure::plan::Plan;

/// What the files begin with; another number is another format.
const KIND: &str = "gonio shard 3";

/// One of several parts of a campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    /// From 1.
    pub number: u32,
    /// How many there are.
    pub of: u32,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((number, of)) if 1 <= number && number <= of => Ok(Shard { number, of }),
            _ => Err("K/N with 1 <= K <= N is needed, as in 2/7".into()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl Shard {
    /// The stops that it measures, increasing: whole azimuths where there are enough of them; else every `of`-th stop, so
    /// that each shard has grazing ones. None where there are more shards than stops.
    ///
    /// Held by: `every_stop_is_dealt_once`.
    pub fn stops(self, grid: &Grid) -> Vec<usize> {
        let azimuth = |stop: usize| grid.stop_deg(stop).1;
        let mut order: Vec<usize> = (0..grid.stops()).collect();
        order.sort_by(|&a, &b| azimuth(a).total_cmp(&azimuth(b)).then(a.cmp(&b)));
        let whole_azimuths = grid.azimuths() >= self.of as usize;
        let (mut dealt, mut azimuths) = (Vec::new(), 0);
        for (place, &stop) in order.iter().enumerate() {
            azimuths += usize::from(place > 0 && azimuth(stop) != azimuth(order[place - 1]));
            let hand = if whole_azimuths { azimuths } else { place };
            if hand % self.of as usize == self.number as usize - 1 {
                dealt.push(stop);
            }
        }
        dealt.sort_unstable();
        dealt
    }

    /// The name of its file, and the stem of its checkpoints.
    pub fn file_name(self, campaign: &Campaign) -> String {
        format!("{}.shard_{}_of_{}", campaign.name, self.number, self.of)
    }

    /// Whether a file's name may be that of a shard.
    pub fn is_name(name: &str) -> bool {
        let numbers = name.rsplit_once(".shard_").and_then(|(_, end)| end.split_once("_of_"));
        numbers.is_some_and(|(k, n)| k.parse::<u32>().is_ok() && n.parse::<u32>().is_ok())
    }
}

/// Writes the file of a shard whose run is at its end.
pub fn save(path: &Path, run_state: &RunState, campaign: &Campaign, plan: &Plan) -> Result<()> {
    files::write_atomically(path, &run_state.to_bytes(KIND, 0, campaign, plan)?)
}

/// What the file of a shard says of itself; it is read to its end and held to its checksum, a piece at a time.
pub fn header(path: &Path) -> Result<RunHeader> {
    let header = RunHeader::read(KIND, path)?;
    match header.shard {
        Some(_) => Ok(header),
        None => Err(Error::format(path, "says of no shard")),
    }
}

/// Reads the file of a shard.
pub(crate) fn load(path: &Path) -> Result<StoredRun> {
    StoredRun::from_bytes(KIND, &files::read(path)?).map_err(|why| Error::format(path, why))
}

/// The files of shards that lie in a folder, by name; a file is taken as it is.
pub fn find(at: &Path) -> Result<Vec<PathBuf>> {
    if at.is_file() {
        return Ok(vec![at.into()]);
    }
    let mut found = Vec::new();
    for entry in std::fs::read_dir(at).map_err(|e| Error::io(at, e))? {
        let path = entry.map_err(|e| Error::io(at, e))?.path();
        if path.is_file() && path.file_name().is_some_and(|name| Shard::is_name(&name.to_string_lossy())) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Shards that belong together, one of each number at most.
pub struct Shards {
    all: Vec<(Shard, PathBuf, RunHeader)>,
    of: u32,
}

impl Shards {
    /// Holds shards against each other, in whatever order they come.
    ///
    /// Errors: `Format`, which names the file that is there twice, of another campaign, version or number of shards, or
    /// of other patches.
    pub fn new(found: Vec<(PathBuf, RunHeader)>) -> Result<Self> {
        let with_shard =
            |(path, header): (PathBuf, RunHeader)| header.shard.map(|shard| (shard, path, header));
        let mut all: Vec<(Shard, PathBuf, RunHeader)> = found.into_iter().filter_map(with_shard).collect();
        all.sort_by(|a, b| (a.0, &a.1).cmp(&(b.0, &b.1)));
        let Some((first, others)) = all.split_first() else {
            return Err(Error::Usage("no shard is there to be merged".into()));
        };
        for other in others {
            agree(first, other)?;
        }
        if let Some(pair) = all.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            let what = format!("is shard {}, and so is {}", pair[1].0, pair[0].1.display());
            return Err(Error::format(&pair[1].1, what));
        }
        let of = first.0.of;
        Ok(Shards { all, of })
    }

    /// The resolved campaign that all of them are of.
    pub fn campaign(&self) -> &str {
        &self.all[0].2.campaign
    }

    /// The file of the first.
    pub fn path(&self) -> &Path {
        &self.all[0].1
    }

    /// How many belong together.
    pub fn of(&self) -> u32 {
        self.of
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// The numbers that are not there.
    pub fn missing(&self) -> Vec<Shard> {
        let all = (1..=self.of).map(|number| Shard { number, of: self.of });
        all.filter(|shard| self.all.iter().all(|(there, ..)| there != shard)).collect()
    }

    /// Their files.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.all.iter().map(|(_, path, _)| path.as_path())
    }

    /// The stops that each was dealt, increasing.
    pub(crate) fn dealt(&self, grid: &Grid) -> Vec<Vec<usize>> {
        self.all.iter().map(|(shard, ..)| shard.stops(grid)).collect()
    }

    /// What they have cost together.
    pub(crate) fn cost(&self) -> Cost {
        let costs =
            self.all.iter().map(|(.., header)| Cost { samples: header.starts, ..header.cost.clone() });
        costs.fold(Cost::default(), Cost::plus)
    }
}

/// Whether a shard is of the run that the first is of.
fn agree(first: &(Shard, PathBuf, RunHeader), other: &(Shard, PathBuf, RunHeader)) -> Result<()> {
    let (RunHeader { version, campaign, digests, .. }, at) = (&first.2, first.1.display());
    let refused = |key: &str, here: &str, there: &str| {
        Err(Error::format(&other.1, format!("{key} = {here}, in {at} it is {there}: not of one run")))
    };
    let header = &other.2;
    if let Some(differs) = campaign::differences(campaign, &header.campaign).first() {
        let none = "not there";
        let value = |value: &Option<String>| value.clone().unwrap_or(none.into());
        return refused(&differs.key, &value(&differs.second), &value(&differs.first));
    }
    if header.version != *version {
        return refused("version", &header.version, version);
    }
    if other.0.of != first.0.of {
        return refused("shard", &other.0.to_string(), &first.0.to_string());
    }
    match header.digests.iter().zip(digests).position(|(here, there)| here != there) {
        Some(patch) => Err(Error::format(
            &other.1,
            format!(
                "patch {patch} is not that of {at}: made on another kind of processor; make the patches once, with \
                 `gonio surface`, and measure with --patches"
            ),
        )),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(thetas: usize, azimuths: usize) -> Grid {
        Grid {
            theta_i_deg: (0..thetas).map(|k| k as f64).collect(),
            phi_i_deg: (0..azimuths).map(|k| k as f64).collect(),
            ..Grid::default()
        }
    }

    #[test]
    fn every_stop_is_dealt_once() {
        for (thetas, azimuths, of) in
            [(6, 1, 1), (6, 1, 4), (6, 1, 6), (5, 7, 3), (5, 7, 7), (5, 7, 8), (1, 4, 3)]
        {
            let grid = grid(thetas, azimuths);
            let shards: Vec<Vec<usize>> = (1..=of).map(|number| Shard { number, of }.stops(&grid)).collect();
            let mut all = shards.concat();
            all.sort_unstable();
            assert_eq!(all, (0..thetas * azimuths).collect::<Vec<_>>());
            let sizes = shards.iter().map(Vec::len);
            let whole = if azimuths >= of as usize { thetas } else { 1 };
            assert!(sizes.clone().max().expect("some") - sizes.min().expect("some") <= whole, "{shards:?}");
        }
        // Whole azimuths: stop = 7 theta + azimuth.
        assert_eq!(Shard { number: 2, of: 7 }.stops(&grid(3, 7)), [1, 8, 15]);
        assert!(Shard { number: 4, of: 4 }.stops(&grid(3, 1)).is_empty());
    }

    #[test]
    fn shards_are_read_and_named() {
        assert_eq!("2/7".parse(), Ok(Shard { number: 2, of: 7 }));
        for wrong in ["0/7", "8/7", "2", "2/", "-1/3", "1/0", "a/b", "1/4294967296"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
        assert!(Shard::is_name("a.b.shard_2_of_7") && !Shard::is_name("a.shard_2_of_7.checkpoint_0"));
        assert!(!Shard::is_name("shard_2_of_7") && !Shard::is_name("a.shard_2_of_7.tmp.99"));
    }
}
