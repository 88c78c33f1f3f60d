//! Promise: the analytic means over bins are right to 1e-6 of the incidence's flux, wherever the lobe hides.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;
use std::sync::LazyLock;

use glam::DVec3;
use gonio::campaign;
use gonio::instrument::{AlikeBins, Grid, GridKind, Region, SurfaceSymmetry, grid_of};
use gonio::optics::{FacetAngle, Fresnel};
use gonio::sphere::{direction, direction_deg};
use gonio::theory::smith::{g2_correlated, g2_separable};
use gonio::theory::{Masking, Microfacet, Ndf};
use gonio::validate::prediction::model::Model;
use gonio::validate::{BinMean, BinMeans, albedo, source_nodes};

use crate::support::long::or_long;

const LAWS: [Ndf; 2] = [Ndf::Ggx, Ndf::Beckmann];

/// Aligned bins, or edges of theta and phi that agree with nothing in the model.
fn regions(rows: usize, columns: usize, first_phi_deg: f64) -> Vec<Region> {
    let edges = |n: usize, full: f64, first: f64| -> Vec<f64> {
        (0..=n).map(|k| first + full * k as f64 / n as f64).collect()
    };
    let grid = Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: vec![0.0],
        phi_i_deg: vec![0.0],
        phi_r_relative: false,
        theta_r_edges_deg: edges(rows, 90.0, 0.0),
        phi_r_edges_deg: edges(columns, 360.0, first_phi_deg),
        ..Grid::default()
    };
    grid.regions(0)
}

fn means(model: &Microfacet, wi: DVec3, maskings: &[Masking], regions: &[Region]) -> Vec<BinMean> {
    BinMeans::new(maskings.to_vec()).evaluate(model, &[(wi, 1.0)], regions)
}

/// The bins' flux together, per masking.
fn total(model: &Microfacet, wi: DVec3, maskings: &[Masking], regions: &[Region]) -> Vec<f64> {
    let found = means(model, wi, maskings, regions);
    let flux = |k: usize| found.iter().zip(regions).map(|(m, r)| m.unit[k] * r.projected_solid_angle()).sum();
    (0..maskings.len()).map(flux).collect()
}

const SMOOTH: [Masking; 2] = [Masking::Separable, Masking::HeightCorrelated];

/// (model, wi, albedo separable, albedo height-correlated).
fn reference_albedos() -> Vec<(Microfacet, DVec3, [f64; 2])> {
    let mut reader = csv::Reader::from_path("tests/data/reference_albedo.csv").expect("the reference file");
    let rows = reader.records().map(|record| {
        let record = record.expect("a row");
        let number = |k: usize| record[k].parse::<f64>().expect("a number");
        let model = Microfacet { ndf: Ndf::Ggx, alpha_x: number(0), alpha_y: number(1), rotation: 0.0 };
        (model, direction_deg(number(2), number(3)), [number(4), number(5)])
    });
    rows.collect()
}

