//! Promise: bin means keep their digits where total reflection begins (tests/data/critical_means.py).

use gonio::instrument::Region;
use gonio::optics::Fresnel;
use gonio::optics::reflectance::Reflectance;
use gonio::sphere::direction_deg;
use gonio::theory::{Masking, Microfacet, Ndf};
use gonio::validate::prediction::bin_mean::BinMeans;

/// At the default precision, and at one that the other program has itself.
#[test]
fn means_at_total_reflection_match_another_program() {
    let (mut rows, mut worst) = (0, [0.0f64; 2]);
    for line in include_str!("../../data/critical_means.csv").lines().skip(1) {
        let n: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
        let model = Microfacet { ndf: Ndf::Ggx, alpha_x: n[0], alpha_y: n[1], rotation: 0.0 };
        let reflectance = Some(Reflectance::unpolarised(Fresnel::Dielectric { eta: n[2] }));
        let usual = BinMeans { reflectance, ..BinMeans::new(vec![Masking::HeightCorrelated]) };
        let close = BinMeans { relative: 1e-10, absolute: 0.0, ..usual.clone() };
        let region = Region::Rectangle {
            theta: [n[5].to_radians(), n[6].to_radians()],
            phi: [n[7].to_radians(), n[8].to_radians()],
        };
        for (worst, means) in worst.iter_mut().zip([usual, close]) {
            let found = means.evaluate(&model, &[(direction_deg(n[3], n[4]), 1.0)], &[region])[0].schlick[0];
            *worst = worst.max((found / n[9] - 1.0).abs());
        }
        rows += 1;
    }
    println!("{rows} means, {worst:?} at worst");
    // What is asked of the cubature; of the other program 1e-10, twice nested.
    assert!(rows > 40 && worst[0] < 1e-6 && worst[1] < 1e-9, "{worst:?}");
}
