//! The decisions of a plan, and the plans of parts of a campaign.

use std::ops::Range;

use serde::Serialize;

use super::start_sampler::StartSampler;
use crate::error::{Error, Result};
use crate::instrument::Grid;
use crate::measure::accumulate::fresnel_sums::FresnelSums;
use crate::measure::persist::part::Part;
use crate::table::rows;

/// Something that the campaign does not need.
#[derive(Debug, Clone, Serialize)]
pub struct Saving {
    /// What is left out.
    pub what: String,
    /// Why the answer stays the same.
    pub why: String,
    /// What is expected to be saved.
    pub saves: String,
}

/// The decisions.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    /// Incidences and bins.
    #[serde(skip)]
    pub grid: Grid,
    /// incidences.
    #[serde(rename = "stops")]
    pub incidences: usize,
    /// The part of the campaign that they are.
    #[serde(skip)]
    pub part: Part,
    /// Cells of a patch, as far as they are known before it is made.
    #[serde(skip)]
    pub cells: f64,
    /// Length in cells of the shadow of a measured map's whole relief at 45 degrees.
    #[serde(skip)]
    pub relief: f64,
    /// Sensor bins at each incidence.
    pub bins: usize,
    /// Tables (one for each roughness and material).
    pub tables: usize,
    /// Groups that error bars come from: patches, or sample regions of a measured map.
    pub realisations: u32,
    /// Blocks per incidence and realisation.
    pub blocks: u64,
    /// Samples in a block: `BLOCK`; only `bench` lowers it.
    #[serde(skip)]
    pub block_starts: u64,
    /// Samples per incidence and realisation: whole blocks.
    pub samples: u64,
    /// Samples of the whole run.
    pub total_samples: u64,
    /// Whether every block has an azimuth of its own.
    pub averages_azimuth: bool,
    /// Whether only light towards the sensor's apertures counts: a facet that sends light elsewhere gets no ray, and
    /// albedos are not known.
    pub apertures_only: bool,
    /// How the surface samples of a block are chosen.
    pub start_sampler: StartSampler,
    /// Mirror images of each patch that serve as further samples (1: none).
    pub images: u64,
    /// For each incidence, whether mirrored arrivals count as well.
    pub folded: Vec<bool>,
    /// Colours of all tables of a roughness.
    pub colours: usize,
    /// What is summed of every path; tests have colours traced that follow from others.
    #[serde(skip)]
    pub sums: FresnelSums,
    /// Angles (theta_i, phi_i) in whose place those of the incidences draw: an incidence that was moved a little keeps
    /// the random numbers that it had there. `None`: each incidence has its own.
    #[serde(skip)]
    pub drawn_at: Option<(f64, f64)>,
    /// What is left out, and why.
    pub skipped: Vec<Saving>,
    /// Incidences that are measured and written at a time: all, or as many as fit the memory.
    #[serde(rename = "band_stops")]
    pub band_incidences: usize,
    /// Estimated peak memory.
    pub memory_bytes: u64,
    /// Estimated time on two cores.
    pub estimated_s: f64,
}

impl Plan {
    /// Paths that a block counts.
    pub(crate) fn block_paths(&self) -> u64 {
        self.block_starts * self.sums.paths_of_a_start()
    }

    /// The bands of incidences whose tables are written one after the other; one where all fit the memory.
    pub fn bands(&self) -> Vec<Range<usize>> {
        rows::bands(self.incidences, 1, self.band_incidences as u64, 1)
    }

    /// The parts that are measured one after the other: bands, or the one part that this plan is of.
    pub fn parts(&self) -> Vec<Part> {
        if self.band_incidences < self.incidences {
            Part::bands(self.incidences, self.band_incidences)
        } else {
            vec![self.part]
        }
    }

    /// The plan of one of the parts of what this is the plan of.
    pub(crate) fn of_part(&self, part: Part) -> Result<Plan> {
        if part == self.part {
            return Ok(self.clone());
        }
        Ok(Plan { part, ..self.of_incidences(&part.incidences(&self.grid))? })
    }

    /// The plan of some of the incidences: their figures are those that they have among all.
    ///
    /// Errors: `Internal` for half vectors, which no campaign has.
    // Tested by `a_campaign_measured_in_bands_gives_the_same_bytes` (tests/it/table/large_tables.rs).
    pub(crate) fn of_incidences(&self, incidences: &[usize]) -> Result<Plan> {
        let grid = self.grid.of_incidences(incidences.iter().copied());
        let share = |total: u64| {
            (u128::from(total) * incidences.len() as u128 / self.incidences.max(1) as u128) as u64
        };
        Ok(Plan {
            grid: grid.ok_or_else(|| Error::Internal("half vectors in a campaign".into()))?,
            incidences: incidences.len(),
            part: Part::whole(incidences.len()),
            band_incidences: incidences.len(),
            start_sampler: self.start_sampler.of_incidences(incidences),
            total_samples: share(self.total_samples),
            folded: incidences.iter().map(|&incidence| self.folded[incidence]).collect(),
            ..self.clone()
        })
    }
}
