//! Promise: `compare` tells differences from noise, bin by bin, and refuses tables that have nothing in common.

use std::fs;

use gonio::campaign::{self, Campaign};
use gonio::instrument::{Grid, GridKind};
use gonio::measure::Measured;
use gonio::rng::{self, Purpose, StreamId};
use gonio::table::{BrdfTable, ColourChannels, RealisationPart, Realisations, store};
use gonio::validate::two_tables::{ComparedTable, difference};
use rand_pcg::Pcg64Dxsm;

use crate::support::long::{is_long, or_long};
use crate::support::measuring::measured_one;
use crate::support::program::{self, exits, gonio};

/// A statistical surface: no patches to make.
const SMITH: &str = "\
name = \"smith\"
seed = 1
[surface]
realisations = 8
[surface.smith]
ndf = \"ggx\"
alpha = 0.5
[light]
theta_i_deg = [0, 40]
[sensor.hemisphere]
theta_r_bins = 9
phi_r_bins = 18
[stop]
samples = 65_536
";

/// Two bins, projected solid angles pi/4 and 3 pi/4.
fn table(values: [f32; 2], stderr: [f32; 2]) -> BrdfTable {
    let grid = Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: vec![0.0],
        phi_i_deg: vec![0.0],
        phi_r_relative: true,
        theta_r_edges_deg: vec![0.0, 30.0, 90.0],
        phi_r_edges_deg: vec![0.0, 360.0],
        ..Grid::default()
    };
    let channels = ColourChannels {
        total: values.to_vec(),
        single: values.to_vec(),
        multiple: vec![0.0; 2],
        stderr: stderr.to_vec(),
        stderr_single: stderr.to_vec(),
        ..ColourChannels::default()
    };
    BrdfTable {
        grid,
        campaign: String::new(),
        version: "test".into(),
        seed: 1,
        patch_digest: String::new(),
        colours: vec![channels],
        hits: vec![10; 2],
        schlick: None,
    }
}

fn with<'a>(table: &'a BrdfTable, parts: &'a Realisations) -> ComparedTable<'a> {
    ComparedTable { parts: Some(parts), ..alone(table) }
}

fn alone(table: &BrdfTable) -> ComparedTable<'_> {
    ComparedTable::of(table)
}

#[test]
fn the_measures_follow_their_definitions() {
    let (a, b) = (table([1.5, 3.0], [0.3, 0.25]), table([1.0, 4.0], [0.4, 0.0]));
    let found = difference(alone(&a), alone(&b)).expect("one grid");
    // l1 = (0.5 + 3 1)/(1 + 3 4); se 0.5 and 0.25; c4 of a thousand realisations is 1 to 3e-4; t = 1 and 4.
    let noise = (2.0 / std::f64::consts::PI).sqrt() * (0.5 + 3.0 * 0.25) / 13.0;
    let figures = found.figures;
    assert!((figures.l1.unwrap() - 3.5 / 13.0).abs() < 1e-12);
    assert!((figures.l1_noise.unwrap() / noise - 1.0).abs() < 5e-4, "{figures:?} {noise}");
    // 0.3 and 0.4 are f32.
    assert!((figures.max_t.unwrap() - 4.0).abs() < 1e-6);
    assert_eq!((figures.share_outside_95, found.bins, found.paired), (Some(0.5), 2, false));
    // Both half-widths are 1.9623 standard errors (999 degrees of freedom): E_n is t over that, 0.51 and 2.04.
    assert!((figures.max_e_n.unwrap() - 4.0 / 1.9623).abs() < 1e-3, "{figures:?}");
    assert_eq!(figures.share_e_n_above_1, Some(0.5));
}

#[test]
fn bins_without_hits_have_no_t_and_tables_without_errors_no_noise() {
    let (mut a, b) = (table([1.5, 0.0], [0.3, 1.0]), table([1.0, 4.0], [0.4, 0.3]));
    a.hits[1] = 0;
    let found = difference(alone(&a), alone(&b)).expect("one grid");
    assert_eq!((found.bins, found.figures.share_outside_95), (1, Some(0.0)));
    let unknown = table([1.0, 4.0], [-1.0, -1.0]);
    let found = difference(alone(&a), alone(&unknown)).expect("one grid");
    assert!(found.figures.l1.is_some() && found.figures.l1_noise.is_none() && found.figures.max_t.is_none());
}

