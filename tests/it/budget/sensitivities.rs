//! Promise: measured sensitivities are the derivatives of the formula on the statistical Smith surface, to 1 %.
//!
//! The formula: D F G2/(4 cos cos), its mean over the aperture by the cubature of predictions (1e-6), differentiated by
//! central differences of 0.25 degrees or 1 %: their error is h^2/6 of the third derivative, below 1e-3 of the first for a
//! lobe of 20 degrees. A sensitivity may be off by 4.5 of its own errors (4e-4 by chance of t with 15 degrees of
//! freedom), which are below 1 % here.

use std::path::Path;
use std::sync::OnceLock;

use glam::{DQuat, DVec3};
use gonio::budget::{self, response::Response};
use gonio::campaign::{self, Campaign, Parsed, Quantity};
use gonio::instrument::{Grid, GridKind};
use gonio::measure;
use gonio::sphere;
use gonio::validate::prediction::model::Model;

/// One block of paths for each realisation.
const SAMPLES: u32 = 65_536;
const APERTURE_DEG: f64 = 15.0;
const LIGHT: [f64; 2] = [30.0, 0.0];
const SENSOR: [f64; 2] = [50.0, 160.0];

fn parsed(samples: u32, eta: f64, alpha: f64, inputs: &str) -> Parsed {
    let text = format!(
        "name = \"smith\"\nseed = 5\nsurface.realisations = 16\nsurface.smith.alpha = {alpha:?}\n\
         light.theta_i_deg = [{:?}]\noptics = {{ eta = {eta:?}, k = 0.0 }}\nstop.samples = {samples}\n\
         [sensor.arm]\ntheta_r_deg = [{:?}]\nphi_r_deg = [{:?}]\naperture_deg = {APERTURE_DEG:?}\n[uncertainty]\n{inputs}",
        LIGHT[0], SENSOR[0], SENSOR[1]
    );
    campaign::parse(&text, "smith.toml", Path::new("")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn response(samples: u32, inputs: &str) -> Response {
    let Parsed { campaign, uncertainty, .. } = parsed(samples, 1.5, 0.3, inputs);
    let uncertainty = uncertainty.expect("given");
    let mut measured = budget::measure(&campaign, &uncertainty, &|_| ()).expect("measured");
    measured.responses.remove(0).remove(0)
}

/// Arms, slopes and index, measured once for all tests.
fn moved() -> &'static Response {
    static MOVED: OnceLock<Response> = OnceLock::new();
    let inputs = "lamp_theta_deg = { u = 0.1 }\nheight_scale = { u = 0.01 }\nn = { u = 0.001 }\n";
    MOVED.get_or_init(|| response(SAMPLES, inputs))
}

/// The formula's mean over an aperture.
fn mean(campaign: &Campaign, wi: DVec3, wo: DVec3) -> f64 {
    let angles = |w: DVec3| [sphere::theta(w).to_degrees(), sphere::phi(w).to_degrees()];
    let grid = Grid {
        kind: GridKind::Points,
        incidences_deg: vec![angles(wi)],
        points_deg: vec![angles(wo)],
        aperture_deg: Some(APERTURE_DEG),
        ..Grid::default()
    };
    let model = Model::of(campaign).expect("a law");
    let masking = model.maskings().iter().position(|name| *name == "height_correlated").expect("Smith's");
    model.means(campaign, &grid)[0].values[masking][0][0]
}

fn directions(light: [f64; 2], sensor: [f64; 2]) -> [DVec3; 2] {
    [light, sensor].map(|[theta, phi]| sphere::direction_deg(theta, phi))
}

#[track_caller]
fn agrees(response: &Response, quantity: Quantity, wanted: f64) {
    let input = campaign::InputQuantity {
        quantity,
        distribution: campaign::Distribution::Normal,
        scale: 0.1,
        dof: None,
        relative: false,
    };
    let found = response.sensitivity(&input).expect("measured");
    println!("{quantity:?}: {found:?}, {wanted}");
    assert!(found.error < 0.01 * wanted.abs(), "{quantity:?}: {found:?}, {wanted}");
    assert!((found.value - wanted).abs() < 4.5 * found.error, "{quantity:?}: {found:?}, {wanted}");
}

#[test]
fn sensitivities_are_those_of_the_formula() {
    let (response, h) = (moved(), 0.25);
    let campaign = parsed(1, 1.5, 0.3, "reading = { u = 0.1 }").campaign;
    let slope = |at: &dyn Fn(f64) -> [DVec3; 2]| {
        let [plus, minus] = [at(h), at(-h)].map(|[wi, wo]| mean(&campaign, wi, wo));
        (plus - minus) / (2.0 * h)
    };
    let lamp = slope(&|x| directions([LIGHT[0] + x, LIGHT[1]], SENSOR));
    agrees(response, Quantity::LampThetaDeg, lamp);
    let sensor = slope(&|x| directions(LIGHT, [SENSOR[0] + x, SENSOR[1]]));
    agrees(response, Quantity::SensorThetaDeg, sensor);
    // The light turned one way is the sensor turned the other: the surface is isotropic.
    let phi = slope(&|x| directions(LIGHT, [SENSOR[0], SENSOR[1] + x]));
    agrees(response, Quantity::SensorPhiDeg, phi);
    agrees(response, Quantity::LampPhiDeg, -phi);
    for (quantity, axis) in [(Quantity::TiltXDeg, DVec3::X), (Quantity::TiltYDeg, DVec3::Y)] {
        let turned =
            |x: f64| directions(LIGHT, SENSOR).map(|w| DQuat::from_axis_angle(axis, -x.to_radians()) * w);
        agrees(response, quantity, slope(&turned));
    }
    let scaled = |factor: f64| {
        let campaign = parsed(1, 1.5, 0.3 * factor, "reading = { u = 0.1 }").campaign;
        let [wi, wo] = directions(LIGHT, SENSOR);
        mean(&campaign, wi, wo)
    };
    let heights = (scaled(1.01) - scaled(0.99)) / 0.02;
    agrees(response, Quantity::HeightScale, heights);
    agrees(response, Quantity::PitchScale, -heights);
}

/// The same paths weighed anew: the noise of a derivative by n is that of the value, 0.4 % here.
#[test]
fn the_sensitivity_to_n_is_that_of_the_formula() {
    let response = moved();
    let [wi, wo] = directions(LIGHT, SENSOR);
    let of = |eta: f64| mean(&parsed(1, eta, 0.3, "reading = { u = 0.1 }").campaign, wi, wo);
    agrees(response, Quantity::N, (of(1.505) - of(1.495)) / 0.01);
}

/// What the reading is multiplied by is exact, and the value is what `measure` makes of the same campaign.
#[test]
fn the_value_is_that_of_measure() {
    let response = moved();
    let campaign = parsed(SAMPLES, 1.5, 0.3, "reading = { u = 0.1 }").campaign;
    let plan = measure::plan(&campaign).expect("it fits");
    let patches = measure::Patches::prepare(&campaign, &mut Vec::new()).expect("none needed");
    let (tables, _) = measure::measure(&campaign, &plan, &patches, &|_| ()).expect("measured");
    let table = f64::from(tables[0].table.colours[0].total[0]);
    // The table has f32: half a unit of 2^-23, and the mean of 16 such numbers.
    assert!((response.value / table - 1.0).abs() < 2e-7, "{} {table}", response.value);
    let input = campaign::InputQuantity {
        quantity: Quantity::Reading,
        distribution: campaign::Distribution::Normal,
        scale: 0.1,
        dof: None,
        relative: false,
    };
    let found = response.sensitivity(&input).expect("exact");
    assert_eq!((found.value, found.error), (response.value, 0.0));
}
