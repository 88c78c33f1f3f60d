//! Promise: surfaces of layered facets reflect what their closed forms and the theory say, lose nothing where the base is
//! white, are reciprocal, and become matt ones or mirrors where a part of the facet goes away.

use std::f64::consts::TAU;

use gonio::instrument::{Region, Sensor};
use gonio::measure::Measured;
use gonio::optics::layered::{Interface, base_reflectance, transmittance};
use gonio::stats::{mean_and_se, sidak, student_limit};
use gonio::validate::Prediction;

use crate::support::measuring::measured;

const SAMPLES: f64 = 8192.0;
const SMITH: &str = "[surface.smith]\nalpha = 0.5";
const ONCE: &str = "bounces = 1";

fn one(surface: &str, optics: &str, trace: &str) -> Measured {
    let text = format!(
        "name = \"layered\"\nseed = 5\n[surface]\nrealisations = 16\n{surface}\n[optics]\n{optics}\n[light]\n\
         theta_i_deg = [3.3, 42, 71]\nazimuth = \"absolute\"\nphi_i_deg = [2.2]\n[sensor.hemisphere]\n\
         theta_r_bins = 9\nphi_r_bins = 12\nbins = \"aligned\"\n[trace]\nfold = false\n{trace}\n[stop]\nsamples = {SAMPLES}\n"
    );
    measured(&text).pop().expect("one table")
}

fn layered(eta: f64, albedo: &str) -> String {
    format!("facet = \"layered\"\neta = {eta}\nalbedo = {albedo}")
}

/// Flux of order 1 into each bin, by incidence and bin.
fn fluxes(measured: &Measured, colour: usize) -> Vec<Vec<f64>> {
    let grid = &measured.table.grid;
    let values = measured.table.colours[colour].single.chunks(grid.bins());
    let of = |(incidence, values): (usize, &[f32])| {
        grid.sizes(incidence).iter().zip(values).map(|(size, &value)| size * f64::from(value)).collect()
    };
    values.enumerate().map(of).collect()
}

/// Paths of one incidence.
fn paths(measured: &Measured) -> f64 {
    measured.realisations.parts.len() as f64 * SAMPLES
}

/// Light at theta from a flat facet: F mirrored, T(theta) rho_e/(1 - F_de) times the integral of 2 c T(c) dc over the bin
/// and its share of the azimuth from the base.
#[test]
fn a_flat_layered_surface_meets_its_closed_form() {
    for eta in [1.2, 1.5, 3.0] {
        let albedos = [1.0, 0.5, 0.0];
        let measured = one("[surface.mirror]", &layered(eta, "[1.0, 0.5, 0.0]"), ONCE);
        let (grid, n) = (&measured.table.grid, SAMPLES);
        let prediction = Prediction::of(&measured.campaign, grid).expect("a model");
        assert_eq!(prediction.model.name(), "layered");
        for (colour, albedo) in albedos.into_iter().enumerate() {
            let base = base_reflectance(albedo, eta);
            for (incidence, found) in fluxes(&measured, colour).iter().enumerate() {
                let wi = grid.wi(incidence);
                let (through, mirror) = (transmittance(wi.z, eta), glam::DVec3::new(-wi.x, -wi.y, wi.z));
                let interface = Interface::new(eta);
                let mut mirrors_at = None;
                Sensor::new(grid).each_bin(mirror, |bin| mirrors_at = Some(bin));
                for (bin, (&found, region)) in found.iter().zip(grid.regions(incidence)).enumerate() {
                    let Region::Rectangle { theta, phi } = region else { panic!("a hemisphere") };
                    // Midpoints in the cosine: second order in 1/400 of a bin.
                    let (low, high) = (theta[1].cos(), theta[0].cos());
                    let at = |k: i32| low + (high - low) * (f64::from(k) + 0.5) / 400.0;
                    let mean =
                        (0..400).map(|k| 2.0 * at(k) * interface.weight(wi.z, at(k))).sum::<f64>() / 400.0;
                    let share = (high - low) * mean * (phi[1] - phi[0]) / TAU;
                    let mirrors = mirrors_at == Some(bin);
                    let expected = base * share + if mirrors { 1.0 - through } else { 0.0 };
                    let theory =
                        prediction.means[incidence].values[0][colour][bin] * region.projected_solid_angle();
                    assert!((theory - expected).abs() < 1e-6, "{eta} {incidence} {bin}: {theory} {expected}");
                    // Binomial, and no more than the base's share where it weighs less; 5 standard errors, f32.
                    let q = if mirrors { 1.0 - through } else { share };
                    let se = (q.min(1.0 - q) / n).sqrt().max(1.0 / n);
                    assert!(
                        (found - expected).abs() < 5.0 * se + 1e-6,
                        "{eta} {incidence} {bin}: {found} {expected}"
                    );
                }
                let total: f64 = found.iter().sum();
                let expected = (1.0 - through) + base * through;
                // Each path weighs 1 or `base`.
                let se = (1.0 - base) * (through * (1.0 - through) / n).sqrt();
                assert!((total - expected).abs() < 4.5 * se + 1e-6, "{eta} {incidence}: {total} {expected}");
            }
        }
    }
}

