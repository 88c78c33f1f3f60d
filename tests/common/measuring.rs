//! Measures a campaign's text through the library, and the statistics that several promises share.

// Each test program uses its own part.
#![allow(dead_code)]

use std::path::Path;

use gonio::campaign;
use gonio::measure::{self, Measured, Patches, Plan};
use gonio::rng::{self, Purpose, StreamId};
use rand_pcg::Pcg64Dxsm;

/// All tables of a campaign; its height maps lie in `folder`.
pub fn measured_in(folder: &Path, text: &str) -> Vec<Measured> {
    let parsed = campaign::parse(text, "c.toml", folder).unwrap_or_else(|e| panic!("refused: {e}\n{text}"));
    let plan = measure::plan(&parsed.campaign).expect("it fits the memory");
    let patches = Patches::prepare(&parsed.campaign, &mut Vec::new()).expect("patches");
    let (tables, _) = measure::measure(&parsed.campaign, &plan, &patches, &|_| ()).expect("no ray is lost");
    tables
}

/// The table of a campaign with one roughness and without files, measured after `change` of its plan.
pub fn measured_with(text: &str, change: impl FnOnce(&mut Plan)) -> Measured {
    let parsed =
        campaign::parse(text, "c.toml", Path::new("")).unwrap_or_else(|e| panic!("refused: {e}\n{text}"));
    let mut plan = measure::plan(&parsed.campaign).expect("it fits the memory");
    change(&mut plan);
    let patches = Patches::prepare(&parsed.campaign, &mut Vec::new()).expect("patches");
    let (mut tables, _) =
        measure::measure(&parsed.campaign, &plan, &patches, &|_| ()).expect("no ray is lost");
    tables.pop().expect("one table")
}

/// All tables of a campaign without files.
pub fn measured(text: &str) -> Vec<Measured> {
    measured_in(Path::new(""), text)
}

/// The table of a campaign with one roughness.
pub fn measured_one(text: &str) -> Measured {
    measured(text).pop().expect("one table")
}

/// Numbers for a test.
pub fn test_rng(seed: u64) -> Pcg64Dxsm {
    rng::stream(StreamId { seed, purpose: Purpose::Test, realisation: 0, stop: 0, block: 0 })
}

/// A whole number in [low, high).
pub fn whole(rng: &mut Pcg64Dxsm, low: i64, high: i64) -> i64 {
    low + (rng::uniform(rng) * (high - low) as f64) as i64
}

/// The columns of a table's row of hits for one stop.
pub fn hits_of(measured: &Measured, stop: usize) -> &[u32] {
    let bins = measured.table.grid.bins();
    &measured.table.hits[stop * bins..(stop + 1) * bins]
}

/// Which of `columns` columns `column` is after a turn by whole columns.
pub fn turned_bin(bin: usize, columns: usize, by: usize) -> usize {
    let (row, column) = (bin / columns, bin % columns);
    row * columns + (column + by) % columns
}
