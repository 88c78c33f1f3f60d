//! The document that `gonio bench` writes of its ladders, and that the page plots.

use serde::{Deserialize, Serialize};

use super::fit::LadderFit;
use super::ladder::Varies;
use super::run::{Bench, MeasuredRung};
use super::truth::{ERROR_MEASURE, TruthKind};
use crate::campaign::Campaign;

/// The schema that is written and read.
pub const SCHEMA: u64 = 1;

/// The document.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BenchAnswer {
    /// [`SCHEMA`].
    pub schema: u64,
    /// Name of the campaign.
    pub name: String,
    /// Its seed.
    pub seed: u64,
    /// Version of the program that measured.
    pub version: String,
    /// The error measure in words.
    pub error_measure: String,
    /// What the errors are counted from.
    pub truth: TruthKind,
    /// Its name.
    pub truth_name: String,
    /// The rungs of all ladders.
    pub rows: Vec<MeasuredRung>,
    /// The fit whose b is the bias: the last ladder's.
    pub fit: Option<LadderFit>,
    /// Each ladder.
    pub ladders: Vec<FittedLadder>,
    /// The campaign as TOML.
    pub campaign: String,
}

/// One ladder, without its rungs.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FittedLadder {
    /// What changes along it.
    pub varies: Varies,
    /// Noise and bias; null where an error is 0.
    pub fit: Option<LadderFit>,
}

impl BenchAnswer {
    /// Of a finished bench; `resolved` is the campaign as TOML.
    pub fn new(campaign: &Campaign, resolved: String, truth: TruthKind, bench: &Bench) -> Self {
        let ladders = bench.ladders.iter();
        BenchAnswer {
            schema: SCHEMA,
            name: campaign.name.clone(),
            seed: campaign.seed,
            version: env!("CARGO_PKG_VERSION").into(),
            error_measure: ERROR_MEASURE.into(),
            truth,
            truth_name: bench.truth.name.clone(),
            rows: ladders.clone().flat_map(|ladder| ladder.rows.clone()).collect(),
            fit: bench.ladders.last().and_then(|ladder| ladder.fit),
            ladders: ladders.map(|ladder| FittedLadder { varies: ladder.varies, fit: ladder.fit }).collect(),
            campaign: resolved,
        }
    }
}
