//! Promise: light that leaves an open map by its edge is never counted as darkness. Every bin that it could have
//! reached has an error bar that covers it, and the flux of all fates adds up.

use gonio::measure::Measured;

use crate::support::measuring::measured_in;

const SIDE: usize = 129;
/// Few samples do: bounds hold for each path.
const SAMPLES: u64 = 16_384;
/// A corner, where no path starts.
const CORNER: (usize, usize) = (2, 3);

/// The table of an open map of SIDE x SIDE heights at a pitch of 1 um.
fn measured(height: impl Fn(f64, f64) -> f64, spike: f64, rest: &str) -> Measured {
    let at = |k: usize| height((k % SIDE) as f64, (k / SIDE) as f64);
    let mut heights: Vec<f64> = (0..SIDE * SIDE).map(at).collect();
    heights[CORNER.1 * SIDE + CORNER.0] += spike;
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut npy = Vec::new();
    gonio::files::npy::encode(&mut npy, &[SIDE, SIDE], heights.into_iter()).expect("an array");
    std::fs::write(folder.path().join("scan.npy"), npy).expect("file");
    let text = format!(
        "name = \"scan\"\nseed = 3\n[surface.file]\npath = \"scan.npy\"\npitch_x_um = 1\npitch_y_um = 1\n\
         height_unit_um = 1\nperiodic = false\ndetrend = \"none\"\ntiles = 2\nrefine = 1\n[sensor.hemisphere]\n{rest}\n\
         [stop]\nsamples = {SAMPLES}\n"
    );
    measured_in(folder.path(), &text).pop().expect("one table")
}

const LIGHT: &str = "[light]\ntheta_i_deg = [0, 60]\nazimuth = \"absolute\"\nphi_i_deg = [0]";

/// A flat map is a mirror: all light arrives in one bin. Under a spike of 1 mm its rays at 60 degrees leave the map
/// below the highest height, on both arms, and all of it is the bin's bound.
#[test]
fn all_light_of_a_mirror_under_a_spike_is_within_one_error_bar() {
    let clean = measured(|_, _| 0.0, 0.0, LIGHT);
    let spiked = measured(|_, _| 0.0, 1000.0, LIGHT);
    let (clean, table) = (&clean.table.colours[0], &spiked.table.colours[0]);
    let bins = spiked.table.grid.bins();
    // Along the normal no ray comes near an edge.
    assert_eq!(table.total[..bins], clean.total[..bins]);
    assert!(table.left_map[..bins].iter().all(|&bound| bound == 0.0));
    let mirror = (bins..2 * bins).find(|&at| clean.total[at] > 0.0).expect("one bin");
    for at in bins..2 * bins {
        assert_eq!(table.total[at], 0.0);
        assert_eq!(table.left_map[at], clean.total[at], "bin {at}");
    }
    // The bound is 1/w and its error bound/sqrt(3); beside it an empty bin's 1.5 hits of 16,384 count for nothing.
    let expected = f64::from(clean.total[mirror]) / 3f64.sqrt();
    let found = f64::from(table.stderr[mirror]);
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    let incidence = &spiked.incidences[1];
    assert_eq!((incidence.left_map, incidence.orders[0]), (4 * SAMPLES, 0));
    // Every path carries its share of 1 in units of 2^-90.
    assert!((incidence.lost_light[1] - 1.0).abs() < 1e-12, "{:?}", incidence.lost_light);
    let (albedo, se) = incidence.total();
    assert_eq!(albedo, Some(0.0));
    assert!((se.expect("covered") - (1.0f64 / 3.0).sqrt()).abs() < 1e-12);
}

/// Smooth waves of rms slope 0.3 or so, in all directions.
fn waves(x: f64, y: f64) -> f64 {
    let wave = |k: i32| {
        let (turn, length) = (f64::from(k) * 1.1, 9.0 + 2.0 * f64::from(k % 5));
        (std::f64::consts::TAU * (x * turn.cos() + y * turn.sin()) / length + 1.7 * f64::from(k)).sin()
    };
    0.2 * (0..12).map(wave).sum::<f64>()
}

/// Paths that cross the edge of the spiked map are those that the clean map follows to their ends, or loses as well:
/// each bin of the clean map lies between the spiked one's value and its bound. Starts keep a quarter of the map from
/// the edge in both cases, for shadows of 75 degrees reach that far. From there the spike, which does incidence some rays, is
/// seen at azimuths of 197 to 252 degrees: those bins are left out, and the light comes from elsewhere.
#[test]
fn what_a_spike_hides_is_within_the_bounds_bin_by_bin() {
    let light = "[light]\ntheta_i_deg = [75, 80]\nazimuth = \"absolute\"\nphi_i_deg = [290]";
    for rest in [light.to_string(), format!("{light}\n[optics]\nmaterial = \"gold\"\n[trace]\nbounces = 3")] {
        // Two steps in a corner make the clean map's starts keep the same distance.
        let clean = measured(waves, 6.0, &rest);
        let spiked = measured(waves, 30.0, &rest);
        let bins = clean.table.grid.bins();
        for (clean, spiked) in clean.table.colours.iter().zip(&spiked.table.colours) {
            let mut hidden = 0;
            for at in (0..clean.total.len()).filter(|at| !(18..=26).contains(&(at % bins % 36))) {
                let (low, bound) = (f64::from(spiked.total[at]), f64::from(spiked.left_map[at]));
                let (value, more) = (f64::from(clean.total[at]), f64::from(clean.left_map[at]));
                // f32 values: sums of two roundings.
                let step = 4.0 * f64::from(f32::EPSILON) * (low + bound);
                assert!(low <= value + more + step, "bin {at}: {low} above {value} + {more}");
                assert!(value <= low + bound + step, "bin {at}: {value} above {low} + {bound}");
                hidden += usize::from(value > 4.0 * low.max(0.01));
                let covered = 1.96 * f64::from(spiked.stderr[at]);
                assert!(value - low <= covered + step, "bin {at}: {value} is not within {low} +- {covered}");
            }
            // The spike does hide light: else this would hold of any table.
            assert!(hidden > bins / 40, "{hidden} of {bins} bins");
        }
    }
}

/// Starts are hidden, leave after some order, go on beyond the last, or leave the map: none has two fates, none has none.
#[test]
fn fates_of_paths_on_an_open_map_add_up() {
    let light = "[light]\ntheta_i_deg = [0, 75]\nazimuth = \"absolute\"\nphi_i_deg = [20]";
    let measured = measured(waves, 30.0, &format!("{light}\n[trace]\nbounces = 4\nby_order = true"));
    for incidence in &measured.incidences {
        let fates =
            incidence.hidden + incidence.orders.iter().sum::<u64>() + incidence.cut + incidence.left_map;
        assert_eq!(fates, incidence.samples * 4);
    }
    assert!(measured.incidences[1].left_map > 0);
}

#[test]
fn a_spiked_map_cannot_be_recoloured_and_says_why() {
    let rest = format!("{LIGHT}\n[optics]\nmaterial = \"gold\"");
    let spiked = measured(waves, 1000.0, &rest);
    let campaign = spiked.table.campaign.clone();
    let refused =
        gonio::table::recolour::recolour(&spiked.table, None, [0.5; 3], campaign).expect_err("refused");
    assert!(refused.to_string().contains("left the map"), "{refused}");
}
