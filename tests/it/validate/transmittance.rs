//! Promise: what theory says goes through a clear surface obeys energy, its limits, and the sensor's bins.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use glam::DVec3;
use gonio::campaign;
use gonio::instrument::{Region, grid_of};
use gonio::measure::{Patches, measure, plan};
use gonio::optics::reflectance::Reflectance;
use gonio::optics::{Fresnel, facet};
use gonio::sphere::direction_deg;
use gonio::theory::transmission::g2_opposite;
use gonio::theory::{Masking, Microfacet, Ndf};
use gonio::validate::prediction::model::Model;
use gonio::validate::{BinMeans, Prediction, albedo, transmittance};

const LAWS: [Ndf; 2] = [Ndf::Ggx, Ndf::Beckmann];

/// Through a faint interface light goes straight on, whatever facet it meets: those that it sees fill (1 + Li) of its
/// view, and each is seen from behind by G2(-wi). Without masking that is more light than there is.
#[test]
fn faint_interfaces_let_all_through_that_is_not_masked() {
    let d = 1e-6;
    for ndf in LAWS {
        for (alpha_x, alpha_y) in [(0.1, 0.1), (0.5, 0.5), (0.3, 1.0)] {
            for theta_i_deg in [0.0, 40.0, 70.0] {
                let model = Microfacet { ndf, alpha_x, alpha_y, rotation: 0.3 };
                let wi = direction_deg(theta_i_deg, 20.0);
                let side = model.side(model.to_sample(wi));
                for masking in Masking::ALL {
                    let expected = (1.0 + side.lambda()) * g2_opposite(masking, &side, &side);
                    for eta in [1.0 + d, 1.0 / (1.0 + d)] {
                        let found = transmittance(&model, wi, masking, eta).value;
                        // A facet at c turns light by d tan and reflects (d/2c^2)^2; those that are met so flat that this
                        // matters, c^2 < d, fill a share of d at most. Ten for the slopes' size.
                        assert!(
                            (found - expected).abs() < 10.0 * d,
                            "{model:?} {theta_i_deg} {masking:?} {eta}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }
}

/// The flux above the horizon with Fresnel's equations.
fn reflected(model: &Microfacet, wi: DVec3, masking: Masking, eta: f64) -> f64 {
    let reflectance = Reflectance::unpolarised(Fresnel::Dielectric { eta });
    albedo(model, wi, masking, Some(reflectance))[1].value
}

#[test]
fn clear_surfaces_send_on_no_more_than_they_get() {
    for ndf in LAWS {
        for alpha in [1e-3, 0.05, 0.3, 1.0] {
            for eta in [1.01, 1.5, 2.4, 1.0 / 1.5] {
                for theta_i_deg in [0.0, 30.0, 60.0, 85.0] {
                    let (model, wi) = (Microfacet::isotropic(ndf, alpha), direction_deg(theta_i_deg, 10.0));
                    let [separable, correlated] =
                        [Masking::Separable, Masking::HeightCorrelated].map(|masking| {
                            reflected(&model, wi, masking, eta)
                                + transmittance(&model, wi, masking, eta).value
                        });
                    // The cubature's 1e-6 of what is reflected.
                    assert!(
                        separable <= 1.0 + 1e-6 && correlated <= 1.0 + 1e-6,
                        "{model:?} {eta} {theta_i_deg}"
                    );
                    // Next to nothing of a nearly smooth surface is masked, but light that grazes: 1 - G2 is Lambda's size,
                    // alpha^2 tan^2/4 of GGX on each side, and tails of slopes that leave the view are as rare.
                    if alpha == 1e-3 && theta_i_deg < 80.0 {
                        assert!((correlated - 1.0).abs() < 1e-4, "{eta} {theta_i_deg}: {correlated}");
                    }
                }
            }
        }
    }
}

/// The mean of f_t by n x n midpoints over a cap, in (psi^2, eta).
fn midpoint_mean(model: &Microfacet, wi: DVec3, (axis, half_angle): (DVec3, f64), eta: f64) -> f64 {
    let (across, along) = axis.any_orthonormal_pair();
    let n = 1000;
    let (mut sum, mut weights) = (0.0, 0.0);
    for i in 0..n {
        let psi = half_angle * ((f64::from(i) + 0.5) / f64::from(n)).sqrt();
        for j in 0..n {
            let (sin, cos) = (TAU * (f64::from(j) + 0.5) / f64::from(n)).sin_cos();
            let wo = axis * psi.cos() + (across * cos + along * sin) * psi.sin();
            let weight = psi.sin() / psi * -wo.z;
            weights += weight;
            sum += weight * model.btdf(wi, wo, Masking::HeightCorrelated, eta);
        }
    }
    sum / weights
}

#[test]
fn caps_are_cut_where_normals_end() {
    let wi = direction_deg(30.0, 0.0);
    let model = Microfacet { ndf: Ndf::Ggx, alpha_x: 0.4, alpha_y: 0.4, rotation: 0.2 };
    // Facets face up within |cos_o| > cos_i/eta: 54.7 degrees from the nadir at eta 1.5, and the other way round.
    for (theta_deg, eta) in [(125.0, 1.5), (126.5, 1.5), (150.0, 1.5), (118.0, 1.0 / 1.5)] {
        let (axis, half_angle) = (direction_deg(theta_deg, 185.0), 0.06);
        let region = Region::Cap { axis, half_angle };
        let found = BinMeans::new(vec![Masking::HeightCorrelated]);
        let found = found.evaluate_through(&model, &[(wi, 1.0)], &[region], eta)[0];
        let expected = midpoint_mean(&model, wi, (axis, half_angle), eta);
        // Of the midpoints a row along the jump is on one side or the other: a few times 1/n^(3/2).
        assert!((found.values[0] / expected - 1.0).abs() < 2e-4, "{theta_deg}: {found:?} {expected}");
        assert!(found.error < 1e-5 * found.values[0], "{theta_deg}: {found:?}");
    }
}

#[test]
fn a_cap_about_the_nadir_is_a_ring() {
    let model = Microfacet { ndf: Ndf::Beckmann, alpha_x: 0.3, alpha_y: 0.1, rotation: 0.3 };
    let cap = Region::Cap { axis: -DVec3::Z, half_angle: 0.2 };
    let ring = Region::Rectangle { theta: [PI - 0.2, PI], phi: [0.0, TAU] };
    let means = BinMeans::new(Masking::ALL.to_vec());
    let found = means.evaluate_through(&model, &[(direction_deg(25.0, 70.0), 1.0)], &[cap, ring], 1.3);
    for k in 0..4 {
        // Two charts of one region, each to its own precision of 1e-6.
        assert!((found[0].values[k] / found[1].values[k] - 1.0).abs() < 2e-6, "{k}: {found:?}");
    }
}

fn campaign_of(surface: &str, optics: &str, arms: &str) -> campaign::Campaign {
    let text = format!(
        "name = \"clear\"\nseed = 5\n{surface}\n[optics]\n{optics}\n[trace]\nbounces = 16\n[stop]\nsamples = 65536\n{arms}"
    );
    campaign::parse(&text, "clear", Path::new(".")).expect("a good campaign").campaign
}

const GLASS: &str = "facet = \"dielectric\"\neta = 1.5";
const BOTH: &str = "[light]\ntheta_i_deg = [0, 50]\n[sensor.hemisphere]\nside = \"both\"\nbins = \"aligned\"";

#[test]
fn a_flat_clear_surface_refracts() {
    let campaign = campaign_of("[surface.mirror]", GLASS, BOTH);
    let grid = grid_of(&campaign);
    let model = Model::of(&campaign).expect("a mirror");
    for (incidence, means) in model.means(&campaign, &grid).into_iter().enumerate() {
        let (values, regions) = (means.values, grid.regions(incidence));
        let wi = grid.wi(incidence);
        let split = facet::split(wi, DVec3::Z, 1.5);
        let flux = |below: bool| -> f64 {
            let bins = values[0][0].iter().zip(&regions).filter(|(_, region)| region.is_below() == below);
            bins.map(|(value, region)| value * region.projected_solid_angle()).sum()
        };
        // A product and a quotient.
        assert!((flux(false) - split.reflectance).abs() < 1e-15);
        assert!((flux(true) + split.reflectance - 1.0).abs() < 1e-15);
        let brightest = values[0][0].iter().zip(&regions).filter(|(_, region)| region.is_below());
        let (_, region) = brightest.max_by(|a, b| a.0.total_cmp(b.0)).expect("bins below");
        let Region::Rectangle { theta: [t1, t2], .. } = region else { panic!("rectangles") };
        let theta = (-split.refracted.expect("a way").z).acos();
        assert!((PI - t2..=PI - t1).contains(&theta), "{t1} {t2} {theta}");
    }
}

/// Samples of an incidence, over all realisations.
const ARRIVALS: f64 = 16.0 * 65536.0;

fn mean_and_se(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (square / (n * (n - 1.0))).sqrt())
}

#[test]
fn a_statistical_surface_lets_through_what_theory_says() {
    let surface =
        "[surface]\nrealisations = 16\n[surface.smith]\nalpha = 0.4\nndf = \"ggx\"\nheights = \"correlated\"";
    let campaign = campaign_of(surface, GLASS, BOTH);
    let plan = plan(&campaign).expect("it fits");
    let patches = Patches::prepare(&campaign, &mut Vec::new()).expect("nothing to load");
    let (mut measured, _) = measure(&campaign, &plan, &patches, &|_| {}).expect("no path is lost");
    let measured = measured.pop().expect("one roughness");
    let prediction = Prediction::of(&measured.campaign, &measured.table.grid).expect("a model");
    let at = prediction.model.masking_index(Some("height_correlated"));
    let mut judged = 0;
    for incidence in 0..measured.table.grid.incidences() {
        let (sizes, bins) = (measured.table.grid.sizes(incidence), measured.table.grid.bins());
        let theory = &prediction.means[incidence].values[at][0];
        let below = measured.table.grid.regions(incidence).iter().map(Region::is_below).collect::<Vec<_>>();
        let (mut found, mut expected) = (0.0, 0.0);
        for bin in (0..bins).filter(|&bin| below[bin]) {
            let parts = measured.realisations.parts.iter();
            let parts = parts.map(|part| sizes[bin] * f64::from(part.single[0][incidence * bins + bin]));
            let (mean, se) = mean_and_se(parts);
            let predicted = sizes[bin] * theory[bin];
            (found, expected) = (found + mean, expected + predicted);
            // Light goes one way or the other: a bin has a whole number of arrivals. From a hundred on its 16 means are
            // normal enough for Student's t of 15 degrees of freedom, beyond 6.5 in one of 900 bins by chance: 1 %.
            if predicted * ARRIVALS > 100.0 {
                assert!((mean - predicted).abs() < 6.5 * se, "{incidence} {bin}: {mean} {predicted} {se}");
                judged += 1;
            }
        }
        // A share of 2^20 samples: 4.5 standard errors are below 4.5 * 0.5/2^10.
        assert!((found - expected).abs() < 2.2e-3, "{incidence}: {found} {expected}");
    }
    assert!(judged > 400, "{judged}");
}

#[test]
fn what_goes_through_grooves_and_grains_is_not_predicted() {
    let both = BOTH.replace("[light]", "[light]\nphi_i_deg = [0]");
    let reflection =
        "[light]\nphi_i_deg = [0]\ntheta_i_deg = [0, 50]\n[sensor.hemisphere]\nbins = \"aligned\"";
    let groove = "[surface.v_groove]\nslope = 0.5";
    assert!(Model::of(&campaign_of(groove, GLASS, &both)).is_none());
    let model = Model::of(&campaign_of(groove, GLASS, reflection)).expect("what is reflected is known");
    assert_eq!(model.name(), "torrance_sparrow");
}