#[test]
fn a_statistical_layered_surface_reflects_what_theory_says() {
    let of = |heights: &str| {
        one(&format!("{SMITH}\nheights = \"{heights}\""), &layered(1.5, "[0.8, 0.3, 0.0]"), ONCE)
    };
    let [correlated, independent] = ["correlated", "independent"].map(of);
    // The model has the maskings of both, whatever the heights.
    let prediction = Prediction::of(&correlated.campaign, &correlated.table.grid).expect("a model");
    for (heights, measured) in [("correlated", correlated), ("independent", independent)] {
        let masking = if heights == "correlated" { "height_correlated" } else { "separable" };
        let at = prediction.model.masking_index(Some(masking));
        let n = paths(&measured);
        for colour in 0..3 {
            for (incidence, found) in fluxes(&measured, colour).iter().enumerate() {
                let sizes = measured.table.grid.sizes(incidence);
                let theory = &prediction.means[incidence].values[at][colour];
                let (mut total, mut expected) = (0.0, 0.0);
                for (bin, ((found, size), value)) in found.iter().zip(sizes).zip(theory).enumerate() {
                    let wanted = size * value;
                    // Weights are at most 1: the variance is at most that of a count. 5.5 standard errors, one arrival.
                    let room = 5.5 * (wanted / n).sqrt() + 2.0 / n;
                    assert!(
                        (found - wanted).abs() < room,
                        "{heights} {colour} {incidence} {bin}: {found} {wanted}"
                    );
                    (total, expected) = (total + found, expected + wanted);
                }
                // 4.5 standard errors of a share of weights up to 1.
                assert!(
                    (total - expected).abs() < 4.5 * (0.25 / n).sqrt(),
                    "{colour} {incidence}: {total} {expected}"
                );
            }
        }
    }
}

/// A white base loses nothing: what the light sees leaves, all orders together, on whatever surface.
#[test]
fn a_white_base_sends_all_light_back() {
    let ggx = "cells = 64\ncorrelation_cells = 4\n[surface.ggx]\nalpha = 0.7";
    let pits = "[surface.grains]\ncoverage = 0.7\nalpha = 0.7\nbase = \"mirror\"\nshape = \"pits\"";
    for surface in [SMITH, ggx, pits, "[surface.v_groove]\nslope = 0.8"] {
        let measured = one(surface, &layered(1.5, "1.0"), "bounces = 200");
        for (incidence, result) in measured.incidences.iter().enumerate() {
            let (mean, se) = mean_and_se(result.closure.iter().copied());
            let (total, total_se) = result.total();
            let (total, total_se) = (total.expect("seen"), total_se.expect("sixteen realisations"));
            // What a surface shows the light is its area up to noise; of 1e6 paths a few tens are still in pits of GGX heights.
            let cut = result.cut as f64 / paths(&measured);
            assert!((mean - 1.0).abs() < 5.0 * se.expect("sixteen") + 1e-9, "{surface} {incidence}: {mean}");
            assert!(
                (total - 1.0).abs() < 3.5 * total_se + cut + 1e-7,
                "{surface} {incidence}: {total} +- {total_se}"
            );
            assert!(cut < 1e-4, "{surface}: {cut} not out");
            // Every path has one fate.
            let out: u64 = result.orders.iter().sum();
            let all = out + result.hidden + result.cut + result.left_map + result.absorbed;
            assert_eq!((all as f64, result.through.len()), (paths(&measured), 0));
        }
    }
}