#[test]
fn tables_of_the_same_patches_are_paired() {
    // Realisations differ by 2 from each other, tables in each by 0.1 and 0.2: se = 0.05, not 1.4.
    let part = |x: f32| RealisationPart { total: vec![vec![x, x]], single: vec![vec![x, x]], schlick: None };
    let parts = |values: [f32; 2]| Realisations { parts: values.map(part).to_vec() };
    let (mut a, mut b) = (table([2.15, 2.15], [1.0, 1.0]), table([2.0, 2.0], [1.0, 1.0]));
    (a.patch_digest, b.patch_digest) = ("same".into(), "same".into());
    let (in_a, in_b) = (parts([1.1, 3.2]), parts([1.0, 3.0]));
    let found = difference(with(&a, &in_a), with(&b, &in_b)).expect("one grid");
    // (0.15)/(0.05), all of it f32.
    assert!(found.paired && (found.figures.max_t.unwrap() - 3.0).abs() < 1e-4, "{found:?}");
    b.patch_digest = "other".into();
    assert!(!difference(with(&a, &in_a), with(&b, &in_b)).expect("one grid").paired);
}

fn side<'a>(measured: &'a Measured, campaign: &'a Campaign) -> ComparedTable<'a> {
    ComparedTable { campaign: Some(campaign), parts: Some(&measured.realisations), ..alone(&measured.table) }
}

#[test]
fn equal_laws_differ_by_their_noise_alone() {
    let a = measured_one(SMITH);
    let b = measured_one(&SMITH.replace("seed = 1", "seed = 2"));
    let found = difference(side(&a, &a.campaign), side(&b, &b.campaign)).expect("one grid");
    let (l1, noise) = (found.figures.l1.unwrap(), found.figures.l1_noise.unwrap());
    // The mean of |t| over n = 180 counted bins and more scatters by 0.76/sqrt(n) = 6 %: four times that.
    assert!((l1 / noise - 1.0).abs() < 0.24, "{l1} {noise}");
    // 5 % of n bins, binomial: 4 sqrt(0.05 0.95/n) = 0.065; Welch's degrees of freedom are rounded down.
    assert!(found.bins > 150 && found.figures.share_outside_95.unwrap() < 0.05 + 0.065, "{found:?}");
    assert!(found.figures.max_t < found.t_limit, "{found:?}");
    let rougher = measured_one(&SMITH.replace("alpha = 0.5", "alpha = 0.6"));
    let found = difference(side(&rougher, &rougher.campaign), side(&b, &b.campaign)).expect("one grid");
    assert!(found.figures.max_t > found.t_limit, "{found:?}");
}

#[test]
fn the_command_prints_json_or_refuses_in_one_line() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let save = |name: &str, table: &BrdfTable| store::save(&folder.path().join(name), table).expect("saved");
    save("a.exr", &table([1.5, 3.0], [0.3, 0.25]));
    save("b.exr", &table([1.0, 4.0], [0.4, 0.0]));
    let mut other = table([1.0, 4.0], [0.4, 0.0]);
    other.grid.theta_i_deg = vec![40.0];
    save("c.exr", &other);
    let run = |words: &[&str]| gonio(folder.path(), words);
    let answer = run(&["compare", "a.exr", "b.exr", "--json"]);
    let json = program::json(&answer);
    for key in ["bins", "l1", "l1_noise", "max_t", "share_outside_95"] {
        assert!(json[key].is_number(), "{key} of {json}");
    }
    let same = run(&["compare", "a.exr", "a.exr", "--json"]);
    let json = program::json(&same);
    assert_eq!((json["l1"].as_f64(), json["max_t"].as_f64()), (Some(0.0), Some(0.0)));
    let refused = run(&["compare", "a.exr", "c.exr"]);
    let said = exits(&refused, 3);
    let errors: Vec<&str> = said.lines().filter(|line| line.starts_with("error")).collect();
    assert!(errors.len() == 1 && errors[0].contains("c.exr: no incidence in common"), "{said}");
    assert!(fs::read_dir(&folder).expect("a folder").count() == 3);
}

