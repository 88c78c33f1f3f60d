//! Promise: on grains the light is where the geometry puts it: the plane's share in the mirror bin, all paths counted, the
//! same whichever way the list of coverages, the threads or the sample lie.

use gonio::measure::Measured;
use gonio::stats;
use gonio::theory::grains::bare_mirror_flux;

use crate::support::measuring::{hits_of, measured, measured_one, measured_with};

/// A campaign of grains; `surface` is what stands in `[surface.grains]`.
fn text(surface: &str, light: &str, bounces: u32, realisations: u32) -> String {
    format!(
        "name = \"grains\"\nseed = 3\n[surface]\nrealisations = {realisations}\nrotation_deg = 25\n\
         [surface.grains]\n{surface}\n[light]\n{light}\n[sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\n\
         bins = \"aligned\"\n[trace]\nbounces = {bounces}\n[stop]\nsamples = 65_536\n"
    )
}

const BRUSHED: &str = "coverage = 0.5\nalpha_x = 0.2\nalpha_y = 0.6\n";
const TWENTY: &str =
    "theta_i_deg = [7, 23, 42, 61, 78]\nazimuth = \"absolute\"\nphi_i_deg = [0, 33, 77, 140]";

/// Few samples of many patches: the error is that of the patches in any case.
fn of_many_patches(base: &str) -> Measured {
    let text = text(&format!("{BRUSHED}base = \"{base}\""), TWENTY, 1, 48);
    measured_with(&text, |plan| {
        plan.block_starts = 4096;
        plan.samples = 4096;
        plan.total_samples /= 16;
    })
}

/// The same patches and samples, once with a plane that reflects and once with one that does not: what differs is the
/// plane's, all of it in the mirror bin.
#[test]
fn the_bare_plane_is_in_the_mirror_bin() {
    let (mirror, absorbing) = (of_many_patches("mirror"), of_many_patches("absorbing"));
    let grid = &mirror.table.grid;
    for incidence in 0..grid.incidences() {
        let (theta, phi) = grid.incidence_deg(incidence);
        let sizes = grid.sizes(incidence);
        let flux = |measured: &Measured, realisation: usize, bin: usize| {
            let part = &measured.realisations.parts[realisation];
            f64::from(part.single[0][incidence * sizes.len() + bin]) * sizes[bin]
        };
        let mirror_bin = (theta / 5.0) as usize * 36 + ((phi + 180.0) % 360.0 / 10.0) as usize;
        let difference = |k: usize, bin: usize| flux(&mirror, k, bin) - flux(&absorbing, k, bin);
        let parts = mirror.realisations.parts.len();
        for bin in (0..sizes.len()).filter(|&bin| bin != mirror_bin) {
            assert!((0..parts).all(|k| difference(k, bin) == 0.0), "{theta} {phi}: bin {bin}");
        }
        let (mean, se) = stats::mean_and_se((0..parts).map(|k| difference(k, mirror_bin)));
        let w = gonio::sphere::direction_deg(theta, phi - 25.0);
        let expected = bare_mirror_flux(glam::DVec3::new(0.2 * w.x, 0.6 * w.y, w.z), 0.5);
        // Twenty directions at four standard errors: 1 in 800 by chance.
        assert!(
            (mean - expected).abs() < 4.0 * se.expect("48 patches"),
            "{theta} {phi}: {mean} {expected} {se:?}"
        );
    }
}

#[test]
fn every_sample_has_one_fate() {
    for base in ["mirror", "absorbing"] {
        let surface = format!("coverage = 0.9\nalpha = 0.5\nbase = \"{base}\"");
        let measured = measured_one(&text(&surface, "theta_i_deg = [0, 60, 80]", 16, 4));
        for incidence in &measured.incidences {
            let out = incidence.orders.iter().sum::<u64>();
            assert_eq!(out + incidence.cut + incidence.hidden + incidence.absorbed, 4 * 65_536);
            assert_eq!(incidence.absorbed > 0, base == "absorbing");
            let (mean, se) = stats::mean_and_se(incidence.closure.iter().copied());
            // Orders, cut and absorbed light add up to what falls on the patch: in the mean of the samples' positions.
            // Four patches: Student's t at 1e-3 with 3 degrees is 12.9; six values.
            // Rays from above carry all of it, but for rounding.
            assert!((mean - 1.0).abs() < 12.9 * se.expect("four") + 1e-12, "{base}: {mean} {se:?}");
            assert!((mean - 1.0).abs() < 0.01, "{base}: {mean}");
        }
    }
}

#[test]
fn a_coverage_in_a_list_is_measured_as_if_alone() {
    let light = "theta_i_deg = [40]";
    let list = measured(&text("coverage = [0.3, 0.7]\nalpha = 0.5", light, 2, 2));
    let alone = measured_one(&text("coverage = 0.7\nalpha = 0.5", light, 2, 2));
    assert_eq!(list.len(), 2);
    assert_eq!(hits_of(&list[1], 0), hits_of(&alone, 0));
    assert_eq!(list[1].table.campaign, alone.table.campaign);
    assert_ne!(hits_of(&list[0], 0), hits_of(&alone, 0));
}

/// Flattest and steepest, hardly and nearly covered, light along the normal and a hundredth of a degree above the horizon.
/// Among few grains a ray runs 50,000 radii: it must not look at each.
#[test]
fn extremes_end_and_lose_nothing() {
    for alpha in [1e-4, 10.0] {
        for coverage in [1e-4, 0.999] {
            let surface = format!("coverage = {coverage}\nalpha = {alpha}");
            let text = text(&surface, "theta_i_deg = [0, 89.99]", 4, 2);
            let measured = measured_with(&text, |plan| {
                (plan.block_starts, plan.samples) = (4096, 4096);
                plan.total_samples /= 16;
            });
            for incidence in &measured.incidences {
                let ended = incidence.orders.iter().sum::<u64>() + incidence.cut + incidence.hidden;
                assert_eq!(ended, 2 * 4096, "{alpha} {coverage}");
                assert!(incidence.closure.iter().all(|closure| closure.is_finite()), "{alpha} {coverage}");
            }
        }
    }
}
