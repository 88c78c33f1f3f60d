//! Parts of a campaign: a run measures all incidences, those that are dealt to one of several machines, or band after
//! band of as many as fit the memory.
//!
//! An incidence is measured as a whole, in one part, on patches that all parts share, and its random numbers follow from
//! its angles: its sums are those of a run that measures all incidences at once.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::instrument::Grid;

/// One of several parts of a campaign, which have every incidence once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Part {
    /// From 1.
    pub number: u32,
    /// How many there are.
    pub of: u32,
    /// Which incidences each has.
    pub division: Division,
}

/// How the incidences of a campaign are divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Division {
    /// Shards, for machines that measure at the same time: whole azimuths where there are enough of them; else every
    /// `of`-th incidence, so that each shard has grazing ones.
    Shards,
    /// Bands, for one machine that measures one after the other: so many neighbours in each, fewer in the last.
    Bands(u64),
}

impl Part {
    /// All of so many incidences: the only band.
    pub fn whole(incidences: usize) -> Part {
        Part { number: 1, of: 1, division: Division::Bands(incidences as u64) }
    }

    /// The bands of `each` incidences of `incidences`.
    pub fn bands(incidences: usize, each: usize) -> Vec<Part> {
        let of = incidences.div_ceil(each.max(1)) as u32;
        (1..=of).map(|number| Part { number, of, division: Division::Bands(each as u64) }).collect()
    }

    /// Whether it is one of those that `--shard` names.
    pub fn is_shard(self) -> bool {
        self.division == Division::Shards
    }

    /// Whether it is all that there is.
    pub fn is_whole(self) -> bool {
        !self.is_shard() && self.of == 1
    }

    /// How many incidences each of several bands has, if it is one.
    pub fn band_incidences(self) -> Option<u64> {
        match self.division {
            Division::Bands(each) if self.of > 1 => Some(each),
            _ => None,
        }
    }

    /// The incidences that it has, increasing; none where there are more shards than incidences.
    pub fn incidences(self, grid: &Grid) -> Vec<usize> {
        match self.division {
            Division::Shards => self.dealt(grid),
            Division::Bands(each) => neighbours(self.number, each, grid.incidences()).collect(),
        }
    }

    // Tested by `every_incidence_is_dealt_once`.
    fn dealt(self, grid: &Grid) -> Vec<usize> {
        let azimuth = |incidence: usize| grid.incidence_deg(incidence).1;
        let mut order: Vec<usize> = (0..grid.incidences()).collect();
        order.sort_by(|&a, &b| azimuth(a).total_cmp(&azimuth(b)).then(a.cmp(&b)));
        let whole_azimuths = grid.azimuths() >= self.of as usize;
        let (mut dealt, mut azimuths) = (Vec::new(), 0);
        for (place, &incidence) in order.iter().enumerate() {
            azimuths += usize::from(place > 0 && azimuth(incidence) != azimuth(order[place - 1]));
            let hand = if whole_azimuths { azimuths } else { place };
            if hand % self.of as usize == self.number as usize - 1 {
                dealt.push(incidence);
            }
        }
        dealt.sort_unstable();
        dealt
    }

    /// The name of its file in a run whose files begin with `stem`.
    pub fn file_name(self, stem: &str) -> String {
        format!("{stem}.{}_{}_of_{}", self.kind(), self.number, self.of)
    }

    /// The stem of a file's name that may be that of such a part, whatever its numbers.
    pub fn stem(self, name: &str) -> Option<&str> {
        let (stem, numbers) = name.rsplit_once(&format!(".{}_", self.kind()))?;
        let (number, of) = numbers.split_once("_of_")?;
        (number.parse::<u32>().is_ok() && of.parse::<u32>().is_ok()).then_some(stem)
    }

    fn kind(self) -> &'static str {
        if self.is_shard() { "shard" } else { "band" }
    }
}

fn neighbours(number: u32, each: u64, incidences: usize) -> Range<usize> {
    let edge = |number: u32| (u64::from(number).saturating_mul(each)).min(incidences as u64) as usize;
    edge(number - 1)..edge(number)
}

/// A shard, as the command line has it.
impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((number, of)) if 1 <= number && number <= of => {
                Ok(Part { number, of, division: Division::Shards })
            }
            _ => Err("K/N with 1 <= K <= N is needed, as in 2/7".into()),
        }
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.division {
            Division::Shards => write!(f, "{}/{}", self.number, self.of),
            Division::Bands(_) => write!(f, "band {} of {}", self.number, self.of),
        }
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

    fn shard(number: u32, of: u32) -> Part {
        Part { number, of, division: Division::Shards }
    }

    #[test]
    fn every_incidence_is_dealt_once() {
        for (thetas, azimuths, of) in
            [(6, 1, 1), (6, 1, 4), (6, 1, 6), (5, 7, 3), (5, 7, 7), (5, 7, 8), (1, 4, 3)]
        {
            let grid = grid(thetas, azimuths);
            let shards: Vec<Vec<usize>> =
                (1..=of).map(|number| shard(number, of).incidences(&grid)).collect();
            let bands: Vec<Vec<usize>> = Part::bands(grid.incidences(), of as usize)
                .iter()
                .map(|band| band.incidences(&grid))
                .collect();
            let mut dealt = shards.concat();
            dealt.sort_unstable();
            let all: Vec<usize> = (0..thetas * azimuths).collect();
            assert_eq!((dealt, bands.concat()), (all.clone(), all));
            let sizes = shards.iter().map(Vec::len);
            let whole = if azimuths >= of as usize { thetas } else { 1 };
            assert!(sizes.clone().max().expect("some") - sizes.min().expect("some") <= whole, "{shards:?}");
        }
        // Whole azimuths: incidence = 7 theta + azimuth.
        assert_eq!(shard(2, 7).incidences(&grid(3, 7)), [1, 8, 15]);
        assert!(shard(4, 4).incidences(&grid(3, 1)).is_empty());
        assert_eq!(Part::whole(21).incidences(&grid(3, 7)).len(), 21);
    }

    #[test]
    fn shards_are_read_and_files_named() {
        assert_eq!("2/7".parse(), Ok(shard(2, 7)));
        for wrong in ["0/7", "8/7", "2", "2/", "-1/3", "1/0", "a/b", "1/4294967296"] {
            assert!(wrong.parse::<Part>().is_err(), "{wrong}");
        }
        assert_eq!(shard(2, 7).stem("a.b.shard_2_of_7"), Some("a.b"));
        assert_eq!(shard(1, 1).stem("a.shard_2_of_7.checkpoint_0"), None);
        assert_eq!(shard(1, 1).stem("a.band_2_of_7"), None);
        assert_eq!(Part::whole(4).stem("a.band_2_of_7"), Some("a"));
    }
}
