//! Measures a campaign's text through the library, and the statistics that several promises share.

use std::path::Path;

use gonio::campaign::{self, Campaign};
use gonio::measure::{self, Measured, Patches, Plan};
use gonio::rng::{self, Purpose, StreamId};
use gonio::surface::Heightfield;
use gonio::trace::{Facet, SurfacePoint};
use rand_pcg::Pcg64Dxsm;

/// All tables of a campaign; its height maps lie in `folder`. Where it asks for fewer surface samples than a block has, blocks
/// have no more than those, as those of `bench`: a test pays for what it asks for.
pub fn measured_in(folder: &Path, text: &str) -> Vec<Measured> {
    let parsed = campaign::parse(text, "c.toml", folder).unwrap_or_else(|e| panic!("refused: {e}\n{text}"));
    let mut plan = measure::plan(&parsed.campaign).expect("it fits the memory");
    by_few(&mut plan, parsed.campaign.stop.samples);
    let patches = Patches::prepare(&parsed.campaign, &mut Vec::new()).expect("patches");
    let (tables, _) = measure::measure(&parsed.campaign, &plan, &patches, &|_| ()).expect("no ray is lost");
    tables
}

/// Gives a plan blocks of no more surface samples than these.
pub fn by_few(plan: &mut Plan, samples: u64) {
    if samples < plan.block_starts {
        plan.total_samples = plan.total_samples / plan.samples * samples;
        (plan.block_starts, plan.samples) = (samples, samples);
    }
}

/// The table of a campaign with one roughness and without files, measured after `change` of its plan.
pub fn measured_with(text: &str, change: impl FnOnce(&mut Plan)) -> Measured {
    measured_as(text, |plan, _| {
        let mut plan = plan.clone();
        change(&mut plan);
        Some(plan)
    })
}

/// The same, measured by another plan.
pub fn measured_as(text: &str, other: impl FnOnce(&Plan, &Campaign) -> Option<Plan>) -> Measured {
    let parsed =
        campaign::parse(text, "c.toml", Path::new("")).unwrap_or_else(|e| panic!("refused: {e}\n{text}"));
    let patches = Patches::prepare(&parsed.campaign, &mut Vec::new()).expect("patches");
    measured_on(&patches, text, other)
}

/// The same on patches that are at hand.
pub fn measured_on(
    patches: &Patches,
    text: &str,
    other: impl FnOnce(&Plan, &Campaign) -> Option<Plan>,
) -> Measured {
    let parsed =
        campaign::parse(text, "c.toml", Path::new("")).unwrap_or_else(|e| panic!("refused: {e}\n{text}"));
    let plan = measure::plan(&parsed.campaign).expect("it fits the memory");
    let plan = other(&plan, &parsed.campaign).expect("another plan");
    let (mut tables, _) =
        measure::measure(&parsed.campaign, &plan, patches, &|_| ()).expect("no ray is lost");
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
    rng::stream(StreamId { seed, purpose: Purpose::Test, realisation: 0, incidence: 0, block: 0 })
}

/// A whole number in [low, high).
pub fn whole(rng: &mut Pcg64Dxsm, low: i64, high: i64) -> i64 {
    low + (rng::uniform(rng) * (high - low) as f64) as i64
}

/// A point of a random facet: inside, on an edge, or in a corner.
pub fn start(rng: &mut Pcg64Dxsm, field: &Heightfield) -> SurfacePoint {
    let (nx, ny) = (field.cells_x() as i64, field.cells_y() as i64);
    // Cells at the seams one time in four.
    let cell = |rng: &mut Pcg64Dxsm, n: i64| match whole(rng, 0, 8) {
        0 => 0,
        1 => n - 1,
        _ => whole(rng, 0, n),
    };
    let facet = Facet { x: cell(rng, nx) as usize, y: cell(rng, ny) as usize, upper: whole(rng, 0, 2) == 1 };
    let (a, b) = (rng::uniform(rng), rng::uniform(rng));
    let (u, v) = match whole(rng, 0, 8) {
        0 => [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)][whole(rng, 0, 3) as usize],
        1 => [(a, 0.0), (0.0, a), (a, 1.0 - a)][whole(rng, 0, 3) as usize],
        _ if a + b > 1.0 => (1.0 - a, 1.0 - b),
        _ => (a, b),
    };
    if facet.upper {
        SurfacePoint::on(field, facet, 1.0 - u, 1.0 - v)
    } else {
        SurfacePoint::on(field, facet, u, v)
    }
}

/// The columns of a table's row of hits for one incidence.
pub fn hits_of(measured: &Measured, incidence: usize) -> &[u32] {
    let bins = measured.table.grid.bins();
    &measured.table.hits[incidence * bins..(incidence + 1) * bins]
}

/// Which of `columns` columns `column` is after a turn by whole columns.
pub fn turned_bin(bin: usize, columns: usize, by: usize) -> usize {
    let (row, column) = (bin / columns, bin % columns);
    row * columns + (column + by) % columns
}
