//! Promise: light through rough clear surfaces meets mpmath's values, at points and over bins, to the stated tolerance.
//!
//! The rows are made by tests/data/transmission_means.py.

use std::collections::BTreeMap;

use glam::DVec3;
use gonio::instrument::Region;
use gonio::sphere::direction_deg;
use gonio::theory::beta::beta_of_lambdas;
use gonio::theory::{Masking, Microfacet, Ndf};
use gonio::validate::BinMeans;

const MASKINGS: [Masking; 3] = [Masking::None, Masking::Separable, Masking::HeightCorrelated];

/// Bins in the file.
const MEANS: usize = 84;

type Row = BTreeMap<String, String>;

fn rows(kind: &str) -> Vec<Row> {
    let mut reader = csv::Reader::from_path("tests/data/transmission_means.csv").expect("the reference file");
    let all = reader.deserialize().map(|row| row.expect("a row"));
    all.filter(|row: &Row| row["kind"] == kind).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} of {row:?}"))
}

fn places<const N: usize>(row: &Row) -> [f64; N] {
    std::array::from_fn(|k| number(row, &format!("p{}", k + 1)))
}

fn model(row: &Row) -> Microfacet {
    let ndf = if row["ndf"] == "ggx" { Ndf::Ggx } else { Ndf::Beckmann };
    let (alpha_x, alpha_y) = (number(row, "alpha_x"), number(row, "alpha_y"));
    Microfacet { ndf, alpha_x, alpha_y, rotation: 0.0 }
}

/// The values that a row has, with their maskings.
fn expected(row: &Row) -> Vec<(Masking, f64)> {
    let given = MASKINGS.into_iter().filter(|masking| !row[masking.name()].is_empty());
    given.map(|masking| (masking, number(row, masking.name()))).collect()
}

#[test]
fn the_beta_function_matches_mpmath() {
    let (rows, mut worst) = (rows("beta"), 0.0f64);
    for row in &rows {
        let [a, b] = places(row);
        let (found, expected) = (beta_of_lambdas(a, b), number(row, "height_correlated"));
        worst = worst.max((found / expected - 1.0).abs());
    }
    // As documented: the logarithm, at most 690, rounds a few times.
    assert!(worst < 1e-12, "{worst:e}");
    assert!(rows.len() >= 60, "{}", rows.len());
}

#[test]
fn every_value_of_transmission_is_met() {
    let (rows, mut worst) = (rows("point"), 0.0f64);
    for row in &rows {
        let [x, y, z, u, v, w] = places(row);
        let (wi, wo) = (DVec3::new(x, y, z), DVec3::new(u, v, w));
        let eta = number(row, "eta");
        for (masking, expected) in expected(row) {
            let found = model(row).btdf(wi, wo, masking, eta);
            // Unit vectors are right to an ulp, each component magnified by `cond`, and their length by 1/d; Beta rounds to
            // its 1e-13 here, the rest to a few dozen ulp.
            let rounded = 64.0 + 2.0 * number(row, "cond") + 4.0 / (eta - 1.0).abs();
            let tolerance = 1e-13 + rounded * f64::EPSILON;
            let error = (found / expected - 1.0).abs();
            assert!(error < tolerance, "{masking:?} {row:?}: {found:e} {error:e} > {tolerance:e}");
            worst = worst.max(error / tolerance);
        }
    }
    assert_eq!(rows.len(), 80, "{worst}");
}

#[test]
fn means_below_match_mpmath() {
    let rows = rows("mean");
    for row in &rows {
        let [theta_i, phi_i, angles @ ..] = places::<6>(row);
        let [t1, t2, p1, p2] = angles.map(f64::to_radians);
        let region = Region::Rectangle { theta: [t1, t2], phi: [p1, p2] };
        let (source, eta) = ([(direction_deg(theta_i, phi_i), 1.0)], number(row, "eta"));
        // The orders agree to a tenth of what is asked for. At kinks, where that is hardest, they agreed to 2e-9 and were off
        // by 4e-8 at the first precision, to 1e-10 and 2e-10 at the second.
        for (relative, tolerance) in [(1e-6, 1e-7), (1e-9, 1e-9)] {
            let means = BinMeans { relative, absolute: 1e-14, ..BinMeans::new(MASKINGS.to_vec()) };
            let found = means.evaluate_through(&model(row), &source, &[region], eta)[0];
            for ((masking, expected), found) in expected(row).into_iter().zip(found.values) {
                let error = (found - expected).abs();
                assert!(
                    error <= tolerance * expected,
                    "{masking:?} {relative} {row:?}: {found:e}, {error:e} off"
                );
            }
        }
    }
    assert_eq!(rows.len(), MEANS);
}
