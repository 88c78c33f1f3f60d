//! Promise: on a smooth interface light goes where Snell's law and Fresnel's equations say, from either side, and nowhere
//! else; what hardly refracts goes straight through any surface.

use glam::DVec3;
use gonio::instrument::Sensor;
use gonio::measure::Measured;
use gonio::optics::FacetAngle;
use gonio::optics::fresnel::dielectric::f_dielectric;
use gonio::sphere;
use gonio::stats::{sidak, student_limit};

use crate::support::long::or_long;
use crate::support::measuring::{hits_of, measured};

const ETA: f64 = 1.5;
const SAMPLES: f64 = 16_384.0;

/// Both tables of a smooth interface, the front's first, under light from 8 x 5 directions off the edges of bins.
fn smooth(bounces: u32) -> Vec<Measured> {
    measured(&format!(
        "name = \"interface\"\n[surface.mirror]\n[optics]\nfacet = \"dielectric\"\neta = {ETA}\n\
         [light]\ntheta_i_deg = [3.3, 13.1, 27.7, 39.9, 44.4, 58.8, 71.3, 86.6]\nazimuth = \"absolute\"\n\
         phi_i_deg = [2.2, 77.7, 141.1, 233.3, 311.7]\nside = \"both\"\n[sensor.hemisphere]\nside = \"both\"\n\
         [trace]\nbounces = {bounces}\n[stop]\nsamples = {SAMPLES}\n"
    ))
}

/// Calls `check` with what each bin of each table holds and should hold, and the share of the light that is reflected.
fn each_bin(tables: &[Measured], check: impl Fn(f64, f64, f64)) {
    for (measured, eta) in tables.iter().zip([ETA, 1.0 / ETA]) {
        let grid = &measured.table.grid;
        let sensor = Sensor::new(grid);
        for incidence in 0..grid.incidences() {
            let wi = grid.wi(incidence);
            let angle = FacetAngle { cos: wi.z, sin2: 1.0 - wi.z * wi.z };
            let reflected = f_dielectric(angle, eta).mean();
            let bin_of = |wo: DVec3| {
                let mut found = None;
                sensor.each_bin(wo, |bin| found = Some(bin));
                found.expect("both hemispheres are covered")
            };
            let mut expected = vec![0.0; grid.bins()];
            expected[bin_of(DVec3::new(-wi.x, -wi.y, wi.z))] += reflected;
            let across = (wi.x * wi.x + wi.y * wi.y).sqrt() / eta;
            if across < 1.0 {
                let down = DVec3::new(-wi.x / eta, -wi.y / eta, -(1.0 - across * across).sqrt());
                expected[bin_of(down)] += 1.0 - reflected;
            } else {
                assert_eq!(reflected, 1.0);
            }
            let sizes = grid.sizes(incidence);
            let values = &measured.table.colours[0].total[incidence * grid.bins()..];
            for (bin, expected) in expected.into_iter().enumerate() {
                if expected == 0.0 {
                    assert_eq!(
                        (values[bin], hits_of(measured, incidence)[bin]),
                        (0.0, 0),
                        "incidence {incidence}, bin {bin}"
                    );
                } else {
                    check(f64::from(values[bin]) * sizes[bin], expected, reflected);
                }
            }
        }
    }
}

#[test]
fn smooth_interfaces_follow_snell_and_fresnel_by_chance() {
    // 40 directions from both sides, 4 binomial standard errors, and rounding to f32.
    each_bin(&smooth(2), |found, expected, reflected| {
        let sigma = (reflected * (1.0 - reflected) / SAMPLES).sqrt();
        assert!((found - expected).abs() <= 4.0 * sigma + 2e-7 * expected, "{found} {expected} +- {sigma}");
    });
}

#[test]
fn smooth_interfaces_follow_snell_and_fresnel_without_chance_at_order_1() {
    // f32 values of sums that are exact to 2^-90, times and over the size of a bin.
    each_bin(&smooth(1), |found, expected, _| {
        assert!((found - expected).abs() <= 2e-7 * expected, "{found} {expected}");
    });
}

