//! Promise: a fit returns the parameters of what it is given, with errors that hold, and ranks the right model first.

use std::fs;

use glam::DVec3;
use gonio::fit::nodes::{IncidenceNodes, Lobe};
use gonio::fit::{self, Fit, FitData, FitLaw, FitSample, MicrofacetLaw};
use gonio::instrument::{Grid, GridKind, Region};
use gonio::measure::Measured;
use gonio::sphere;
use gonio::stats;
use gonio::table::{BrdfTable, ColourChannels};
use gonio::theory::{Masking, Microfacet, Ndf, cavities, empirical};
use gonio::validate::BinMeans;

use crate::support::measuring::measured_one;
use crate::support::program::{self, exits, gonio, stdout};

fn grid(theta_i_deg: &[f64], phi_i_deg: &[f64], relative: bool) -> Grid {
    let edges = |count: u32, whole: f64, shift: f64| {
        (0..=count).map(|k| whole * f64::from(k) / f64::from(count) + shift).collect::<Vec<f64>>()
    };
    Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: theta_i_deg.to_vec(),
        phi_i_deg: phi_i_deg.to_vec(),
        phi_r_relative: relative,
        theta_r_edges_deg: edges(12, 90.0, 0.0),
        phi_r_edges_deg: edges(24, 360.0, -7.5),
        ..Grid::default()
    }
}

/// A table of these values, each with an error of one part in a thousand.
fn table(grid: Grid, colours: Vec<Vec<f64>>) -> BrdfTable {
    let channels = |values: &Vec<f64>| {
        let peak = values.iter().copied().fold(0.0, f64::max);
        let value: Vec<f32> = values.iter().map(|&value| value as f32).collect();
        let stderr: Vec<f32> = values.iter().map(|&value| (1e-3 * value + 1e-7 * peak) as f32).collect();
        ColourChannels {
            total: value.clone(),
            single: value,
            multiple: vec![0.0; values.len()],
            stderr: stderr.clone(),
            stderr_single: stderr,
            ..ColourChannels::default()
        }
    };
    BrdfTable {
        hits: vec![100_000_000; colours[0].len()],
        grid,
        campaign: String::new(),
        version: "test".into(),
        seed: 1,
        patch_digest: String::new(),
        colours: colours.iter().map(channels).collect(),
        schlick: None,
    }
}

/// Bin means by the adaptive cubature that `validate` uses, for every F0.
fn microfacet_table(grid: Grid, model: &Microfacet, masking: Masking, f0: &[f64]) -> BrdfTable {
    let mut colours = vec![Vec::new(); f0.len()];
    for incidence in 0..grid.incidences() {
        let means = BinMeans::new(vec![masking]).evaluate(
            model,
            &[(grid.wi(incidence), 1.0)],
            &grid.regions(incidence),
        );
        for (colour, &f0) in colours.iter_mut().zip(f0) {
            colour.extend(means.iter().map(|mean| mean.with_f0(0, f0)));
        }
    }
    table(grid, colours)
}

