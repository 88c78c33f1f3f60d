//! Promise: gaps, outliers and form of a scan, once prepared, leave the table of the clean sample within its error bars.

use std::path::Path;

use glam::DVec3;
use gonio::campaign::{self, Detrend, Gaps, HeightMap, Outliers, Preparation, SurfaceKind};
use gonio::measure::Measured;
use gonio::surface::Heightfield;
use gonio::surface::io::import::{ImportedMap, load};
use gonio::surface::io::prepare::cell_mask::CellMask;
use gonio::trace::{AreaSampler, Window};

use crate::support::arrays::npy;
use crate::support::measuring::{measured_in, test_rng};

const SIDE: usize = 161;

/// Forty waves of 9 to 30 samples in all directions: rms height about 0.6, rms slope about 0.3.
fn rough() -> Vec<f64> {
    let waves: Vec<[f64; 3]> = (0..40)
        .map(|k| {
            let (turn, length) = (2.4 * f64::from(k), 9.0 + 21.0 * (f64::from(k) * 0.618).fract());
            let number = std::f64::consts::TAU / length;
            [number * turn.cos(), number * turn.sin(), 7.0 * f64::from(k)]
        })
        .collect();
    let height = |k: usize| {
        let (x, y) = ((k % SIDE) as f64, (k / SIDE) as f64);
        waves.iter().map(|[a, b, phase]| 0.13 * (a * x + b * y + phase).sin()).sum()
    };
    (0..SIDE * SIDE).map(height).collect()
}

/// The same with blots and single samples without data, 2 % in all, and five spikes.
fn damaged() -> Vec<f64> {
    let mut heights = rough();
    for (k, height) in heights.iter_mut().enumerate() {
        let (x, y) = ((k % SIDE) as f64, (k / SIDE) as f64);
        let blots = [(40.0, 50.0, 7.0), (120.0, 30.0, 6.0), (90.0, 120.0, 5.0)];
        if blots.iter().any(|(cx, cy, radius)| (x - cx).hypot(y - cy) < *radius) || k % 151 == 3 {
            *height = f64::NAN;
        }
    }
    for (k, spike) in [(9_000, 8.0), (3_000, -9.0), (20_000, 12.0), (15_111, 7.0), (22_222, -30.0)] {
        heights[k] += spike;
    }
    heights
}

fn campaign_text(keys: &str) -> String {
    format!(
        "name = \"scan\"\nseed = 5\n[surface.file]\npath = \"scan.npy\"\npitch_x_um = 1\npitch_y_um = 1\nheight_unit_um = 1\n\
         tiles = 4\n{keys}\n[light]\ntheta_i_deg = [0, 40]\nazimuth = \"absolute\"\nphi_i_deg = [0]\n\
         [sensor.hemisphere]\ntheta_r_bins = 9\nphi_r_bins = 18\n[stop]\nsamples = 16384\n"
    )
}

fn table(heights: &[f64], keys: &str) -> Measured {
    let folder = tempfile::tempdir().expect("temporary folder");
    std::fs::write(folder.path().join("scan.npy"), npy(heights, SIDE)).expect("file");
    measured_in(folder.path(), &campaign_text(keys)).pop().expect("one table")
}

/// Differences of bins over their errors. Both tables have 16 groups, so that |t| above 3 has 0.5 % for each; the tables share most
/// of their surface, so that fewer are that far apart.
#[test]
fn a_scan_with_gaps_and_spikes_gives_the_table_of_the_clean_one() {
    let missing = damaged().iter().filter(|height| height.is_nan()).count() as f64;
    assert!((missing / (SIDE * SIDE) as f64 - 0.02).abs() < 0.002, "{missing}");
    let clean = table(&rough(), "");
    let colour = |measured: &Measured| {
        let colour = &measured.table.colours[0];
        (colour.total.clone(), colour.stderr.clone())
    };
    let (wanted, wanted_error) = colour(&clean);
    let far = |found: &Measured| {
        let (total, error) = colour(found);
        let mut compared = 0;
        let mut far = 0;
        for k in 0..total.len() {
            let error = f64::from(error[k]).hypot(f64::from(wanted_error[k]));
            if error > 0.0 && wanted[k] > 0.0 {
                compared += 1;
                far += usize::from(f64::from((total[k] - wanted[k]).abs()) > 3.0 * error);
            }
        }
        assert!(compared > 100, "{compared}");
        far as f64 / compared as f64
    };
    for keys in [
        "gaps = \"interpolate\"\noutliers = \"fill\"",
        "gaps = \"exclude\"\noutliers = \"exclude\"",
        "gaps = \"exclude\"\noutliers = \"fill\"",
    ] {
        let found = far(&table(&damaged(), keys));
        assert!(found <= 0.005, "{keys}: {found} of the bins are beyond three errors");
    }
    // The least of the five spikes is 7 high, where the scan is a few of its Sq of 0.6 high: what is left in shows.
    let range = |outliers: Outliers| {
        let preparation = Preparation { gaps: Gaps::Interpolate, outliers, ..Preparation::default() };
        let (low, high) =
            imported(&damaged(), |map| HeightMap { preparation, ..map }).expect("sound").field.range();
        high - low
    };
    assert!(range(Outliers::Keep) > 30.0 && range(Outliers::Fill) < 7.0);
}

