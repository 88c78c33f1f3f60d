//! Promise: error bars mean what they say. An interval of 95 % misses what other seeds find in 5 % of the bins.

use gonio::measure::Measured;
use gonio::stats::student_limit;

use crate::support::long::or_long;
use crate::support::measuring::{hits_of, measured_one};

const REALISATIONS: usize = 8;
const COLUMNS: usize = 36;

fn table(seed: u64) -> Measured {
    // As many correlation lengths either way: smaller patches are made sooner.
    let (cells, length, samples) = or_long((64, 4, 16_384), (128, 8, 65_536));
    measured_one(&format!(
        "name = \"coverage\"\nseed = {seed}\n\
         [surface]\nrealisations = {REALISATIONS}\ncells = {cells}\ncorrelation_cells = {length}\n[surface.ggx]\nalpha = 0.4\n\
         [light]\ntheta_i_deg = [45]\n[sensor.hemisphere]\nphi_r_bins = {COLUMNS}\n[stop]\nsamples = {samples}\n"
    ))
}

/// Bins of a folded table that hold no mirror image of another: columns 0 to 18 of 36 centred ones.
fn own_bins(bins: usize) -> impl Iterator<Item = usize> {
    (0..bins).filter(|bin| bin % COLUMNS <= COLUMNS / 2)
}

/// By 40 seeds (GONIO_LONG): the mean of the others has an error of its own, 1/sqrt(39) of the interval's: 5.2 % expected. A
/// share over bins of 40 tables, dependent within a table: bounds of 4 and 7 %.
/// Power: bars too small by a tenth would miss in 7.4 %, too large by a tenth in 3.7 % (Student t, 7 degrees): both fail.
///
/// By 20 seeds and a quarter of the samples: 5.5 % expected, Student's t with the others' 1/sqrt(19). A table's share scatters by
/// 1.3 % (4 of its 325 intervals), that of 20 tables by 0.28 %: four of those, 4.4 to 6.6 %.
/// Power: bars too small by a seventh would miss in 9.0 %, too large by a fifth in 2.8 %: seen with probability 0.98 and more.
#[test]
fn an_interval_misses_what_other_seeds_find_in_one_bin_of_twenty() {
    let (seeds, bounds) = or_long((20, 0.044..=0.066), (40, 0.04..=0.07));
    let tables: Vec<Measured> = (1..=seeds).map(table).collect();
    let limit = student_limit(0.05, REALISATIONS - 1);
    let bins = tables[0].table.grid.bins();
    let (mut misses, mut intervals) = (0u32, 0u32);
    for bin in own_bins(bins) {
        let hits: u32 = tables.iter().map(|t| hits_of(t, 0)[bin]).sum();
        if f64::from(hits) < 3.0 * seeds as f64 * REALISATIONS as f64 {
            continue;
        }
        let values: Vec<f64> = tables.iter().map(|t| f64::from(t.table.colours[0].total[bin])).collect();
        let sum: f64 = values.iter().sum();
        for (table, value) in tables.iter().zip(&values) {
            let others = (sum - value) / (seeds - 1) as f64;
            let se = f64::from(table.table.colours[0].stderr[bin]);
            misses += u32::from((value - others).abs() > limit * se);
            intervals += 1;
        }
    }
    let share = f64::from(misses) / f64::from(intervals);
    println!("{misses} of {intervals} intervals miss: {:.2} %", 100.0 * share);
    assert!(u64::from(intervals) > 250 * seeds, "{intervals}");
    assert!(bounds.contains(&share), "{share}");
}
