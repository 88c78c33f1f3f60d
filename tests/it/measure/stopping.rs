//! Promise: an incidence ends when its error is reached, when its patches are the limit, or when the time is over, and says
//! so; what it has by then is what a run of so many samples gives.

use gonio::measure::stopping::of_run;
use gonio::measure::{Measured, StoppedBy};

use crate::support::measuring::{measured, measured_one};

/// Three incidences on small patches; `rules` follow the samples.
fn campaign(realisations: u32, samples: u64, rules: &str) -> String {
    format!(
        "name = \"stopping\"\nseed = 3\n[surface]\nrealisations = {realisations}\ncells = 128\n\
         [surface.ggx]\nalpha = 0.3\n[light]\ntheta_i_deg = [0, 40, 70]\nazimuth = \"relative\"\n\
         [sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 12\n[stop]\nsamples = {samples}\n{rules}\n"
    )
}

fn ended(measured: &Measured) -> StoppedBy {
    of_run(measured.incidences.iter().map(|incidence| incidence.stopped_by))
}

#[test]
fn an_incidence_that_reaches_its_error_has_the_table_of_so_many_samples() {
    let early = measured_one(&campaign(8, 1 << 20, "relative_error = 0.2"));
    assert_eq!(ended(&early), StoppedBy::RelativeError);
    let block = 65_536;
    let whole = measured_one(&campaign(8, block, ""));
    for (incidence, result) in early.incidences.iter().enumerate() {
        // 72 bins share 8 x 65,536 starts: their errors are a few per cent, one block is enough.
        assert!(
            result.relative_error.is_some_and(|error| error <= 0.2) && result.samples == block,
            "{incidence}"
        );
        let bins = early.table.grid.bins();
        let row = incidence * bins..(incidence + 1) * bins;
        assert_eq!(early.table.hits[row.clone()], whole.table.hits[row.clone()]);
        for (a, b) in early.table.colours[0].total[row.clone()].iter().zip(&whole.table.colours[0].total[row])
        {
            // Flux is summed as a share of 16 blocks and scaled back: a power of two, but each start's share is
            // rounded to a unit of 2^-90 first.
            assert!((a - b).abs() <= 2.0 * f32::EPSILON * a, "{a} {b}");
        }
    }
}

#[test]
fn an_error_that_patches_cannot_give_is_said_with_the_number_that_could() {
    // 64 x 64 cells hold 8 bumps a side: patches differ by tenths, however many samples.
    let small = |samples| campaign(4, samples, "relative_error = 0.002").replace("cells = 128", "cells = 64");
    let limited = measured_one(&small(1 << 20));
    assert_eq!(ended(&limited), StoppedBy::PatchLimited);
    for incidence in
        limited.incidences.iter().filter(|incidence| incidence.stopped_by == StoppedBy::PatchLimited)
    {
        let (error, needed) =
            (incidence.relative_error.expect("looked at"), incidence.realisations_needed.expect("said"));
        assert!(error > 0.002 && incidence.samples <= 1 << 20);
        // The error falls with the root of the realisations.
        assert_eq!(needed, (4.0 * (error / 0.002).powi(2)).ceil() as u64);
    }
    // One look cannot tell noise from patches.
    assert_eq!(ended(&measured_one(&small(65_536))), StoppedBy::Samples);
}

#[test]
fn where_a_run_ends_does_not_depend_on_the_threads() {
    let text = campaign(4, 1 << 18, "relative_error = 0.02");
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| measured(&text))
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one[0].table, three[0].table);
}

#[test]
fn the_time_ends_a_run_after_whole_blocks_of_all_realisations() {
    // 2^40 starts would take weeks.
    let late = measured_one(&campaign(2, 1 << 34, "seconds = 1"));
    assert_eq!(ended(&late), StoppedBy::Seconds);
    let samples = late.incidences[0].samples;
    assert!(samples >= 65_536 && samples.is_multiple_of(65_536) && samples < 1 << 34);
    assert!(late.incidences.iter().all(|incidence| incidence.samples == samples));
    // All starts are counted, and F = 1: what leaves and what is cut is what fell in.
    for incidence in &late.incidences {
        let orders: u64 = incidence.orders.iter().sum();
        assert_eq!(orders + incidence.cut + incidence.hidden, 2 * samples);
    }
}