fn map(path: &Path) -> HeightMap {
    HeightMap {
        path: "scan.npy".into(),
        resolved_path: path.to_path_buf(),
        channel: None,
        pitch_x_um: Some(1.0),
        pitch_y_um: Some(1.0),
        height_unit_um: Some(1.0),
        periodic: false,
        detrend: Detrend::None,
        refine: Some(1),
        tiles: 4,
        preparation: Preparation::default(),
    }
}

fn imported(heights: &[f64], change: impl Fn(HeightMap) -> HeightMap) -> Result<ImportedMap, String> {
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join("scan.npy");
    std::fs::write(&path, npy(heights, SIDE)).expect("file");
    load(&change(map(&path))).map_err(|why| why.to_string())
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    f64::sqrt(sum / count)
}

/// What is left of the roughness is what the same fit leaves of it alone, to 1e-3 of Sq: the forms are 10 to 1000 times as high.
#[test]
fn tilt_ball_and_cylinder_are_taken_off_to_a_thousandth_of_sq() {
    let at = |k: usize| ((k % SIDE) as f64 - 71.0, (k / SIDE) as f64 - 93.0);
    let ball = |k: usize| {
        let (x, y) = at(k);
        f64::sqrt(300.0f64.powi(2) - x * x - y * y)
    };
    // Its axis rises by 0.05: what is a circle across it is higher by 1/cos of that in the vertical.
    let cylinder = |k: usize| {
        let (x, y) = at(k);
        let (along, across) = (0.6 * x + 0.8 * y, 0.8 * x - 0.6 * y);
        0.05 * along - f64::sqrt((1.0 + 0.05 * 0.05) * (250.0f64.powi(2) - across * across))
    };
    let tilt = |k: usize| 0.3 * at(k).0 - 0.1 * at(k).1;
    let bowl = |k: usize| 1e-3 * at(k).0.powi(2) - 2e-5 * at(k).1.powi(3) + 0.2 * at(k).0;
    let forms: [(Detrend, &dyn Fn(usize) -> f64); 4] = [
        (Detrend::Plane, &tilt),
        (Detrend::Sphere, &ball),
        (Detrend::Cylinder, &cylinder),
        (Detrend::Polynomial(3), &bowl),
    ];
    for (detrend, form) in forms {
        // What an axis of free azimuth takes of the roughness besides depends on the form: there is little of it then.
        let scale = if detrend == Detrend::Cylinder { 1e-3 } else { 1.0 };
        let flat: Vec<f64> = rough().iter().map(|height| scale * height).collect();
        let alone = imported(&flat, |map| HeightMap { detrend, ..map }).expect("sound");
        let with_form: Vec<f64> = flat.iter().enumerate().map(|(k, height)| height + form(k)).collect();
        let found = imported(&with_form, |map| HeightMap { detrend, ..map }).expect("sound");
        let pairs = || alone.field.heights().iter().zip(found.field.heights());
        let (off, sq) = (rms(pairs().map(|(a, b)| a - b)), rms(pairs().map(|(a, _)| *a)) / scale);
        assert!(off < 1e-3 * sq && sq > 0.5, "{detrend:?}: {off} of {sq}; {:?}", found.notes);
    }
}