#[test]
fn the_campaign_of_a_table_says_how_many_realisations_there_are() {
    // Two tables of 2 realisations: 2 degrees of freedom, 95 % limit 4.303: |t| = 4 is inside.
    let text = SMITH.replace("realisations = 8", "realisations = 2");
    let parsed = campaign::parse(&text, "c.toml", std::path::Path::new("")).expect("sound").campaign;
    let (a, b) = (table([1.5, 2.4], [0.3, 0.3]), table([1.0, 4.0], [0.3, 0.3]));
    let side = |table| ComparedTable { campaign: Some(&parsed), ..alone(table) };
    let found = difference(side(&a), side(&b)).expect("one grid");
    assert!(found.figures.max_t.unwrap() > 3.7 && found.figures.share_outside_95 == Some(0.0), "{found:?}");
}

fn source(seed: u64) -> Pcg64Dxsm {
    rng::stream(StreamId { seed, purpose: Purpose::Test, realisation: 0, incidence: 0, block: 0 })
}

/// Bins of one incidence, all of one projected solid angle: edges at equal steps of sin^2 theta.
const ROWS: usize = 10;
const COLUMNS: usize = 20;
const BINS: usize = ROWS * COLUMNS;
/// Standard error of a bin of one table; the value of B is 1.
const SE: f64 = 0.01;

/// A table with mean `value(bin)` and errors of `SE`, and the realisations that it is the mean of.
fn noisy(source: &mut Pcg64Dxsm, count: usize, value: impl Fn(usize) -> f64) -> (BrdfTable, Realisations) {
    let edge = |k: usize| (k as f64 / ROWS as f64).sqrt().asin().to_degrees();
    let scale = SE * (count as f64).sqrt();
    let one: Vec<Vec<f32>> = (0..count)
        .map(|_| (0..BINS).map(|bin| (value(bin) + scale * rng::normal(source)) as f32).collect())
        .collect();
    let of_bin = |bin: usize| one.iter().map(move |values| f64::from(values[bin]));
    let both: Vec<(f64, Option<f64>)> =
        (0..BINS).map(|bin| gonio::stats::mean_and_se(of_bin(bin).collect::<Vec<_>>().into_iter())).collect();
    let total: Vec<f32> = both.iter().map(|(mean, _)| *mean as f32).collect();
    let stderr: Vec<f32> = both.iter().map(|(_, se)| se.expect("several") as f32).collect();
    let small = table([1.0; 2], [0.0; 2]);
    let grid = Grid {
        theta_r_edges_deg: (0..=ROWS).map(edge).collect(),
        phi_r_edges_deg: (0..=COLUMNS).map(|k| 360.0 * k as f64 / COLUMNS as f64).collect(),
        ..small.grid.clone()
    };
    let channels = ColourChannels {
        single: total.clone(),
        multiple: vec![0.0; BINS],
        stderr_single: stderr.clone(),
        total,
        stderr,
        ..ColourChannels::default()
    };
    let parts = one
        .into_iter()
        .map(|values| RealisationPart { total: vec![values.clone()], single: vec![values], schlick: None })
        .collect();
    (BrdfTable { grid, colours: vec![channels], hits: vec![100; BINS], ..small }, Realisations { parts })
}

/// Pairs of tables that a figure is read from.
fn tries() -> usize {
    or_long(50, 200)
}

/// How far a share of 5 % of all tries may be off: four standard deviations, 12 % of 50 tries and 6 % of 200.
fn share_slack() -> f64 {
    4.0 * (0.05 * 0.95 / tries() as f64).sqrt()
}

