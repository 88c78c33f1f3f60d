//! Promise: the campaign and its seed decide the table, and nothing else does.

use std::path::Path;

use gonio::campaign;
use gonio::measure::{self, Measured, Patches};
use gonio::table::store;

use crate::support::measuring::hits_of;

const LIGHT: &str = "theta_i_deg = [20, 50]\n";

fn campaign(seed: u64, alpha: &str, light: &str) -> String {
    format!(
        "name = \"again\"\nseed = {seed}\n\
         [surface]\nrealisations = 3\ncells = 32\n[surface.ggx]\n{alpha}\n\
         [light]\n{light}\naperture_deg = 2\n[sensor.hemisphere]\n[optics]\nmaterial = \"gold\"\n\
         [trace]\nbounces = 3\n[stop]\nsamples = 131_072\n"
    )
}

/// The same on grains of two coverages.
fn grains() -> String {
    let heights = "cells = 32\n[surface.ggx]\nalpha = 0.3";
    let grains = "[surface.grains]\ncoverage = [0.2, 0.8]\nbase = \"absorbing\"\nalpha = 0.3";
    campaign(1, "alpha = 0.3", LIGHT).replace(heights, grains)
}

/// All tables of a campaign, in as many blocks as its own plan has, each of an eighth of the samples: bytes have no noise.
fn measured(text: &str) -> Vec<Measured> {
    let campaign = campaign::parse(text, "c.toml", Path::new("")).expect("a good campaign").campaign;
    let mut plan = measure::plan(&campaign).expect("it fits");
    assert!(plan.blocks > 1, "{plan:?}");
    (plan.samples, plan.block_starts) = (plan.samples / 8, plan.block_starts / 8);
    let patches = Patches::prepare(&campaign, &mut Vec::new()).expect("patches");
    measure::measure(&campaign, &plan, &patches, &|_| ()).expect("no ray is lost").0
}

fn measured_one(text: &str) -> Measured {
    measured(text).pop().expect("one table")
}

/// Everything of a measurement that can be written down, to the last bit.
fn bits(measured: &[Measured]) -> Vec<String> {
    let one = |m: &Measured| {
        let digest = store::digest(&m.table).expect("a digest");
        let colours = m.table.colours.iter().flat_map(|c| [&c.total, &c.single, &c.stderr, &c.stderr_single]);
        let parts = m.realisations.parts.iter().flat_map(|part| part.total.iter().chain(&part.single));
        let values: Vec<u32> = colours.chain(parts).flatten().map(|v| v.to_bits()).collect();
        // `{:?}` of an f64 is the shortest text that reads back the same.
        format!("{digest} {} {values:?} {:?} {:?}", m.table.patch_digest, m.table.hits, m.incidences)
    };
    measured.iter().map(one).collect()
}

#[test]
fn the_table_is_identical_for_any_thread_count() {
    let surfaces = [
        grains(),
        campaign(1, "alpha = [0.2, 0.5]", LIGHT),
        campaign(
            1,
            "alpha_x = 0.2\nalpha_y = 0.5",
            "theta_i_deg = [50]\nazimuth = \"absolute\"\nphi_i_deg = [0, 25]",
        ),
    ];
    for text in surfaces {
        let with_threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            bits(&pool.install(|| measured(&text)))
        };
        let one = with_threads(1);
        for threads in [2, 7] {
            assert!(with_threads(threads) == one, "{threads} threads give another table");
        }
    }
}

#[test]
fn a_further_incidence_leaves_the_others_as_they_were() {
    let (few, more) = (
        measured_one(&campaign(1, "alpha = 0.3", LIGHT)),
        measured_one(&campaign(1, "alpha = 0.3", "theta_i_deg = [10, 20, 35, 50]")),
    );
    assert_eq!(hits_of(&few, 0), hits_of(&more, 1));
    assert_eq!(hits_of(&few, 1), hits_of(&more, 3));
    let absolute = |phi: &str| {
        let light = format!("theta_i_deg = [50]\nazimuth = \"absolute\"\nphi_i_deg = {phi}");
        measured_one(&campaign(1, "alpha_x = 0.2\nalpha_y = 0.5", &light))
    };
    let (few, more) = (absolute("[25]"), absolute("[0, 25, 90]"));
    assert_eq!(hits_of(&few, 0), hits_of(&more, 1));
}

#[test]
fn a_roughness_in_a_list_is_measured_as_if_alone() {
    let list = measured(&campaign(1, "alpha = [0.2, 0.5]", LIGHT));
    let alone = measured(&campaign(1, "alpha = 0.5", LIGHT));
    assert!(bits(&list)[1..] == bits(&alone)[..]);
}

#[test]
fn another_seed_gives_another_table() {
    let [a, b] = [1, 2].map(|seed| measured_one(&campaign(seed, "alpha = 0.3", LIGHT)));
    assert_ne!(a.table.patch_digest, b.table.patch_digest);
    for incidence in 0..2 {
        assert_ne!(hits_of(&a, incidence), hits_of(&b, incidence));
    }
    // Seeds that differ in the highest bit only are different seeds.
    let high = measured_one(&campaign(1 | 1 << 63, "alpha = 0.3", LIGHT));
    assert_ne!(a.table.patch_digest, high.table.patch_digest);
}