#[test]
fn each_step_says_what_it_did_and_what_it_lacks() {
    let all = Preparation {
        gaps: Gaps::Exclude,
        outliers: Outliers::Fill,
        s_filter_um: Some(2.5),
        l_filter_um: Some(80.0),
    };
    let found = imported(&damaged(), |map| HeightMap { detrend: Detrend::Sphere, preparation: all, ..map });
    let notes = found.expect("sound").notes.join("\n");
    for said in [
        "outliers (5) far off the median of what is around them",
        "at row 138, column 4",
        "494 of 25921 samples (1.91 %) have no data",
        "filled by a harmonic surface, and no path starts near them",
        "cells (",
        "sphere of radius",
        "S-filter: Gaussian (ISO 16610-61), waves of 2.5 um pass by half",
        "L-filter: Gaussian (ISO 16610-61), waves of 80 um pass by half",
    ] {
        assert!(notes.contains(said), "{said}: {notes}");
    }
    let with = |preparation: Preparation, change: fn(HeightMap) -> HeightMap| {
        imported(&damaged(), |map| change(HeightMap { preparation, ..map })).expect_err("must be refused")
    };
    let refused = with(Preparation::default(), |map| map);
    assert!(refused.contains("(494 such of 25921): set surface.file.gaps"), "{refused}");
    let filled = Preparation { gaps: Gaps::Interpolate, ..Preparation::default() };
    let periodic = with(filled, |map| HeightMap { periodic: true, detrend: Detrend::Sphere, ..map });
    assert!(periodic.contains("periodic and has no form: set surface.file.detrend"), "{periodic}");
    let short = with(Preparation { s_filter_um: Some(1.5), ..filled }, |map| map);
    assert!(short.contains("s_filter_um = 1.5: must be between two samples, 2.0000, and"), "{short}");
    let long = with(Preparation { l_filter_um: Some(500.0), ..filled }, |map| map);
    assert!(long.contains("the map's shorter side, 161.0000"), "{long}");
    let mostly_gaps: Vec<f64> =
        rough().iter().enumerate().map(|(k, h)| if k % 3 > 0 { f64::NAN } else { *h }).collect();
    let why =
        imported(&mostly_gaps, |map| HeightMap { preparation: filled, ..map }).expect_err("mostly gaps");
    assert!(why.contains("17280 of 25921 samples have no data, more than half"), "{why}");
}

#[test]
fn keys_of_the_preparation_are_checked_with_their_range() {
    let faults = |keys: &str| match campaign::parse(campaign_text(keys), "c.toml", Path::new("")) {
        Ok(_) => panic!("{keys} is taken"),
        Err(why) => why.to_string(),
    };
    for (keys, said) in [
        ("gaps = \"fill\"", "must be \"refuse\" or \"interpolate\" or \"exclude\""),
        ("outliers = 3", "must be a string"),
        ("detrend = \"ball\"", "\"sphere\" or \"cylinder\""),
        ("degree = 3", "belongs to detrend = \"polynomial\""),
        ("detrend = \"polynomial\"\ndegree = 11", "must be a whole number in [2, 10]"),
        ("s_filter_um = 0", "s_filter_um"),
        ("s_filter_um = 8\nl_filter_um = 8", "must be above s_filter_um = 8"),
        ("channel = \"\"", "must be a title, a number or a channel's name"),
        ("channel = -1", "must be a title, a number or a channel's name"),
        ("channel = true", "must be a title, a number or a channel's name"),
    ] {
        let found = faults(keys);
        assert!(found.contains(said), "{keys}: {found}");
    }
    // A number names a channel with its quotes and without.
    for keys in ["channel = 0", "channel = \"0\""] {
        let campaign = campaign::parse(campaign_text(keys), "c.toml", Path::new("")).expect(keys).campaign;
        match &campaign.surface.kind {
            SurfaceKind::File(map) => assert_eq!(map.channel.as_deref(), Some("0"), "{keys}"),
            other => panic!("{keys}: {other:?}"),
        }
    }
}

/// A level field shows each cell alike: the samples of a block on what is left, and a flux of exactly 1 over all of them.
#[test]
fn excluded_cells_have_no_samples_and_no_area() {
    let field = Heightfield::new(32, 32, false, vec![0.0; 33 * 33]);
    let mut marked = vec![false; 33 * 33];
    (marked[5 * 33 + 7], marked[20 * 33 + 32]) = (true, true);
    let mask = CellMask::around(&marked, 33, false);
    let window = Window { x: (2, 32), y: (1, 30) };
    let light = DVec3::new(0.6, 0.0, 0.8);
    let starts = AreaSampler::outside(&field, window, light, Some(&mask));
    assert_eq!(window.cells_outside(Some(&mask)), 30 * 29 - 16 - 8);
    let count = 20_000;
    let (mut visited, mut cells) = (0, std::collections::BTreeSet::new());
    starts.each(count, &mut test_rng(3), |start| {
        let (x, y) = (start.facet.x, start.facet.y);
        assert!(!mask.holds(x, y) && (2..32).contains(&x) && (1..30).contains(&y), "{x} {y}");
        visited += 1;
        cells.insert((x, y));
    });
    assert_eq!((visited, cells.len()), (count, 30 * 29 - 24));
    approx::assert_relative_eq!(starts.flux_fraction(count) * count as f64, 1.0, max_relative = 1e-12);
}