/// Mean and its error, over `tries()` pairs of tables, of `l1_difference` in units of the sum of the bins' errors, and the
/// shares of its values above the floor, and of its intervals that hold the truth. A is above B by d(bin) errors of the
/// difference, which are sqrt(2) SE; with `split` B's realisations are not known.
fn read_differences(counts: [usize; 2], split: bool, d: impl Fn(usize) -> f64) -> [f64; 4] {
    let mut source = source(11);
    let unit = 2f64.sqrt() * SE;
    let truth = (0..BINS).map(|bin| d(bin).abs()).sum::<f64>() / BINS as f64;
    let (mut values, mut above, mut held) = (Vec::new(), 0, 0);
    for _ in 0..tries() {
        let (a, in_a) = noisy(&mut source, counts[0], |bin| 1.0 + unit * d(bin));
        let (b, in_b) = noisy(&mut source, counts[1], |_| 1.0);
        let side_b = if split { alone(&b) } else { with(&b, &in_b) };
        let found = difference(with(&a, &in_a), side_b).expect("one grid").figures;
        let l1 = found.l1_difference.expect("realisations") / unit;
        above += usize::from(l1 > found.l1_difference_floor.unwrap() / unit);
        let inside = found.l1_difference_low.unwrap()..=found.l1_difference_high.unwrap();
        held += usize::from(inside.contains(&(truth * unit)));
        values.push(l1);
    }
    let (mean, se) = gonio::stats::mean_and_se(values.iter().copied());
    let se = se.expect("many");
    println!("{counts:?}: {mean:.4} +- {se:.4} of {truth:.4}, {held} of {} intervals hold it", tries());
    [mean - truth, se, above as f64 / tries() as f64, held as f64 / tries() as f64]
}

/// Equal counts, groups of two, groups of unequal size. Four errors of the mean, which 50 tries give twice as large as 200.
/// Power: a bias of 0.18 errors of a bin (by 200 tries of 0.09) is seen with probability 0.98, six errors of the mean; intervals
/// that hold the truth in 75 cases of a hundred instead of 95 are seen with probability 0.9.
#[test]
fn a_difference_is_read_without_bias() {
    let d = (2.0 / std::f64::consts::PI).sqrt();
    for counts in [[8, 8], [16, 8], [8, 20]] {
        let [none, se, above, held] = read_differences(counts, false, |_| 0.0);
        assert!(
            none.abs() < 4.0 * se && above <= 0.05 + share_slack() && held >= 0.95 - share_slack(),
            "{counts:?} {none} {above} {held}"
        );
        // In 4 of 200 bins, 20 errors and more each: the sign is right, and nothing is lost, whatever the counts.
        if counts == [8, 8] || is_long() {
            let [few, se, _, held] =
                read_differences(counts, false, |bin| if bin < 4 { 25.0 * d } else { 0.0 });
            assert!(few.abs() < 4.0 * se && held >= 0.95 - share_slack(), "{counts:?} {few} {held}");
        }
        // In all bins, as large as l1_noise: `pull` is off by 14 % at this d (`the_sharpened_sign_is_off_by_no_more_than_is_said`)
        // and Student's t of 7 others by a little.
        let [diffuse, se, _, held] = read_differences(counts, false, |_| d);
        assert!(
            diffuse.abs() < 0.2 * d + 4.0 * se && held >= 0.95 - share_slack(),
            "{counts:?} {diffuse} {se} {held}"
        );
    }
}

#[test]
fn a_table_without_realisations_is_split() {
    // As above: normal noise, the law that the splitting assumes.
    let d = (2.0 / std::f64::consts::PI).sqrt();
    let [none, se, above, _] = read_differences([16, 16], true, |_| 0.0);
    assert!(none.abs() < 4.0 * se && above <= 0.05 + share_slack(), "{none} {se} {above}");
    let [diffuse, se, _, held] = read_differences([16, 16], true, |_| d);
    assert!(diffuse.abs() < 0.2 * d + 4.0 * se && held >= 0.95 - share_slack(), "{diffuse} {held}");
}

#[test]
fn errors_alone_leave_an_interval_and_no_figure() {
    let mut source = source(5);
    let unit = 2f64.sqrt() * SE;
    for d in [0.0, 0.8, 3.0] {
        let (a, _) = noisy(&mut source, 16, |_| 1.0 + unit * d);
        let (b, _) = noisy(&mut source, 16, |_| 1.0);
        let found = difference(alone(&a), alone(&b)).expect("one grid").figures;
        assert!(found.l1_difference.is_none() && found.l1_difference_floor.is_none());
        let (low, high) = (found.l1_difference_low.unwrap() / unit, found.l1_difference_high.unwrap() / unit);
        // The mean of 200 |d + e| scatters by 1/sqrt(200) at most, and l1_noise by less: four of that.
        let slack = 4.0 / (BINS as f64).sqrt();
        assert!(low <= d + slack && d <= high + slack && high - low <= 0.8 + slack, "{d}: {low} {high}");
    }
}
