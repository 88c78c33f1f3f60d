//! What a file of finished blocks says of itself before its sums, and whether a run can be resumed from it.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::part::Part;
use crate::campaign;
use crate::campaign::Campaign;
use crate::error::{Error, Fault, Result};
use crate::files;
use crate::files::sealed;
use crate::measure::cost::Cost;

/// What the files of a run begin with, checkpoints and finished parts alike; another number is another format.
pub const KIND: &str = "gonio run 4";
/// A header is no longer than this: a campaign's text, and 33 bytes for each patch.
const LONGEST: usize = 1 << 24;

/// What the bytes of a run_state say of it before its sums.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RunHeader {
    /// Version of the program that wrote it.
    pub version: String,
    /// The resolved campaign.
    pub campaign: String,
    /// A later one has a higher number.
    pub number: u64,
    /// Whose incidences are measured.
    pub part: Part,
    /// Samples that are measured.
    pub starts: u64,
    /// Whether errors or the clock have been looked at, which depends on how many realisations there are.
    pub(crate) looked: bool,
    /// Blocks per incidence and realisation.
    pub(crate) blocks: u64,
    /// Whether starts go by slope, which follows from how many there are.
    pub(crate) by_slope: bool,
    pub(crate) digests: Vec<Option<[u8; 32]>>,
    pub(crate) cost: Cost,
}

impl RunHeader {
    /// The header of a file, which is read to its end and checked against its checksum, a piece at a time.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let begin =
            sealed::checked(KIND, &mut files::open(path)?, LONGEST).map_err(|e| Error::io(path, e))?;
        let begin = begin.map_err(|why| Error::format(path, why))?;
        let read = postcard::take_from_bytes::<RunHeader>(&begin).map_err(|e| unreadable(&e));
        read.and_then(|(header, _)| header.possible()).map_err(|why| Error::format(path, why))
    }

    /// Itself, unless its times are none: a checksum is not proof of who wrote a file.
    // Tested by `times_that_no_clock_shows_are_refused`.
    pub(crate) fn possible(self) -> std::result::Result<Self, String> {
        if self.cost.is_possible() { Ok(self) } else { Err("its times are no seconds from 0 up".into()) }
    }

    /// Why this cannot be resumed: another version, or a campaign that differs in more than that it has more
    /// samples or realisations. `file` is the campaign's, `at` where this was read from.
    pub fn faults(&self, (campaign, shard): (&Campaign, Option<Part>), file: &str, at: &str) -> Vec<Fault> {
        let fault = |path: &str, key: &str, value: Option<String>, allowed: String| Fault {
            path: path.into(),
            line: None,
            column: None,
            key: key.into(),
            value,
            allowed,
            too_large: false,
        };
        let version = env!("CARGO_PKG_VERSION");
        if self.version != version {
            let allowed =
                format!("{version} cannot resume what another version measured; --force starts again");
            return vec![fault(at, "version", Some(campaign::quoted(&self.version)), allowed)];
        }
        let mine = Some(self.part).filter(|part| part.is_shard());
        if mine != shard {
            let name = |shard: Option<Part>| shard.map_or("none".into(), |shard| shard.to_string());
            let allowed = format!("{} in the run that {at} keeps; --force starts again", name(mine));
            return vec![fault(file, "--shard", Some(name(shard)), allowed)];
        }
        let differences = campaign::differences(&self.campaign, &campaign::to_toml(campaign));
        let count = |text: &Option<String>| text.as_ref().and_then(|text| text.parse::<u64>().ok());
        let refused = differences.into_iter().filter_map(|difference| {
            let more = count(&difference.second) > count(&difference.first);
            let why = match difference.key.as_str() {
                "stop.samples" if more => return None,
                "surface.realisations" if more && !self.looked => return None,
                "surface.realisations" if more => ", and errors of so many have been looked at",
                "stop.samples" | "surface.realisations" => ", of which more are allowed, not fewer",
                _ => "",
            };
            let first = difference.first.as_deref().unwrap_or("not there");
            let allowed = format!(
                "{first} in the run that {at} keeps{why}; --force starts again, -o DIR writes elsewhere"
            );
            Some(fault(file, &difference.key, difference.second, allowed))
        });
        refused.collect()
    }

    /// What its samples have cost.
    pub fn cost(&self) -> Cost {
        Cost { samples: self.starts, ..self.cost.clone() }
    }
}

/// What is said of a content that cannot be read.
pub(crate) fn unreadable(why: &postcard::Error) -> String {
    format!("its content cannot be read: {why}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::plan;

    #[test]
    fn times_that_no_clock_shows_are_refused() {
        let text = "name = \"a\"\n[surface.mirror]\n[light]\ntheta_i_deg = [0]\n[sensor.hemisphere]\n\
                    [stop]\nsamples = 64\n";
        let campaign = campaign::parse(text, "a.toml", Path::new("")).expect("a campaign").campaign;
        let plan = plan(&campaign).expect("a plan");
        let header = crate::measure::RunState::new(&campaign, &plan).header(0, &campaign, &plan);
        assert!(header.clone().possible().is_ok());
        for s in [f64::NAN, f64::INFINITY, -1.0] {
            let cost = Cost { cpu_s: s, ..header.cost.clone() };
            assert!(RunHeader { cost, ..header.clone() }.possible().is_err(), "{s}");
        }
    }
}