#[test]
fn bins_add_up_to_the_reference_albedo() {
    let rows = reference_albedos();
    assert_eq!(rows.len(), 108);
    // Fine bins cost most: a quarter of the rows, of all roughnesses and angles, do for them.
    for (regions, step) in [(regions(18, 36, 0.0), or_long(4, 1)), (regions(7, 5, -11.3), 1)] {
        for (model, wi, expected) in rows.iter().step_by(step) {
            let found = total(model, *wi, &SMOOTH, &regions);
            for k in 0..2 {
                // The orders agree to 1e-6 of a bin or to 1e-9, and order 15 is far closer: 5e-11 at worst, measured.
                assert!((found[k] - expected[k]).abs() < 1e-10, "{model:?} {wi}: {found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn albedo_matches_the_reference() {
    for (model, wi, expected) in reference_albedos() {
        for k in 0..2 {
            // Orders that agree to 1e-8, and the higher one is far closer; the reference has 13 digits.
            let [unit, schlick] = albedo(&model, wi, SMOOTH[k], None).map(|estimate| estimate.value);
            assert!((unit - expected[k]).abs() < 1e-10, "{model:?} {wi}: {unit} {expected:?}");
            assert!(schlick > 0.0 && schlick < unit);
        }
    }
    // Closed form at alpha 1, normal incidence: 1 - ln 2.
    let rough = Microfacet::isotropic(Ndf::Ggx, 1.0);
    let unit = albedo(&rough, DVec3::Z, Masking::HeightCorrelated, None)[0].value;
    assert!((unit - (1.0 - 2f64.ln())).abs() < 1e-9, "{unit}");
}

/// Double exponential nodes on [a, b]: dense at both ends.
fn tanh_sinh(a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> {
    // On [-1, 1], the same for all.
    static NODES: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
        let step = 1.0 / 96.0;
        let node = |k: i32| {
            let t = step * f64::from(k);
            let s = FRAC_PI_2 * t.sinh();
            (1.0 + s.tanh(), step * FRAC_PI_2 * t.cosh() / s.cosh().powi(2))
        };
        (-312..=312).map(node).collect()
    });
    let half = 0.5 * (b - a);
    NODES.iter().map(move |&(place, weight)| (a + half * place, half * weight))
}

/// The albedo by another road, for light at phi = 0: the integral over the facets' slopes (p, q) of
/// p22 (wi.m)/(m.z cos_i) G2, over those slopes that mirror the light above the horizon. The condition
/// 2 (wi.m) m.z > cos_i is a quadratic in p, so the domain is known in closed form. Canonical slopes P = sinh x,
/// Q = sinh y, symmetric in y, the range of x cut at the peak, that of y where the peak leaves, double exponential rules in both.
fn albedo_over_slopes(model: &Microfacet, theta_i_deg: f64) -> [f64; 2] {
    let wi = direction_deg(theta_i_deg, 0.0);
    let i = model.side(wi);
    let mut sums = [0.0; 2];
    // At q = 1 the peak leaves the domain, within a width of alpha_x: a narrow step if alpha_x is small.
    let [step, end] = [1.0, 1.0 / wi.z].map(|q| (q / model.alpha_y).asinh());
    for (y, dy) in tanh_sinh(0.0, step).chain(tanh_sinh(step, end)) {
        let q = model.alpha_y * y.sinh();
        let root = (1.0 - (q * wi.z).powi(2)).max(0.0).sqrt();
        // The last node of y may round onto the end of the domain, where at normal incidence both vanish.
        let highest = if wi.x + root > 0.0 { wi.z * (1.0 - q * q) / (wi.x + root) } else { 0.0 };
        let ends = [-(wi.x + root) / wi.z, highest].map(|p| (p / model.alpha_x).asinh());
        let pieces = if ends[1] > 0.0 { vec![[ends[0], 0.0], [0.0, ends[1]]] } else { vec![ends] };
        for (x, dx) in pieces.iter().flat_map(|&[a, b]| tanh_sinh(a, b)) {
            let e = x.exp_m1();
            // sinh x and cosh x of one exponential, each to its last digits.
            let sinh_x = 0.5 * (e + e / (e + 1.0));
            let cosh_x = 1.0 + 0.5 * e * e / (e + 1.0);
            let p = model.alpha_x * sinh_x;
            let r2 = sinh_x.powi(2) + y.sinh().powi(2);
            let p22 = match model.ndf {
                Ndf::Ggx => 1.0 / (PI * (1.0 + r2).powi(2)),
                Ndf::Beckmann => (-r2).exp() / PI,
                student => {
                    let gamma = student.gamma(model.alpha_x * model.alpha_y);
                    (1.0 + r2 / (gamma - 1.0)).powf(-gamma) / PI
                }
            };
            let towards = wi.z - wi.x * p; // (wi.m)/m.z with m = (-p, -q, 1)/|...|, turned to rise along the light
            let mz2 = 1.0 / (1.0 + p * p + q * q);
            let wo = DVec3::new(
                -2.0 * towards * mz2 * p - wi.x,
                -2.0 * towards * mz2 * q,
                2.0 * towards * mz2 - wi.z,
            );
            if wo.z <= 0.0 || towards <= 0.0 {
                continue; // rounding at the rim
            }
            let o = model.side(wo);
            let weight = 2.0 * p22 * towards / wi.z * cosh_x * y.cosh() * dx * dy;
            sums[0] += weight * g2_separable(&i, &o);
            sums[1] += weight * g2_correlated(&i, &o);
        }
    }
    sums
}

#[test]
fn a_lobe_of_a_ten_thousandth_is_found() {
    let bins = regions(18, 36, -5.0);
    for ndf in LAWS {
        let model = Microfacet::isotropic(ndf, 1e-4);
        for theta_i_deg in [0.0, 1e-6, 60.0, 89.0, 89.99] {
            let found = total(&model, direction_deg(theta_i_deg, 0.0), &SMOOTH, &bins);
            let expected = albedo_over_slopes(&model, theta_i_deg);
            for k in 0..2 {
                // 1e-6 of the few bins that hold the lobe; at 89.99 degrees the azimuth, known to 2e-16, is divided
                // by a lobe 2e-8 wide.
                assert!(
                    (found[k] - expected[k]).abs() < 1e-7,
                    "{model:?} {theta_i_deg}: {found:?} {expected:?}"
                );
            }
            assert!(theta_i_deg > 80.0 || (1.0 - found[0]).abs() < 1e-7);
        }
    }
}

#[test]
fn a_ridge_ten_thousand_times_longer_than_wide_is_found() {
    let bins = regions(18, 36, -5.0);
    for ndf in LAWS {
        for (alpha_x, alpha_y) in [(1.0, 1e-4), (1e-4, 1.0), (10.0, 1e-3)] {
            let model = Microfacet { ndf, alpha_x, alpha_y, rotation: 0.0 };
            for theta_i_deg in [0.0, 60.0, 89.99] {
                let found = total(&model, direction_deg(theta_i_deg, 0.0), &SMOOTH, &bins);
                let expected = albedo_over_slopes(&model, theta_i_deg);
                for k in 0..2 {
                    // As above; halving the step of the rule over slopes moves it by less than 2e-9.
                    assert!(
                        (found[k] - expected[k]).abs() < 1e-7,
                        "{model:?} {theta_i_deg}: {found:?} {expected:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn two_grids_hold_the_same_light_under_every_masking() {
    let (aligned, odd) = (regions(6, 9, 0.0), regions(3, 5, -11.3));
    let mut turn = false;
    for ndf in LAWS {
        for (alpha_x, alpha_y, rotation) in
            [(0.3, 0.3, 0.0), (0.5, 0.1, 0.4), (1.0, 1e-4, 0.0), (1e-4, 1e-4, 1.0)]
        {
            let model = Microfacet { ndf, alpha_x, alpha_y, rotation };
            // One light a law, the other with the next model; with GONIO_LONG=1 both.
            turn = !turn;
            let lights = [(30.0, 37.0), (80.0, 200.0)];
            let at = usize::from(turn == (ndf == Ndf::Ggx));
            for &(theta_i_deg, phi_i_deg) in or_long(&lights[at..=at], &lights[..]) {
                let wi = direction_deg(theta_i_deg, phi_i_deg);
                let a = total(&model, wi, &Masking::ALL, &aligned);
                let b = total(&model, wi, &Masking::ALL, &odd);
                for k in 0..4 {
                    // The orders agree to 1e-5 at the kinks of the direction-correlated masking, to 1e-6 elsewhere.
                    let tolerance = if k == 3 { 1e-6 } else { 1e-7 } * a[k];
                    assert!((a[k] - b[k]).abs() < tolerance, "{model:?} {wi} {k}: {a:?} {b:?}");
                }
                let room = 1.0 + 1e-6; // the precision of the cubature
                assert!(a[1] <= a[2] * room && a[2] <= a[3] * room && a[3] <= room, "{model:?} {wi}: {a:?}");
            }
        }
    }
}

#[test]
fn no_masked_model_reflects_more_than_it_gets() {
    for ndf in LAWS {
        for alpha in [1e-4, 0.01, 0.3, 1.0, 2.0, 10.0] {
            for theta_i_deg in [0.0, 45.0, 80.0, 89.0, 89.99] {
                let model = Microfacet { ndf, alpha_x: alpha, alpha_y: 0.5 * alpha, rotation: 0.2 };
                for masking in &Masking::ALL[1..] {
                    let unit = albedo(&model, direction_deg(theta_i_deg, 30.0), *masking, None)[0].value;
                    // The cubature's own precision on top of the inequality: kinks cost the last masking some.
                    let room = if *masking == Masking::DirectionCorrelated { 1e-6 } else { 1e-9 };
                    assert!(unit <= 1.0 + room, "{model:?} {theta_i_deg} {masking:?}: {unit}");
                }
            }
        }
    }
}

/// The mean of f over a region by n x n midpoints in (theta, phi), weight cos sin.
fn midpoint_mean(model: &Microfacet, wi: DVec3, masking: Masking, region: Region) -> [f64; 2] {
    let Region::Rectangle { theta, phi } = region else { panic!("rectangles only") };
    let n = 400;
    let at = |[a, b]: [f64; 2], k: usize| a + (b - a) * (k as f64 + 0.5) / n as f64;
    let (mut sums, mut weights) = ([0.0; 2], 0.0);
    for i in 0..n {
        for j in 0..n {
            let wo = direction(at(theta, i), at(phi, j));
            let weight = wo.z * at(theta, i).sin();
            let f = model.brdf(wi, wo, masking, &Fresnel::Perfect);
            weights += weight;
            sums[0] += weight * f;
            sums[1] += weight * f * FacetAngle::of_pair(wi, wo).one_minus_cos().powi(5);
        }
    }
    sums.map(|sum| sum / weights)
}

#[test]
fn a_bin_mean_is_the_mean_over_the_bin() {
    let wi = direction_deg(55.0, 40.0);
    let bins = regions(9, 18, 3.0);
    for ndf in LAWS {
        let model = Microfacet { ndf, alpha_x: 0.4, alpha_y: 0.2, rotation: 0.7 };
        let found = means(&model, wi, &Masking::ALL, &bins);
        for bin in [0, 9, 50, 101, 110, 120, 161] {
            for (k, &masking) in Masking::ALL.iter().enumerate() {
                let [unit, schlick] = midpoint_mean(&model, wi, masking, bins[bin]);
                // Midpoint error: second derivatives of a lobe 0.2 wide over steps of 1e-3, (5e-3)^2/24, times ten.
                let near = |a: f64, b: f64| (a - b).abs() < 2e-5 * b + 1e-12;
                assert!(
                    near(found[bin].unit[k], unit),
                    "{ndf:?} {bin} {masking:?}: {} {unit}",
                    found[bin].unit[k]
                );
                assert!(near(found[bin].schlick[k], schlick), "{ndf:?} {bin} {masking:?}");
                assert!(near(found[bin].with_f0(k, 0.04), 0.04 * unit + 0.96 * schlick));
            }
        }
    }
}

#[test]
fn a_caps_mean_tends_to_the_point_value_with_the_aperture_squared() {
    let wi = direction_deg(40.0, 10.0);
    for rotation in [0.0, 0.6] {
        let model = Microfacet { ndf: Ndf::Ggx, alpha_x: 0.3, alpha_y: 0.15, rotation };
        for axis in [direction_deg(45.0, 200.0), direction_deg(0.0, 0.0), direction_deg(70.0, 100.0)] {
            let at =
                |half_angle: f64| means(&model, wi, &SMOOTH, &[Region::Cap { axis, half_angle }])[0].unit[1];
            let point = model.brdf(wi, axis, Masking::HeightCorrelated, &Fresnel::Perfect);
            // Four roundings more than the product itself.
            assert!((at(0.0) - point).abs() < 8.0 * f64::EPSILON * point);
            let (wide, narrow) = (at(0.01) - point, at(0.005) - point);
            // The next order is (aperture/alpha)^2 smaller: 0.5 %, times a factor of order 10.
            assert!((wide / narrow - 4.0).abs() < 0.2, "{axis}: {wide} {narrow}");
        }
    }
}

#[test]
fn a_cap_about_the_normal_is_a_ring() {
    let model = Microfacet { ndf: Ndf::Beckmann, alpha_x: 0.3, alpha_y: 0.1, rotation: 0.3 };
    let wi = direction_deg(25.0, 70.0);
    let cap = Region::Cap { axis: DVec3::Z, half_angle: 0.2 };
    let ring = Region::Rectangle { theta: [0.0, 0.2], phi: [0.0, TAU] };
    let found = means(&model, wi, &Masking::ALL, &[cap, ring]);
    for k in 0..4 {
        // Two charts of one region, each to its own precision of 1e-6 (1e-5 at kinks).
        assert!((found[0].unit[k] / found[1].unit[k] - 1.0).abs() < 2e-6, "{k}: {found:?}");
    }
}

#[test]
fn bins_that_mirror_each_other_have_equal_means() {
    for ndf in LAWS {
        let model = Microfacet { ndf, alpha_x: 0.3, alpha_y: 0.1, rotation: 0.0 };
        let wi = direction_deg(60.0, 0.0);
        for (a, b) in [(0.3, 0.5), (2.9, 3.1), (1.2, 2.0)] {
            let bin = |phi| Region::Rectangle { theta: [0.9, 1.1], phi };
            let found = means(&model, wi, &Masking::ALL, &[bin([a, b]), bin([-b, -a])]);
            for k in 0..4 {
                // Mirrored nodes up to their rounding, unless a cut falls otherwise: the precision of the cubature.
                assert!((found[0].unit[k] / found[1].unit[k] - 1.0).abs() < 1e-7, "{ndf:?} {a}: {found:?}");
            }
        }
    }
}

/// The surface's law is the same when it is mirrored about the plane of incidence (of one roughness) or about its axes: bins that
/// are alike are worked out once.
#[test]
fn alike_bins_have_the_means_of_each_by_itself() {
    let campaign = |surface: &str, light: &str, sensor: &str| {
        let text =
            format!("name = \"alike\"\n{surface}\n[light]\n{light}\n{sensor}\n[stop]\nsamples = 65536\n");
        campaign::parse(&text, "alike", Path::new(".")).expect("a good campaign").campaign
    };
    let bins = "[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 10\nbins = \"aligned\"";
    let arm = "[sensor.arm]\ntheta_r_deg = [-60, 10, 45]\nphi_r_deg = [0, 20, 90]\naperture_deg = 3";
    let brushed = "[surface]\nrotation_deg = 18\n[surface.ggx]\nalpha_x = 0.15\nalpha_y = 0.5";
    let even = "[surface.beckmann]\nalpha = 0.3";
    let all_round = "theta_i_deg = [0, 50]\nphi_i_deg = [18, 48, 108, 348]";
    // Along an axis, and not.
    let both = "theta_i_deg = [0, 50]\nphi_i_deg = [18, 48]";
    for (campaign, covers_all) in [
        (campaign(brushed, all_round, bins), true),
        (campaign(brushed, &format!("{both}\naperture_deg = 2"), arm), false),
        (campaign(even, both, arm), false),
        (campaign(even, "theta_i_deg = [0, 50]", bins), true),
    ] {
        let (grid, model) = (grid_of(&campaign), Model::of(&campaign).expect("a law"));
        let Model::Microfacet { surface, ref maskings, .. } = model else {
            panic!("facets that are mirrors")
        };
        let symmetry = if surface.is_isotropic() {
            SurfaceSymmetry::Isotropic
        } else {
            SurfaceSymmetry::Axes(surface.rotation)
        };
        for (incidence, found) in model.means(&campaign, &grid).iter().enumerate() {
            let (theta, phi) = grid.incidence_deg(incidence);
            let has_images = surface.is_isotropic() || theta == 0.0 || (phi - 18.0) % 90.0 == 0.0;
            let distinct = AlikeBins::of(&grid, incidence, symmetry).regions.len();
            assert!(!covers_all || (distinct < grid.bins()) == has_images, "{theta} {phi}: {distinct}");
            let source = source_nodes(grid.wi(incidence), campaign.light.aperture_deg.to_radians(), 6);
            let wanted =
                BinMeans::new(maskings.clone()).evaluate(&surface, &source, &grid.regions(incidence));
            for (bin, wanted) in wanted.iter().enumerate() {
                for (k, found) in found.values.iter().enumerate() {
                    // Each is right to 1e-5 (the kinked masking's) of the bin or 1e-9 of the flux, in bins of 0.01 sr and
                    // more; nodes of the light's aperture lie elsewhere under light along the normal, of which the docs say 1e-4 at most.
                    let (found, wanted) = (found[0][bin], wanted.unit[k]);
                    let few = if campaign.light.aperture_deg > 0.0 { 1e-4 } else { 2e-5 };
                    assert!(
                        (found - wanted).abs() <= few * wanted + 2e-7,
                        "{incidence} {bin} {k}: {found} {wanted}"
                    );
                }
            }
        }
    }
}

#[test]
fn source_nodes_integrate_the_cone() {
    for (theta_deg, half_angle) in [(0.0, 0.1), (50.0, 0.2), (80.0, 0.17)] {
        let axis = direction_deg(theta_deg, 25.0);
        let nodes = source_nodes(axis, half_angle, 6);
        let weights: f64 = nodes.iter().map(|(_, weight)| weight).sum();
        let mean: DVec3 = nodes.iter().map(|&(w, weight)| w * weight).sum();
        // Integral of w w^T over the cone: along the axis 2 pi (1 - c^3)/3, across pi (2/3 - c + c^3/3); its product
        // with the normal, over the projected solid angle pi sin^2 axis.z, is the mean direction.
        let c = half_angle.cos();
        let along = 2.0 * PI * (1.0 - c.powi(3)) / 3.0;
        let across = PI * (2.0 / 3.0 - c + c.powi(3) / 3.0);
        let normal = axis * (along * axis.z) + (DVec3::Z - axis * axis.z) * across;
        let expected = normal / (PI * half_angle.sin().powi(2) * axis.z);
        // `across` is a difference of numbers near 1 that leaves half_angle^4/4, over half_angle^2 axis.z: 1e-12.
        assert!((weights - 1.0).abs() < 1e-14 && nodes.iter().all(|&(_, weight)| weight > 0.0));
        assert!(mean.distance(expected) < 1e-12, "{theta_deg}: {mean} {expected}");
    }
    assert_eq!(source_nodes(DVec3::Z, 0.0, 4), vec![(DVec3::Z, 1.0)]);
}

#[test]
fn more_source_nodes_change_nothing() {
    let model = Microfacet { ndf: Ndf::Ggx, alpha_x: 0.3, alpha_y: 0.2, rotation: 0.1 };
    let axis = direction_deg(50.0, 20.0);
    let bins = regions(9, 18, 0.0);
    let at = |order| BinMeans::new(SMOOTH.to_vec()).evaluate(&model, &source_nodes(axis, 0.05, order), &bins);
    for (few, many) in at(3).iter().zip(at(6)) {
        // (aperture/alpha)^6 for order 3: below 1e-6 with the usual factor.
        assert!((few.unit[1] - many.unit[1]).abs() < 1e-6 * (1.0 + many.unit[1]), "{few:?} {many:?}");
    }
}

#[test]
fn means_are_identical_for_any_thread_count() {
    let model = Microfacet { ndf: Ndf::Ggx, alpha_x: 0.5, alpha_y: 0.01, rotation: 0.3 };
    let bins = regions(9, 18, 0.0);
    let at = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
        pool.install(|| means(&model, direction_deg(70.0, 50.0), &Masking::ALL, &bins))
    };
    let one = at(1);
    assert_eq!(one, at(2));
    assert_eq!(one, at(7));
}