#[test]
fn a_black_base_leaves_the_mirror_and_no_interface_the_matt_facet() {
    let close = |a: &Measured, b: &Measured, what: &str| {
        let n = paths(a);
        for (incidence, (a, b)) in a.incidences.iter().zip(&b.incidences).enumerate() {
            for (order, (a, b)) in a.albedo_by_order.iter().zip(&b.albedo_by_order).enumerate() {
                let (a, b) = (mean_and_se(a.iter().copied()).0, mean_and_se(b.iter().copied()).0);
                // Weights up to 1 on either side: 5 standard errors of a difference of two shares, and an arrival.
                let room = 5.0 * (2.0 * b / n).sqrt() + 4.0 / n;
                assert!((a - b).abs() < room, "{what} {incidence} {order}: {a} {b}");
            }
        }
        for (incidence, (a, b)) in fluxes(a, 0).iter().zip(fluxes(b, 0)).enumerate() {
            for (bin, (a, b)) in a.iter().zip(b).enumerate() {
                let room = 5.5 * (2.0 * a.max(b) / n).sqrt() + 4.0 / n;
                assert!((a - b).abs() < room, "{what} {incidence} {bin}: {a} {b}");
            }
        }
    };
    let trace = "bounces = 6\nby_order = true";
    let exact = one(SMITH, "eta = 1.5\nfresnel = \"exact\"", trace);
    close(&one(SMITH, &layered(1.5, "0.0"), trace), &exact, "black");
    let glass = one(SMITH, "facet = \"dielectric\"\neta = 1.5", ONCE);
    close(&one(SMITH, &layered(1.5, "0.0"), ONCE), &glass, "clear");
    let matt = one(SMITH, "facet = \"diffuse\"\nalbedo = 0.6", trace);
    close(&one(SMITH, &layered(1.000_000_1, "0.6"), trace), &matt, "matt");
}

/// 48 pairs of equal apertures, all orders up to 4: two polar angles, and the azimuth between them, over the light's eight
/// azimuths together. Wide apertures: four times the arrivals of those of half the angle.
///
/// Power: a pair that is off by its limit, 5.9, and three more of its standard errors (both are printed) is seen.
#[test]
fn layered_surfaces_are_reciprocal() {
    let angles = [10.0, 30.0, 50.0, 70.0];
    let azimuths: Vec<f64> = (0..8).map(|k| 45.0 * f64::from(k)).collect();
    let text = format!(
        "name = \"pairs\"\n[surface]\nrealisations = 8\n[surface.smith]\nalpha = 0.6\n[optics]\n{}\n[light]\n\
         theta_i_deg = {angles:?}\naperture_deg = 12\nazimuth = \"absolute\"\nphi_i_deg = {azimuths:?}\n[sensor.arm]\n\
         theta_r_deg = {angles:?}\nphi_r_deg = {azimuths:?}\nphi_r_from = \"sample\"\naperture_deg = 12\n[trace]\n\
         bounces = 4\n[stop]\nsamples = 4096\n",
        layered(1.5, "0.7")
    );
    let table = measured(&text).pop().expect("one table");
    let bins = table.table.grid.bins();
    let (mut all, mut errors) = (Vec::new(), Vec::new());
    for (i, o, k) in (0..128).map(|n| (n / 32, n / 8 % 4, n % 8)).filter(|&(i, o, _)| i < o) {
        // There and back again, sums over the azimuths of the light.
        let both = |part: &gonio::table::RealisationPart| {
            (0..8).fold([0.0; 2], |[there, again], j| {
                let (a, b) = (8 * i + j, 8 * o + (j + k) % 8);
                let value = |incidence: usize, bin: usize| f64::from(part.total[0][incidence * bins + bin]);
                [there + value(a, b), again + value(b, a)]
            })
        };
        let parts: Vec<[f64; 2]> = table.realisations.parts.iter().map(both).collect();
        let (mean, se) = mean_and_se(parts.iter().map(|[there, again]| there - again));
        let se = se.expect("eight realisations");
        all.push((mean / se).abs());
        errors.push(se / mean_and_se(parts.iter().map(|[there, _]| *there)).0);
    }
    let limit = student_limit(sidak(0.01, all.len()), 7);
    let worst = all.iter().copied().fold(0.0, f64::max);
    let [least, most] = [f64::min, f64::max].map(|of| errors.iter().copied().fold(errors[0], of));
    println!("largest |t| {worst:.2} of {limit:.2}, errors of {least:.4} to {most:.4}");
    assert!(all.len() == 48 && worst < limit, "{worst} {limit}");
}

#[test]
fn layered_tables_are_the_same_for_any_threads_and_lanes() {
    let text = "name = \"fates\"\n[surface]\nrealisations = 2\ncells = 64\n[surface.ggx]\nalpha = 0.8\n[optics]\n\
                facet = \"layered\"\nmaterial = \"plastic\"\nalbedo = [0.9, 0.5, 0.1]\n[light]\ntheta_i_deg = [20, 80]\n\
                [sensor.hemisphere]\n[trace]\nbounces = 3\n[stop]\nsamples = 131072\n";
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| measured(text))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one.len(), 1);
    assert!(one[0].table == three[0].table && one[0].realisations == three[0].realisations);
    // One path for all colours: a brighter base is brighter in every bin that any light reaches.
    let [red, green, blue] = &one[0].table.colours[..] else { panic!("three colours") };
    for (red, (green, blue)) in red.total.iter().zip(green.total.iter().zip(&blue.total)) {
        assert!(red >= green && green >= blue, "{red} {green} {blue}");
    }
}
