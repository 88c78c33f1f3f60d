//! Promise: matt facets meet mpmath's values, and bins of them are means over the bin. The rows are made by
//! tests/data/diffuse_values.py.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};
use std::path::Path;

use glam::DVec3;
use gonio::campaign;
use gonio::instrument::Region;
use gonio::measure::{Patches, measure, plan};
use gonio::sphere::{direction, direction_deg};
use gonio::theory::empirical::{LAMBERT, oren_nayar, oren_nayar_full, oren_nayar_twice};
use gonio::theory::{Masking, Microfacet, Ndf};
use gonio::validate::{Prediction, diffuse_means};

/// Integrals over facets in the file.
const OVERLAPS: usize = 60;

struct Row {
    model: String,
    numbers: [f64; 7],
}

impl Row {
    fn arms(&self) -> [DVec3; 2] {
        let [_, _, theta_i, phi_i, theta_o, phi_o, _] = self.numbers;
        [direction_deg(theta_i, phi_i), direction_deg(theta_o, phi_o)]
    }
}

fn rows() -> Vec<Row> {
    let mut reader = csv::Reader::from_path("tests/data/diffuse_values.csv").expect("the reference file");
    let row = |record: csv::StringRecord| Row {
        model: record[0].to_owned(),
        numbers: std::array::from_fn(|k| record[k + 1].parse().expect("a number")),
    };
    reader.records().map(|record| row(record.expect("a row"))).collect()
}

#[test]
fn matt_facets_meet_mpmath() {
    let (mut seen, mut worst) = (0, 0.0f64);
    for row in rows() {
        let ndf = match row.model.as_str() {
            "ggx" => Ndf::Ggx,
            "beckmann" => Ndf::Beckmann,
            _ => continue,
        };
        let [alpha_x, alpha_y, .., expected] = row.numbers;
        let [wi, wo] = row.arms();
        let model = Microfacet { ndf, alpha_x, alpha_y, rotation: 0.0 };
        let error = (model.facet_overlap(wi, wo) / expected - 1.0).abs();
        // Twice what is documented.
        assert!(error < 1e-5, "{ndf:?} {:?}: {error:e}", row.numbers);
        worst = worst.max(error);
        // Unmasked, f is the integral over pi and both cosines: a few roundings.
        let f = model.diffuse(wi, wo, Masking::None) * PI * wi.z * wo.z;
        assert!((f / model.facet_overlap(wi, wo) - 1.0).abs() < 1e-14);
        seen += 1;
    }
    assert_eq!(seen, OVERLAPS, "{worst}");
}

#[test]
fn oren_nayars_full_model_meets_its_reference() {
    let mut seen = 0;
    for row in rows() {
        let [sigma, albedo, .., expected] = row.numbers;
        let [wi, wo] = row.arms();
        let found = match row.model.as_str() {
            "oren_nayar_full" => albedo * oren_nayar_full(wi, wo, sigma),
            "oren_nayar_inter" => albedo * albedo * oren_nayar_twice(wi, wo, sigma),
            _ => continue,
        };
        // Angles that round to an ulp; tan magnifies by at most 15 at 75 degrees.
        assert!((found - expected).abs() < 1e-14, "{} {:?}: {found}", row.model, row.numbers);
        seen += 1;
    }
    assert_eq!(seen, 48);
    // Smooth: Lambert, and nothing twice. Where azimuths agree and b is 0, both models are C1.
    let (wi, wo) = (direction_deg(40.0, 0.0), direction_deg(70.0, 20.0));
    assert_eq!((oren_nayar_full(wi, wo, 0.0), oren_nayar_twice(wi, wo, 0.0)), (LAMBERT, 0.0));
    assert_eq!(oren_nayar_full(DVec3::Z, wo, 0.4), oren_nayar(DVec3::Z, wo, 0.4));
}

/// Abscissae and weights of Gauss and Legendre's rule of 5 points on [-1, 1] (Abramowitz and Stegun, table 25.4).
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189),
    (-0.538_469_310_105_683, 0.478_628_670_499_366),
    (0.0, 0.568_888_888_888_889),
    (0.538_469_310_105_683, 0.478_628_670_499_366),
    (0.906_179_845_938_664, 0.236_926_885_056_189),
];

/// The mean of f over a region by n x n pieces of 5 x 5 points in (theta, phi), weight cos sin.
fn gauss_mean(
    model: &Microfacet,
    wi: DVec3,
    masking: Masking,
    [theta, phi]: [[f64; 2]; 2],
    pieces: usize,
) -> f64 {
    let points = |[a, b]: [f64; 2]| {
        let half = 0.5 * (b - a) / pieces as f64;
        let piece = move |k: usize| GAUSS.map(|(x, w)| (a + half * (2 * k + 1) as f64 + half * x, w));
        (0..pieces).flat_map(piece).collect::<Vec<_>>()
    };
    let (mut sum, mut weights) = (0.0, 0.0);
    for (theta, w) in points(theta) {
        for &(phi, v) in &points(phi) {
            let wo = direction(theta, phi);
            let weight = w * v * wo.z * theta.sin();
            weights += weight;
            sum += weight * model.diffuse(wi, wo, masking);
        }
    }
    sum / weights
}

