//! Promise: albedos of order 1 by formula are those of other programs, to 1e-9 of mirror facets and 1e-7 of clear ones, and
//! the error beside each value is no smaller than its own.
//!
//! The rows of glass are made by tests/data/albedo_values.py.

use std::collections::BTreeMap;

use gonio::albedo::formula::{SIDES, by_formula};
use gonio::albedo::{AlbedoTable, Axes, FormulaSurface};
use gonio::optics::Fresnel;
use gonio::optics::reflectance::Reflectance;
use gonio::sphere::direction_deg;
use gonio::theory::gauss_legendre::gauss_legendre;
use gonio::theory::{Masking, Microfacet, Ndf};
use gonio::validate::albedo;

const SMOOTH: [Masking; 2] = [Masking::Separable, Masking::HeightCorrelated];

fn rows(path: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).expect("the reference file");
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} of {row:?}"))
}

#[test]
fn albedos_match_another_program() {
    let rows = rows("tests/data/reference_albedo.csv");
    assert_eq!(rows.len(), 108);
    for row in &rows {
        let (alpha_x, alpha_y) = (number(row, "alpha_x"), number(row, "alpha_y"));
        let surface = Microfacet { ndf: Ndf::Ggx, alpha_x, alpha_y, rotation: 0.0 };
        let wi = direction_deg(number(row, "theta_o_deg"), number(row, "phi_o_deg"));
        for (masking, column) in SMOOTH.into_iter().zip(["E_sep_F1", "E_corr_F1"]) {
            let [white, f0, f90] = FormulaSurface { surface, masking, mirror_base: false }.mirror(wi);
            // Promised; the file has 13 digits.
            assert!((white.value - number(row, column)).abs() < 1e-9, "{row:?}: {white:?}");
            // One subtraction.
            assert!((f0.value + f90.value - white.value).abs() <= f64::EPSILON, "{row:?}");
            // Schlick's formula itself in the integral. Orders that agree to 1e-7 of E.
            let schlick = Reflectance::unpolarised(Fresnel::Schlick { f0: 0.04 });
            let [_, whole] = albedo(&surface, wi, masking, Some(schlick));
            assert!((0.04 * f0.value + f90.value - whole.value).abs() < 1e-7, "{row:?}");
        }
    }
}

#[test]
fn albedos_of_glass_match_another_program() {
    let rows = rows("tests/data/albedo_values.csv");
    assert!(rows.len() >= 50, "{}", rows.len());
    let mut worst = 0.0f64;
    for row in &rows {
        let ndf = if row["ndf"] == "ggx" { Ndf::Ggx } else { Ndf::Beckmann };
        let (alpha, eta, mu) = (number(row, "alpha"), number(row, "eta"), number(row, "mu"));
        for masking in SMOOTH {
            let surface = FormulaSurface::new(ndf, alpha, masking);
            let (mirror, clear) = (surface.at(mu, None), surface.at(mu, Some(eta)));
            let all = [("E", mirror[0]), ("F90", mirror[2]), ("R", clear[0]), ("T", clear[1])];
            for (name, found) in all {
                let off = (found.value - number(row, &format!("{name}_{}", masking.name()))).abs();
                worst = worst.max(off);
                // Promised is 1e-6; the file is right to 1e-8.
                assert!(off < 1e-7, "{name}, {masking:?}, {row:?}: {found:?}");
                assert!(
                    off <= found.error.max(1e-8),
                    "{name}, {masking:?}, {row:?}: {found:?} is off by {off:e}"
                );
            }
        }
    }
    println!("{} rows: off by {worst:.1e} at most", rows.len());
}

fn table(axes: &Axes) -> AlbedoTable {
    by_formula(Ndf::Ggx, Masking::HeightCorrelated, axes, &|_| ())
}

#[test]
fn averages_are_those_of_a_double_integral() {
    let axes = Axes { mu: vec![1.0], alpha: vec![0.05, 0.5], eta: vec![] };
    let found = table(&axes);
    for (row, &alpha) in axes.alpha.iter().enumerate() {
        let surface = FormulaSurface::new(Ndf::Ggx, alpha, Masking::HeightCorrelated);
        for (k, quantity) in found.quantities.iter().enumerate() {
            // Another rule, 40 points in each of three pieces: below alpha, where E turns, and above.
            let pieces = [[0.0, 0.5 * alpha], [0.5 * alpha, 2.0 * alpha], [2.0 * alpha, 1.0]];
            let of_piece = |[a, b]: [f64; 2]| -> f64 {
                let node = |&(x, weight): &(f64, f64)| {
                    let mu = a + (b - a) * x;
                    2.0 * mu * surface.at(mu, None)[k].value * weight * (b - a)
                };
                gauss_legendre(40).iter().map(node).sum()
            };
            let expected: f64 = pieces.into_iter().map(of_piece).sum();
            let average = quantity.averages[row];
            // What the two orders may disagree by, and 1e-8 of the albedos themselves.
            assert!(
                (average.value - expected).abs() < 2e-8,
                "{alpha} {}: {average:?} {expected}",
                quantity.name
            );
            assert!(average.error.is_some_and(|error| error < 1e-7), "{average:?}");
        }
    }
}

/// Light goes back as it came: f(wi -> wo)/eta^2 = f(wo -> wi) of the other side, so the averages of T are eta^2 apart.
#[test]
fn what_goes_through_from_both_sides_is_eta_squared_apart() {
    let axes = Axes { mu: vec![1.0], alpha: vec![0.2], eta: vec![1.1, 2.4] };
    let found = table(&axes);
    let [outside, inside] = SIDES.map(|side| &found.quantity(&format!("T_{side}")).expect("there").averages);
    for (k, (outside, inside)) in outside.iter().zip(inside).enumerate() {
        let eta = axes.eta[k];
        // The two orders of the averages agree to 1e-6.
        let tolerance = 1e-6 * (1.0 + eta * eta);
        assert!(
            (outside.value - eta * eta * inside.value).abs() < tolerance,
            "{eta}: {outside:?} {inside:?}"
        );
    }
}

#[test]
fn the_ends_of_the_axes_are_stable() {
    for ndf in [Ndf::Ggx, Ndf::Beckmann] {
        for (alpha, mu) in [(1e-4, 1e-4), (1e-4, 1.0), (10.0, 1e-4), (1.0, 1e-4), (0.02, 0.01)] {
            for masking in SMOOTH {
                let surface = FormulaSurface::new(ndf, alpha, masking);
                let each = [None, Some(1.0001), Some(1.5)].map(|eta| surface.at(mu, eta));
                for found in each.iter().flatten() {
                    // 1e-7 is what the orders may disagree by.
                    let sound = (-1e-7..=1.0 + 1e-7).contains(&found.value) && found.error < 1e-6;
                    assert!(sound, "{ndf:?} {masking:?} alpha {alpha}, mu {mu}: {each:?}");
                }
            }
        }
    }
    // 1 - ln 2 in closed form; Kulla and Conty's energy loss of the roughest metal, 2017.
    let rough = FormulaSurface::new(Ndf::Ggx, 1.0, Masking::HeightCorrelated).at(1.0, None)[0];
    assert!((rough.value - (1.0 - 2f64.ln())).abs() < 1e-9, "{rough:?}");
}
