//! Promise: what layered facets do meets mpmath's values, and the light of their base leaves as Fresnel's equations let it
//! through. The rows are made by tests/data/layered_values.py.

use glam::DVec3;
use gonio::optics::layered::{
    Interface, base_reflectance, diffuse_reflectance_inside, diffuse_reflectance_outside, leaving_direction,
    transmittance,
};
use gonio::rng::uniform;
use gonio::sphere::direction_deg;
use gonio::theory::{Microfacet, Ndf};

use crate::support::measuring::test_rng;

/// What it is of, and eta, alpha_x, alpha_y, four angles, the value.
type Row = (String, [f64; 8]);

fn rows() -> Vec<Row> {
    let mut reader = csv::Reader::from_path("tests/data/layered_values.csv").expect("the reference file");
    let row = |record: csv::StringRecord| {
        (record[0].to_owned(), std::array::from_fn(|k| record[k + 1].parse().expect("a number")))
    };
    reader.records().map(|record| row(record.expect("a row"))).collect()
}

#[test]
fn diffuse_reflectances_meet_mpmath() {
    let mut seen = 0;
    for (what, [eta, .., expected]) in rows() {
        let found = match what.as_str() {
            "outside" => diffuse_reflectance_outside(eta),
            "inside" => diffuse_reflectance_inside(eta),
            _ => continue,
        };
        // Positive terms of 16 ulp each; from inside eta^2 - 1 is a product. Ten times what is documented.
        assert!((found / expected - 1.0).abs() < 1e-12, "{what} {eta}: {found:e} {expected:e}");
        seen += 1;
    }
    assert_eq!(seen, 24);
}

#[test]
fn reference_values_of_layered_facets_are_met() {
    let (mut seen, mut worst) = (0, 0.0f64);
    for (what, [eta, alpha_x, alpha_y, theta_i, phi_i, theta_o, phi_o, expected]) in rows() {
        let ndf = match what.as_str() {
            "ggx" => Ndf::Ggx,
            "beckmann" => Ndf::Beckmann,
            _ => continue,
        };
        let (wi, wo) = (direction_deg(theta_i, phi_i), direction_deg(theta_o, phi_o));
        let model = Microfacet { ndf, alpha_x, alpha_y, rotation: 0.0 };
        let found = model.layered_overlap(wi, wo, &Interface::new(eta));
        let error = (found / expected - 1.0).abs();
        worst = worst.max(error);
        // Twice what is documented.
        assert!(
            error < if eta > 1.1 { 2e-5 } else { 4e-4 },
            "{ndf:?} {eta} {alpha_x} {theta_i} {theta_o}: {error:e}"
        );
        seen += 1;
    }
    println!("worst {worst:e}");
    assert_eq!(seen, 35);
}

/// Bins of equal share under Lambert's law outside, cos^2 from k/32 to (k + 1)/32: chi^2 of 2^18 directions.
#[test]
fn light_from_the_base_leaves_by_fresnels_equations() {
    const BINS: usize = 32;
    let normal = direction_deg(70.0, 200.0);
    for (seed, eta) in [(1, 1.0001), (2, 1.5), (3, 4.0)] {
        let (mut rng, count) = (test_rng(seed), 1 << 18);
        let (mut counts, mut sum) = ([0.0; BINS], DVec3::ZERO);
        for _ in 0..count {
            let w = leaving_direction(3.0 * normal, eta, || uniform(&mut rng));
            assert!((w.length() - 1.0).abs() < 1e-15);
            let cos = w.dot(normal);
            counts[((cos * cos * BINS as f64) as usize).min(BINS - 1)] += 1.0;
            sum += w - cos * normal;
        }
        let passes = 1.0 - diffuse_reflectance_outside(eta);
        // Midpoints in the cosine: the second order of 1/1000 of a bin.
        let share = |k: usize| {
            let [low, high] = [k, k + 1].map(|k| (k as f64 / BINS as f64).sqrt());
            let at = |j: i32| low + (high - low) * (f64::from(j) + 0.5) / 1000.0;
            let mean = (0..1000).map(|j| 2.0 * at(j) * transmittance(at(j), eta)).sum::<f64>() / 1000.0;
            (high - low) * mean / passes
        };
        let expected: Vec<f64> = (0..BINS).map(|k| f64::from(count) * share(k)).collect();
        assert!((expected.iter().sum::<f64>() / f64::from(count) - 1.0).abs() < 1e-6);
        let chi2: f64 = counts.iter().zip(&expected).map(|(n, e)| (n - e).powi(2) / e).sum();
        let dof = (BINS - 1) as f64;
        // 5 standard deviations of chi^2.
        assert!((chi2 - dof) / (2.0 * dof).sqrt() < 5.0, "{eta}: chi^2 {chi2} of {dof}");
        // Across the normal the mean is 0; the variance of each of two components is below 1/4.
        assert!(sum.length() / f64::from(count) < 5.0 * (0.5 / f64::from(count)).sqrt(), "{eta}: {sum}");
    }
}

#[test]
fn a_facet_reflects_alike_both_ways_and_never_more_than_it_gets() {
    for eta in [1.0001, 1.5, 4.0] {
        let interface = Interface::new(eta);
        for (a, b) in [(1.0, 0.3), (0.5, 0.01), (0.9, 0.9)] {
            assert_eq!(interface.weight(a, b), interface.weight(b, a));
        }
        assert_eq!((base_reflectance(1.0, eta), base_reflectance(0.0, eta)), (1.0, 0.0));
        // The series: albedo once, and once more for each time that the interface sends light back.
        let (inside, albedo) = (diffuse_reflectance_inside(eta), 0.6);
        let series: f64 = (1..200).map(|k| albedo * (1.0 - inside) * (albedo * inside).powi(k - 1)).sum();
        // 200 terms of a ratio below 0.6; roundings.
        assert!((base_reflectance(albedo, eta) - series).abs() < 1e-14);
        // Light from one direction: what is mirrored and what leaves the white base are all of it. Midpoints in the cosine,
        // of whose curve at grazing angles 2000 keep 1e-6.
        let at = |j: i32| (f64::from(j) + 0.5) / 20_000.0;
        for cos in [1.0, 0.4, 0.05] {
            let base: f64 =
                (0..20_000).map(|j| 2.0 * at(j) * interface.weight(cos, at(j))).sum::<f64>() / 20_000.0;
            assert!((base - transmittance(cos, eta)).abs() < 1e-6, "{eta} {cos}: {base}");
        }
    }
    // Without an interface facets are matt ones.
    let (faint, model) = (Interface::new(1.0 + 1e-9), Microfacet::isotropic(Ndf::Ggx, 0.4));
    let (wi, wo) = (direction_deg(30.0, 0.0), direction_deg(50.0, 100.0));
    // 1 - F of facets along which light grazes falls below 1 within cosines of sqrt(2e-9), a share of 1e-9 of the light.
    assert!((model.layered_overlap(wi, wo, &faint) / model.facet_overlap(wi, wo) - 1.0).abs() < 1e-5);
    assert!((faint.weight(0.7, 0.4) - 1.0).abs() < 1e-8);
}
