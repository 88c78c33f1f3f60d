//! Promise: clear facets of explicit heights lose no light: from either side all that they see is reflected, transmitted or
//! still on its way, to the last path, at order 1 and at all orders; and what goes through goes back.

use gonio::measure::Measured;
use gonio::stats::{mean_and_se, sidak, student_limit};
use gonio::table::RealisationPart;

use crate::support::measuring::measured;

const ETA: f64 = 1.5;
const SAMPLES: u64 = 16_384;
const LAWS: [&str; 2] = ["ggx", "beckmann"];

/// Light and sensor as `arms` has them.
fn glass(law: &str, (bounces, realisations): (u32, u64), arms: &str) -> Vec<Measured> {
    measured(&format!(
        "name = \"furnace\"\n[surface]\nrealisations = {realisations}\ncells = 64\ncorrelation_cells = 4\n\
         [surface.{law}]\nalpha = 0.6\n[optics]\nfacet = \"dielectric\"\neta = {ETA}\n{arms}\n[trace]\n\
         bounces = {bounces}\n[stop]\nsamples = {SAMPLES}\n"
    ))
}

#[test]
fn rough_glass_of_heights_loses_no_light() {
    const REALISATIONS: u64 = 4;
    // Two laws, both sides and two lights: Sidak's limit at 1 %.
    let limit = student_limit(sidak(0.01, 8), REALISATIONS as usize - 1);
    let arms = "[light]\ntheta_i_deg = [10, 70]\nside = \"both\"\n[sensor.hemisphere]\nside = \"both\"\n\
                theta_r_bins = 6\nphi_r_bins = 8";
    for law in LAWS {
        let (once, all) = (glass(law, (1, REALISATIONS), arms), glass(law, (64, REALISATIONS), arms));
        let incidences = all[0].incidences.len();
        for incidence in 0..incidences {
            // What comes out of both sides, half of the light from each, and what has not: the light that was seen.
            let leaves = |table: &Measured| {
                let [reflected, transmitted] =
                    [table.incidences[incidence].total(), table.incidences[incidence].total_transmittance()]
                        .map(|known| known.0);
                reflected.expect("seen") + transmitted.expect("seen")
            };
            let found = 0.5 * all.iter().map(leaves).sum::<f64>();
            let result = &all[0].incidences[incidence];
            let seen = mean_and_se(result.closure.iter().copied()).0;
            // Flux of a path over the mean flux of those that are seen: below 2 on a torus of any patch.
            let cut = result.cut as f64 / (2 * REALISATIONS * SAMPLES - result.hidden) as f64;
            assert!(
                (seen - found).abs() <= 2.0 * cut + 1e-12,
                "{law}, incidence {incidence}: {found} of {seen}"
            );
        }
        for (side, (once, all)) in once.iter().zip(&all).enumerate() {
            for (incidence, (once, all)) in once.incidences.iter().zip(&all.incidences).enumerate() {
                let place = format!("{law}, side {side}, incidence {incidence}");
                // Of each start one from either side, counted together.
                let paths = 2 * REALISATIONS * SAMPLES;
                // One fate each; at order 1 both parts of the light have theirs. A path that is lost ends the run.
                let out = |incidence: &gonio::measure::IncidenceResult| -> u64 {
                    incidence.orders.iter().chain(&incidence.through).sum()
                };
                assert_eq!(out(once) + once.cut + once.hidden, 2 * paths, "{place}");
                assert_eq!(out(all) + all.cut + all.hidden, paths, "{place}");
                assert_eq!((once.hidden, once.left_map, all.absorbed), (2 * all.hidden, 0, 0), "{place}");
                // 64 facets leave few on their way: light that is trapped by total reflection finds its way out of waves of
                // this slope within some ten.
                assert!(all.cut * 10_000 < paths, "{place}: {} of {paths}", all.cut);
                for (&first, &last) in once.closure.iter().zip(&all.closure) {
                    // The same starts under the same shadows, and shares of the flux that add up to it to 2^-90.
                    assert!((first - last).abs() < 1e-13, "{place}: {first} {last}");
                }
                // What a torus shows the light is its area: all that is seen is 1, up to noise.
                let (mean, se) = mean_and_se(all.closure.iter().copied());
                assert!((mean - 1.0).abs() < limit * se.expect("four") + 1e-9, "{place}: {mean} +- {se:?}");
            }
        }
    }
}

/// At order 1, masking and shadowing included: pairs of cones across the interface.
#[test]
fn light_through_heights_is_reciprocal() {
    const REALISATIONS: u64 = 8;
    let (outside, inside) = ("[20, 50]", "[15, 32]");
    let arms = |side: &str, light: &str, sensor: &str| {
        format!(
            "[light]\nside = \"{side}\"\ntheta_i_deg = {light}\naperture_deg = 9\naverage_azimuth = true\n[sensor.arm]\n\
             theta_r_deg = {sensor}\nphi_r_deg = [0]\naperture_deg = 9"
        )
    };
    let value =
        |part: &RealisationPart, [incidence, bin]: [usize; 2]| f64::from(part.total[0][2 * incidence + bin]);
    let mut all = Vec::new();
    for law in LAWS {
        let table = |side: &str, light: &str, sensor: &str| {
            let table = glass(law, (1, REALISATIONS), &arms(side, light, sensor)).pop();
            table.expect("one table").realisations.parts
        };
        // Negative angles lie across from the light, where refracted light goes.
        let front = table("front", outside, "[-165, -148]");
        let back = table("back", inside, "[-160, -130]");
        for (i, o) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let pairs = front.iter().zip(&back);
            let off = pairs.map(|(there, again)| value(there, [i, o]) / (ETA * ETA) - value(again, [o, i]));
            let (mean, se) = mean_and_se(off);
            all.push((mean / se.expect("eight realisations")).abs());
        }
    }
    let limit = student_limit(sidak(0.01, all.len()), REALISATIONS as usize - 1);
    let worst = all.iter().copied().fold(0.0, f64::max);
    assert!(worst < limit, "{worst} {limit}");
}