/// Bin means by Simpson's rule on 12 x 12 intervals.
fn simpson_table(grid: Grid, value: impl Fn(DVec3, DVec3) -> f64) -> BrdfTable {
    let weight = |k: u32| {
        if k == 0 || k == 12 {
            1.0
        } else if k % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    let mut means = Vec::new();
    for incidence in 0..grid.incidences() {
        for region in grid.regions(incidence) {
            let Region::Rectangle { theta, phi } = region else { unreachable!("a hemisphere") };
            let mut sum = 0.0;
            for i in 0..=12 {
                let t = theta[0] + (theta[1] - theta[0]) * f64::from(i) / 12.0;
                for j in 0..=12 {
                    let p = phi[0] + (phi[1] - phi[0]) * f64::from(j) / 12.0;
                    let f = value(grid.wi(incidence), sphere::direction(t, p));
                    sum += weight(i) * weight(j) * f * t.sin() * t.cos();
                }
            }
            let area = (theta[1] - theta[0]) * (phi[1] - phi[0]) / (36.0 * 36.0);
            means.push(sum * area / region.projected_solid_angle());
        }
    }
    table(grid, vec![means])
}

fn fitted(table: &BrdfTable, law: FitLaw) -> Fit {
    let data = FitData::new(table, None, None);
    let mut fits = fit::fit(&data, &[law]).fits;
    let fit = fits.pop().expect("one fit");
    assert!(fit.converged, "{fit:?}");
    fit
}

#[track_caller]
pub fn holds(fit: &Fit, name: &str, expected: f64, tolerance: f64) {
    let found = fit.parameters.get(name).unwrap_or_else(|| panic!("{name} of {fit:?}"));
    assert!(
        (found - expected).abs() <= tolerance,
        "{name} = {found}, expected {expected} within {tolerance}"
    );
}

#[test]
fn the_quadrature_agrees_with_the_adaptive_one() {
    for (ndf, alpha) in [(Ndf::Ggx, 0.08), (Ndf::Ggx, 0.5), (Ndf::Beckmann, 0.3)] {
        let grid = grid(&[10.0, 60.0], &[0.0], true);
        let model = Microfacet::isotropic(ndf, alpha);
        let nodes = IncidenceNodes::of_grid(&grid, 0.0, Lobe { alpha, eta: 1.5 });
        let law = FitLaw::Microfacet(MicrofacetLaw::new(ndf, Masking::HeightCorrelated, false));
        for (incidence, nodes) in nodes.iter().enumerate() {
            let means = BinMeans::new(vec![Masking::HeightCorrelated]);
            let exact = means.evaluate(&model, &[(grid.wi(incidence), 1.0)], &grid.regions(incidence));
            let (mut off, mut all) = (0.0, 0.0);
            for (found, exact) in law.means(&[alpha.ln()], nodes).iter().zip(&exact) {
                off += (found[0] - exact.unit[0]).abs();
                all += exact.unit[0];
            }
            // The rule is right to 1e-5 of a bin where the lobe is; twice that for the tails of Gaussians.
            assert!(off < 2e-5 * all, "{ndf:?} {alpha} incidence {incidence}: {}", off / all);
        }
    }
}

/// Parts in ten thousand: the quadratures agree to 2e-5 of a bin, f32 rounds to 6e-8, and errors of single bins average
/// out over hundreds.
const EXACT: f64 = 1e-4;

#[test]
fn an_analytic_table_returns_its_roughness() {
    for (ndf, masking, alpha) in [
        (Ndf::Ggx, Masking::DirectionCorrelated, 0.3),
        (Ndf::Ggx, Masking::Separable, 0.05),
        (Ndf::Beckmann, Masking::HeightCorrelated, 0.4),
        (Ndf::Beckmann, Masking::None, 0.2),
    ] {
        let model = Microfacet::isotropic(ndf, alpha);
        let table = microfacet_table(grid(&[0.0, 30.0, 60.0], &[0.0], true), &model, masking, &[1.0]);
        let fit = fitted(&table, FitLaw::Microfacet(MicrofacetLaw::new(ndf, masking, false)));
        holds(&fit, "alpha", alpha, EXACT * alpha);
        // No campaign says that F = 1: F0 is fitted as well.
        holds(&fit, "f0", 1.0, EXACT);
        assert!(fit.l1.unwrap() < 1e-4 && fit.chi2_per_dof.unwrap() < 1e-2, "{fit:?}");
    }
}

#[test]
fn an_anisotropic_table_returns_both_roughnesses_the_turn_and_the_material() {
    let model = Microfacet { ndf: Ndf::Ggx, alpha_x: 0.15, alpha_y: 0.4, rotation: 20f64.to_radians() };
    let masking = Masking::DirectionCorrelated;
    let grid = grid(&[10.0, 50.0], &[0.0, 45.0], false);
    let table = microfacet_table(grid, &model, masking, &[1.0, 0.782, 0.344]);
    let fit = fitted(&table, FitLaw::Microfacet(MicrofacetLaw::new(Ndf::Ggx, masking, true)));
    holds(&fit, "alpha_x", 0.15, EXACT * 0.15);
    holds(&fit, "alpha_y", 0.4, EXACT * 0.4);
    // The rotation is known as well as ln(alpha_y/alpha_x) is: 1e-4 rad.
    holds(&fit, "rotation_deg", 20.0, EXACT.to_degrees());
    for (name, f0) in [("f0_r", 1.0), ("f0_g", 0.782), ("f0_b", 0.344)] {
        holds(&fit, name, f0, EXACT);
    }
}

#[test]
fn empirical_tables_return_their_parameters() {
    let grid = || grid(&[10.0, 40.0], &[0.0], true);
    let lambert = fitted(&simpson_table(grid(), |_, _| 0.6 * empirical::LAMBERT), FitLaw::Lambert);
    holds(&lambert, "albedo", 0.6, EXACT);
    let rough = simpson_table(grid(), |wi, wo| 0.6 * empirical::oren_nayar(wi, wo, 0.4));
    let rough = fitted(&rough, FitLaw::OrenNayar);
    holds(&rough, "albedo", 0.6, EXACT);
    // The kinks at cos dphi = 0 cross bins: both rules are off by (1/12 or 1/4 of a bin)^2 in one bin of 24.
    holds(&rough, "sigma_deg", 0.4f64.to_degrees(), 1e-3 * 0.4f64.to_degrees());
    let phong =
        simpson_table(grid(), |wi, wo| 0.3 * empirical::phong(wi, wo, 12.0) + 0.2 * empirical::LAMBERT);
    let phong = fitted(&phong, FitLaw::Phong);
    holds(&phong, "exponent", 12.0, EXACT * 12.0);
    holds(&phong, "specular", 0.3, EXACT);
    holds(&phong, "diffuse", 0.2, EXACT);
    let blinn = |wi, wo| 0.3 * empirical::blinn_phong(wi, wo, 40.0) + 0.2 * empirical::LAMBERT;
    let blinn = fitted(&simpson_table(grid(), blinn), FitLaw::BlinnPhong);
    holds(&blinn, "exponent", 40.0, EXACT * 40.0);
    holds(&blinn, "specular", 0.3, EXACT);
}

#[test]
fn tables_of_cavities_return_their_width() {
    // G has kinks that cross bins, where both rules are off by up to 1e-3 of a bin.
    let tolerance = 1e-3;
    let table =
        simpson_table(grid(&[10.0, 50.0], &[0.0], true), |wi, wo| cavities::cook_torrance(wi, wo, 0.3));
    holds(&fitted(&table, FitLaw::CookTorrance), "m", 0.3, tolerance * 0.3);
    let b = cavities::gaussian_tilt_scale(0.3);
    let value = |wi, wo| cavities::torrance_sparrow(wi, wo, 0.3, b);
    let fit = fitted(&simpson_table(grid(&[10.0, 50.0], &[0.0], true), value), FitLaw::TorranceSparrow);
    let expected = 0.3f64.to_degrees();
    holds(&fit, "m_deg", expected, tolerance * expected);
}

const PATCHES: &str = "\
name = \"patches\"
seed = 4
[surface]
realisations = 8
cells = 256
correlation_cells = 8.0
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = [0, 30, 60]
[sensor.hemisphere]
theta_r_bins = 12
phi_r_bins = 24
[stop]
samples = 65_536
";

fn data(measured: &Measured) -> FitData {
    FitData::new(&measured.table, Some(&measured.campaign), Some(&measured.realisations))
}

#[test]
fn measured_patches_return_their_roughness_and_their_own_law_comes_first() {
    for (law, name) in [("surface.ggx", "ggx"), ("surface.beckmann", "beckmann")] {
        let measured = measured_one(&PATCHES.replace("surface.ggx", law));
        let data = data(&measured);
        let fits = fit::fit(&data, &FitLaw::all(&data));
        let best = &fits.fits[0];
        assert_eq!(best.model, name, "{fits:?}");
        let jackknife =
            best.standard_errors_jackknife.as_ref().expect("realisations").get("alpha").expect("alpha");
        let least = best.standard_errors_least_squares.get("alpha").expect("alpha");
        // Student's limit of one in a thousand for eight patches, and an error that means something: a Gaussian patch of
        // 256 cells has some 300 bumps, which know alpha to 2 %, eight of them to 0.7 %.
        holds(best, "alpha", 0.3, stats::student_limit(1e-3, 7) * jackknife);
        assert!(jackknife < 0.007 * 0.3, "{jackknife}");
        // Patches that are off, are off in all bins together: errors of single bins do not know of it.
        assert!(jackknife > 1.5 * least, "{jackknife} {least}");
        assert_eq!(best.standard_errors.get("alpha"), Some(jackknife));
        let good: Vec<&Fit> = fits.fits.iter().filter(|fit| fit.did_not_fit.is_none()).collect();
        assert!(good.windows(2).all(|pair| pair[0].aic <= pair[1].aic));
    }
}

#[test]
fn a_students_patch_is_known_by_its_own_law() {
    for (law, name) in [
        ("[surface.student_t]\ngamma = 4.0\nalpha = 0.3", "student_t"),
        ("[surface.blinn_phong]\nexponent = 20", "blinn_phong"),
    ] {
        // As many correlation lengths on a quarter of the cells.
        let text =
            PATCHES.replace("cells = 256\ncorrelation_cells = 8.0", "cells = 128\ncorrelation_cells = 4.0");
        let measured = measured_one(&text.replace("[surface.ggx]\nalpha = 0.3", law));
        let data = data(&measured);
        let own = FitLaw::of_surface(&measured.campaign.surface.kind, &data);
        let others = FitLaw::all(&data).into_iter().filter(|law| matches!(law, FitLaw::Microfacet(_)));
        let fits = fit::fit(&data, &others.chain(own).collect::<Vec<_>>());
        let best = &fits.fits[0];
        assert_eq!(best.model, name, "{fits:?}");
        let alpha = measured.campaign.alphas()[0].expect("a roughness").x;
        let jackknife = best.standard_errors.get("alpha").expect("alpha");
        holds(best, "alpha", alpha, stats::student_limit(1e-3, 7) * jackknife);
    }
}

#[test]
fn no_answer_is_unphysical_and_a_parameter_on_its_bound_is_said_to_be_there() {
    let two = || grid(&[10.0, 40.0], &[0.0], true);
    let with_schlick = |wi: DVec3, wo: DVec3| {
        let mirror = Microfacet::isotropic(Ndf::Ggx, 0.3);
        let unit = mirror.brdf(wi, wo, Masking::HeightCorrelated, &gonio::optics::Fresnel::Perfect);
        unit * gonio::optics::fresnel::schlick_weight(wi, wo)
    };
    // Light only at grazing differences, half of what F0 = 0 reflects: F0 would have to be negative.
    let dark = simpson_table(two(), |wi, wo| 0.5 * with_schlick(wi, wo));
    // Twice a mirror's light: F0 would have to exceed 1.
    let mirror = Microfacet::isotropic(Ndf::Ggx, 0.3);
    let bright = microfacet_table(two(), &mirror, Masking::HeightCorrelated, &[2.0]);
    // A constant with a hole where a lobe would be: the lobe would have to be negative.
    let hole = simpson_table(two(), |wi, wo| (0.3 - 0.1 * empirical::blinn_phong(wi, wo, 20.0)).max(0.05));
    // A constant: ever rougher slopes and ever wider lobes come ever nearer.
    let constant = simpson_table(two(), |_, _| 0.6 * empirical::LAMBERT);
    for (table, name) in [(&dark, "dark"), (&bright, "bright"), (&hole, "hole"), (&constant, "constant")] {
        let data = FitData::new(table, None, None);
        for fit in fit::fit(&data, &FitLaw::all(&data)).fits {
            for (parameter, value) in &fit.parameters.0 {
                let Some(value) = *value else { continue };
                let most = match parameter.as_str() {
                    "f0" => 1.0,
                    "alpha" | "alpha_x" | "alpha_y" | "m" => 10.0,
                    "sigma_deg" | "m_deg" => 90.0,
                    "exponent" => 1e6,
                    "rotation_deg" => continue,
                    _ => f64::INFINITY,
                };
                // Exponentials of logarithms of the bounds.
                let inside = value >= 0.0 && value <= most * (1.0 + 1e-12);
                assert!(inside, "{name}: {parameter} = {value} of {fit:?}");
                let on = fit.on_bound.contains(parameter);
                let error = fit.standard_errors.get(parameter);
                assert!(!on || error.is_none(), "{name}: {parameter} = {value} on a bound, +- {error:?}");
            }
        }
    }
    let of = |table: &BrdfTable, law: FitLaw| {
        let data = FitData::new(table, None, None);
        fit::fit(&data, &[law]).fits.remove(0)
    };
    let ggx = FitLaw::Microfacet(MicrofacetLaw::new(Ndf::Ggx, Masking::HeightCorrelated, false));
    let (dark, bright, hole) = (of(&dark, ggx), of(&bright, ggx), of(&hole, FitLaw::BlinnPhong));
    for (fit, name, value) in [(&dark, "f0", 0.0), (&bright, "f0", 1.0), (&hole, "specular", 0.0)] {
        assert!(fit.parameters.get(name) == Some(value) && fit.on_bound.contains(&name.into()), "{fit:?}");
    }
}

#[test]
fn hopeless_models_did_not_fit_and_say_why() {
    let two = || grid(&[10.0, 40.0], &[0.0], true);
    let lobe = microfacet_table(two(), &Microfacet::isotropic(Ndf::Ggx, 0.15), Masking::Separable, &[1.0]);
    let data = FitData::new(&lobe, None, None);
    let fits = fit::fit(&data, &FitLaw::all(&data)).fits;
    assert!(fits[0].model == "ggx" && fits[0].did_not_fit.is_none(), "{:?}", fits[0]);
    let why = |fits: &[Fit], name: &str| {
        fits.iter().find(|fit| fit.model == name).expect("all").did_not_fit.clone()
    };
    for name in ["lambert", "oren_nayar"] {
        assert!(why(&fits, name).is_some_and(|why| why.contains("constant")), "{fits:?}");
    }
    // The other way round: a constant has no lobe.
    let constant = simpson_table(two(), |_, _| 0.6 * empirical::LAMBERT);
    let data = FitData::new(&constant, None, None);
    let fits = fit::fit(&data, &FitLaw::all(&data)).fits;
    assert!(
        fits[0].did_not_fit.is_none()
            && fits[0].parameters.get("diffuse").or(fits[0].parameters.get("albedo")).is_some()
    );
    for name in ["ggx", "beckmann", "cook_torrance"] {
        assert!(why(&fits, name).is_some(), "{name}: {fits:?}");
    }
}

#[test]
fn gaps_of_an_imported_table_are_left_out() {
    let mirror = Microfacet::isotropic(Ndf::Ggx, 0.3);
    let mut table = microfacet_table(grid(&[0.0, 30.0], &[0.0], true), &mirror, Masking::Separable, &[1.0]);
    table.colours[0].stderr_single.iter_mut().for_each(|se| *se = -1.0);
    table.hits.iter_mut().for_each(|hits| *hits = 1);
    let whole = table.hits.len();
    for at in (0..whole).filter(|at| at % 3 == 0) {
        table.set_gap(at);
    }
    let law = FitLaw::Microfacet(MicrofacetLaw::new(Ndf::Ggx, Masking::Separable, false));
    let fit = fitted(&table, law);
    holds(&fit, "alpha", 0.3, EXACT * 0.3);
    assert!(fit.chi2_per_dof.is_none() && fit.l1.expect("light") < 1e-4, "{fit:?}");
    assert_eq!(FitData::new(&table, None, None).len(), whole - whole.div_ceil(3));
    // The same bins black, and seen to be: no gaps, and no such roughness.
    table.hits.fill(1);
    table.colours[0].stderr.fill(-1.0);
    let data = FitData::new(&table, None, None);
    assert!(fit::fit(&data, &[law]).fits[0].l1.expect("light") > 0.2);
}

/// A table of 6,912 values.
fn large_table(alpha: f64) -> BrdfTable {
    let thetas: Vec<f64> = (0..24).map(|k| 3.0 * f64::from(k)).collect();
    let mirror = Microfacet::isotropic(Ndf::Ggx, alpha);
    microfacet_table(grid(&thetas, &[0.0], true), &mirror, Masking::HeightCorrelated, &[1.0])
}

#[test]
fn a_large_table_is_fitted_to_some_values_first_and_the_best_models_to_all() {
    let data = FitData::new(&large_table(0.3), None, None);
    let fits = fit::fit(&data, &FitLaw::all(&data)).fits;
    let best = (fits[0].model, fits[0].masking, fits[0].fitted_values);
    assert_eq!(best, ("ggx", Some("height_correlated"), 6912));
    holds(&fits[0], "alpha", 0.3, EXACT * 0.3);
    let lambert = fits.iter().find(|fit| fit.model == "lambert").expect("all");
    assert!(lambert.fitted_values < 3000 && lambert.did_not_fit.is_some(), "{lambert:?}");
    assert_eq!(fit::best(&data, &FitLaw::all(&data)).parameters, fits[0].parameters);
}

#[test]
fn a_sample_of_a_table_stands_for_all_of_it() {
    for alpha in [0.02, 0.3] {
        let data = FitData::new(&large_table(alpha), None, None);
        let sample = FitSample::drawn(&data, 2048);
        let count = sample.entries.len();
        assert!((1024..=4096).contains(&count) && sample.entries.is_sorted(), "{alpha}: {count}");
        assert!(sample.shares.iter().all(|share| *share >= 1.0), "{alpha}");
        let sums = |of: &dyn Fn(usize) -> f64| {
            let all: f64 = (0..data.size.len()).map(of).sum();
            sample.entries.iter().zip(&sample.shares).map(|(&entry, share)| share * of(entry)).sum::<f64>()
                / all
        };
        // Chances hold half of each quantity at least, so a term is 2/2048 of the sum at most, and of each run of terms
        // one is taken: off by no more than the variation of the terms along the table, some tens of them.
        let flux = sums(&|entry| data.size[entry] * data.value[0][entry]);
        let size = sums(&|entry| data.size[entry]);
        assert!((flux - 1.0).abs() < 0.03 && (size - 1.0).abs() < 0.03, "{alpha}: {flux} {size}");
    }
}

#[test]
#[ignore = "takes minutes: cargo test --release -- --ignored"]
fn large_patches_return_their_roughness_within_a_hundredth() {
    let text =
        PATCHES.replace("cells = 256", "cells = 1024").replace("realisations = 8", "realisations = 16");
    for alpha in [0.1, 0.5] {
        let measured = measured_one(&text.replace("alpha = 0.3", &format!("alpha = {alpha}")));
        let data = data(&measured);
        let best = fit::fit(&data, &FitLaw::all(&data)).fits.remove(0);
        assert_eq!(best.model, "ggx");
        println!("{alpha}: {:?} {:?}", best.parameters, best.standard_errors);
        holds(&best, "alpha", alpha, 0.01 * alpha);
    }
}

#[test]
fn the_command_prints_json_and_says_what_is_missing() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let model = Microfacet::isotropic(Ndf::Ggx, 0.3);
    let table = microfacet_table(grid(&[20.0], &[0.0], true), &model, Masking::Separable, &[1.0]);
    gonio::table::store::save(&folder.path().join("t.exr"), &table).expect("saved");
    let run = |words: &[&str]| gonio(folder.path(), words);
    let answer = run(&["fit", "t.exr", "--model", "ggx", "--json"]);
    let json = program::json(&answer);
    let best = &json["fits"][0];
    assert!((best["parameters"]["alpha"].as_f64().expect("alpha") - 0.3).abs() < 3e-5, "{json}");
    for key in ["model", "masking", "parameters", "standard_errors", "chi2_per_dof", "l1", "aic"] {
        assert!(!best[key].is_null(), "{key} of {best}");
    }
    assert!(best["standard_errors_jackknife"].is_null());
    let text = stdout(&run(&["fit", "t.exr"]));
    assert!(text.contains("no realisations"), "{text}");
    // The winner first, in one sentence; hopeless models last.
    assert!(text.starts_with("best: ggx separable: alpha 0.3000"), "{text}");
    assert!(text.contains("did not fit: lambert, oren_nayar: explains less than half"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    let refused = run(&["fit", "t.exr", "--model", "gxx"]);
    let said = exits(&refused, 2);
    assert!(said.contains("--model gxx: one of lambert"), "{said}");
    assert!(fs::read_dir(&folder).expect("a folder").count() == 1);
}

#[test]
fn the_quick_fit_finds_the_law_of_its_table() {
    let model = Microfacet { ndf: Ndf::Beckmann, alpha_x: 0.25, alpha_y: 0.25, rotation: 0.0 };
    let grid = grid(&[0.0, 30.0, 60.0], &[0.0], true);
    let table = microfacet_table(grid, &model, Masking::HeightCorrelated, &[0.9, 0.6, 0.3]);
    let data = FitData::new(&table, None, None);
    let found = fit::nearest(&data, &FitLaw::all(&data)).expect("a law");
    assert_eq!(found.name, "beckmann, height-correlated, alpha 0.250");
    for (means, colour) in found.means.iter().zip(&table.colours) {
        let peak = f64::from(colour.total.iter().copied().fold(0.0, f32::max));
        // The table is the model to 1e-5 (nodes of both quadratures), and its parameters are found to 1e-7.
        let off = means.iter().zip(&colour.total).map(|(a, b)| (a - f64::from(*b)).abs()).fold(0.0, f64::max);
        assert!(off < 1e-4 * peak, "{off} of {peak}");
    }
    assert!(fit::nearest(&data, &[]).is_none());
    // Of a sample, too.
    let data = FitData::new(&large_table(0.3), None, None);
    let found = fit::nearest(&data, &FitLaw::all(&data)).expect("a law");
    assert_eq!(found.name, "ggx, height-correlated, alpha 0.300");
}