/// An index of 1 + 2e-15 bends no ray, and reflects none of a facet at more than 1e-7 from grazing: whatever the surface, all light that it sees arrives in the bin straight behind, after
/// any number of facets. Rays below the surface meet the same heights, grains and pits upside down.
#[test]
fn light_goes_straight_through_what_hardly_refracts() {
    let ggx = "cells = 64\ncorrelation_cells = 4\n[surface.ggx]\nalpha = 1.0";
    let grains = "[surface.grains]\ncoverage = 0.7\nalpha = 1.0\nbase = \"mirror\"\nshape = ";
    let [grains, pits] = ["grains", "pits"].map(|shape| format!("{grains}\"{shape}\""));
    let smith = "[surface.smith]\nalpha = 0.7";
    // Five surfaces, three ways, three lights: Sidak's limit at 1 %, 6.9. Power: ten of the errors printed below.
    let limit = student_limit(sidak(0.01, 45), 7);
    let mut largest_se = 0.0f64;
    for surface in [ggx, &grains, &pits, smith, "[surface.v_groove]\nslope = 0.8"] {
        for (bounces, side) in [(64, "front"), (64, "back"), (1, "front")] {
            let tables = measured(&format!(
                "name = \"clear\"\n[surface]\nrealisations = 8\n{surface}\n[optics]\nfacet = \"dielectric\"\n\
                 eta = 1.000000000000002\n[light]\nside = \"{side}\"\ntheta_i_deg = [4, 42, 73]\nazimuth = \"absolute\"\n\
                 phi_i_deg = [33]\n[sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\nside = \"both\"\n[trace]\n\
                 bounces = {bounces}\n[stop]\nsamples = 4096\n"
            ));
            let table = &tables[0].table;
            let sensor = Sensor::new(&table.grid);
            for (incidence, result) in tables[0].incidences.iter().enumerate() {
                let mut behind = None;
                sensor.each_bin(-table.grid.wi(incidence), |bin| behind = Some(bin));
                let values = &table.colours[0].total[incidence * table.grid.bins()..];
                for (bin, &hits) in hits_of(&tables[0], incidence).iter().enumerate() {
                    // At order 1 the reflected part is followed as well, with its share of 1e-30.
                    let dark = if bounces == 1 { values[bin] < 1e-20 } else { hits == 0 };
                    assert!(
                        dark || Some(bin) == behind,
                        "{surface} {side} {incidence}: bin {bin} has {hits}"
                    );
                }
                // The statistical surface leaves heights to chance after each facet: its light goes on for longer.
                assert!(bounces == 1 || result.cut == 0 || surface == smith, "{surface}: {} cut", result.cut);
                let (through, se) = result.total_transmittance();
                let (Some(through), Some(se)) = (through, se) else { panic!("eight realisations") };
                let expected = if bounces == 1 { 0.0..=1.0 } else { 1.0..=1.0 };
                // What a torus shows the light is its area: all lit starts carry 1 up to noise.
                let room = limit * se + 1e-9;
                largest_se = largest_se.max(se);
                assert!(
                    through > expected.start() - room && through < expected.end() + room,
                    "{surface} {side} {incidence}: {through} +- {se}"
                );
            }
        }
    }
    println!("standard errors of the light up to {largest_se:.1e}");
}

#[test]
fn every_path_has_one_fate_for_any_threads() {
    // With all that is asked for, 1e8 paths.
    let samples = or_long(16_384, 2_097_152);
    let text = &format!(
        "name = \"fates\"\n[surface]\nrealisations = 2\ncells = 128\n[surface.ggx]\nalpha = 0.8\n\
                [optics]\nfacet = \"dielectric\"\nmaterials = [\"glass\", \"diamond\"]\n[light]\nside = \"both\"\n\
                theta_i_deg = [20, 80]\n[sensor.hemisphere]\nside = \"both\"\n[trace]\nbounces = 3\n[stop]\n\
                samples = {samples}\n"
    );
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| measured(text))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one.len(), 4, "a table for each material and side of the light");
    for (one, three) in one.iter().zip(&three) {
        assert!(one.table == three.table && one.realisations == three.realisations);
        for incidence in &one.incidences {
            let out: u64 = incidence.orders.iter().chain(&incidence.through).sum();
            // Three colours of two materials from two sides: twelve paths of each start.
            assert_eq!(
                out + incidence.hidden + incidence.cut + incidence.left_map + incidence.absorbed,
                2 * samples * 12
            );
            for (colour, orders) in [(0, &incidence.orders), (1, &incidence.through)] {
                assert!(orders.iter().all(|&count| count > 0), "{colour}: {orders:?}");
            }
        }
    }
    // Blue light is bent more than red: its colours are paths of their own.
    let [red, .., blue] = &one[0].table.colours[..] else { panic!("three colours") };
    assert_ne!(red.single, blue.single);
    let azimuth = sphere::phi(one[0].table.grid.wi(0));
    assert_eq!(azimuth, 0.0);
}