#[test]
fn matt_bins_are_means_over_the_bin() {
    let wi = direction_deg(65.0, 40.0);
    for ndf in [Ndf::Ggx, Ndf::Beckmann] {
        let model = Microfacet { ndf, alpha_x: 0.7, alpha_y: 0.3, rotation: 0.5 };
        for (theta, phi, masking) in [
            ([0.0, 0.1], [0.3, 0.6], Masking::Separable),
            ([0.8, 0.9], [3.7, 4.0], Masking::HeightCorrelated),
            ([1.45, FRAC_PI_2], [0.4, 0.6], Masking::HeightCorrelated),
            ([1.1, 1.2], [0.7, 0.9], Masking::DirectionCorrelated),
        ] {
            let region = Region::Rectangle { theta, phi };
            let found = diffuse_means(&model, &[masking], &[(wi, 1.0)], &[region], None)[0][0];
            // The kink of the direction-correlated masking costs the rule its order: more pieces. Twice as many change what is
            // expected by less than a fifth of what is allowed, which is the bin's own precision, and five times it at the kink.
            let kinked = masking == Masking::DirectionCorrelated;
            let (pieces, room) = if kinked { (4, 5e-5) } else { (1, 1e-5) };
            let [rough, expected] =
                [pieces, 2 * pieces].map(|n| gauss_mean(&model, wi, masking, [theta, phi], n));
            assert!((rough / expected - 1.0).abs() < 0.2 * room, "{ndf:?} {theta:?}: {rough} {expected}");
            assert!(
                (found / expected - 1.0).abs() < room,
                "{ndf:?} {theta:?} {masking:?}: {found} {expected}"
            );
        }
    }
}

/// Every facet that the light sees sends all of it on: what is neither masked from the sensor nor sent down is reflected.
#[test]
fn matt_surfaces_reflect_no_more_than_they_get() {
    let whole = Region::Rectangle { theta: [0.0, FRAC_PI_2], phi: [0.0, TAU] };
    for alpha in [1e-3, 0.3, 1.0] {
        for theta_i in [0.0, 50.0, 80.0] {
            let model = Microfacet::isotropic(Ndf::Ggx, alpha);
            let source = [(direction_deg(theta_i, 0.0), 1.0)];
            let albedos =
                diffuse_means(&model, &Masking::ALL[1..], &source, &[whole], None)[0].map(|mean| PI * mean);
            assert!(albedos[0] <= albedos[1] && albedos[1] <= albedos[2] && albedos[2] < 1.0, "{albedos:?}");
            // A nearly smooth surface is Lambert's, all but facets of slope 1 and more: alpha.
            assert!(alpha > 0.1 || albedos[1] > 0.99, "{albedos:?}");
        }
    }
}

#[test]
fn a_statistical_matt_surface_reflects_what_theory_says() {
    let text = "name = \"matt\"\nseed = 9\n[surface]\nrealisations = 16\n[surface.smith]\nalpha = 0.5\nndf = \"ggx\"\n\
                heights = \"correlated\"\n[optics]\nfacet = \"diffuse\"\nalbedo = 0.5\n[light]\ntheta_i_deg = [0, 60]\n\
                [sensor.hemisphere]\nbins = \"aligned\"\n[trace]\nbounces = 16\n[stop]\nsamples = 65536\n";
    let campaign = campaign::parse(text, "matt", Path::new(".")).expect("a good campaign").campaign;
    let plan = plan(&campaign).expect("it fits");
    let patches = Patches::prepare(&campaign, &mut Vec::new()).expect("nothing to load");
    let (mut measured, _) = measure(&campaign, &plan, &patches, &|_| {}).expect("no path is lost");
    let measured = measured.pop().expect("one roughness");
    let table = &measured.table;
    let prediction = Prediction::of(&measured.campaign, &table.grid).expect("a model");
    let at = prediction.model.masking_index(Some("height_correlated"));
    for incidence in 0..table.grid.incidences() {
        let (sizes, bins) = (table.grid.sizes(incidence), table.grid.bins());
        let theory = &prediction.means[incidence].values[at][0];
        let (mut found, mut expected) = (0.0, 0.0);
        for bin in 0..bins {
            found += sizes[bin] * f64::from(table.colours[0].single[incidence * bins + bin]);
            expected += sizes[bin] * theory[bin];
            // A bin has n = 2^20 FRAC_1_PI sizes arrivals or a few times fewer: 6 standard errors of a Poisson count.
            let se = 0.5 * (sizes[bin] * FRAC_1_PI / 1_048_576.0).sqrt();
            let difference =
                sizes[bin] * (f64::from(table.colours[0].single[incidence * bins + bin]) - theory[bin]);
            assert!(difference.abs() < 8.0 * se, "{incidence} {bin}: {difference} {se}");
        }
        // Half of a share of 2^20 samples: 4.5 standard errors are below 4.5 * 0.25/2^10.
        assert!((found - expected).abs() < 1.1e-3, "{incidence}: {found} {expected}");
    }
}
