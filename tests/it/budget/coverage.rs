//! Promise: intervals of 95 % hold the true value in 95 of 100 instruments.
//!
//! Synthetic instruments: each has true errors of its angles, heights and reading, reads the formula there, and adds the
//! spread of eight realisations. Its interval is y +- U with the sensitivities of the nominal instrument and the standard
//! error that it sees itself. 20 lots of 1,000 instruments: the binomial error of a lot is sqrt(0.95 0.05/1000) = 0.69 %, of
//! all 0.15 %; 1 % is 6.5 of these.

use gonio::budget::differences::Derivative;
use gonio::budget::gum::{Term, combine};
use gonio::budget::monte_carlo::Inputs;
use gonio::budget::positions::Position;
use gonio::budget::response::{Errors, Group, Response, angles, by_quantity, slope_factor};
use gonio::campaign::{Distribution, InputQuantity, Quantity};
use gonio::optics::Fresnel;
use gonio::rng;
use gonio::stats;
use gonio::theory::{Masking, Microfacet, Ndf};

use crate::support::measuring::test_rng;

const AT: Position = Position { theta_i_deg: 30.0, phi_i_deg: 0.0, theta_r_deg: 50.0, phi_r_deg: 160.0 };
const INSTRUMENTS: usize = 20_000;
const REALISATIONS: usize = 8;

/// The formula at a position, for slopes multiplied by a factor.
fn formula(at: &Position, slopes: f64) -> f64 {
    let surface = Microfacet::isotropic(Ndf::Ggx, 0.3 * slopes);
    surface.brdf(at.wi(), at.wo(), Masking::HeightCorrelated, &Fresnel::Dielectric { eta: 1.5 })
}

/// What an instrument with these errors reads.
fn reading(errors: &Errors) -> f64 {
    let at = AT.moved(AT.displacement(&angles(errors)));
    formula(&at, slope_factor(errors)) * (1.0 + errors[Quantity::Reading as usize])
}

/// The response by the same differences as of a measurement, without noise.
fn response() -> Response {
    let five = |step: f64, at: &dyn Fn(f64) -> f64| {
        let values = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| [at(k * step); 2]);
        Derivative::of(step, values.each_ref().map(|both| &both[..]))
    };
    let moved = |place: usize| {
        five(1.0, &|x| {
            let mut by = [0.0; 4];
            by[place] = x;
            formula(&AT.moved(by), 1.0)
        })
    };
    Response {
        position: AT,
        value: formula(&AT, 1.0),
        arms: Some(Group::of((0..4).map(moved).collect())),
        slopes: Some(Group::of(vec![five(0.05, &|x| formula(&AT, 1.0 + x))])),
        cone: None,
        aperture: None,
        optics: None,
        constants: vec![],
    }
}

fn inputs() -> Vec<InputQuantity> {
    let input = |quantity, distribution, scale| InputQuantity {
        quantity,
        distribution,
        scale,
        dof: None,
        relative: false,
    };
    vec![
        input(Quantity::LampThetaDeg, Distribution::Normal, 0.2),
        input(Quantity::SensorThetaDeg, Distribution::Rectangular, 0.5),
        input(Quantity::TiltXDeg, Distribution::Triangular, 0.3),
        input(Quantity::TiltYDeg, Distribution::Normal, 0.1),
        input(Quantity::HeightScale, Distribution::Normal, 0.01),
        input(Quantity::PitchScale, Distribution::Arcsine, 0.01),
        input(Quantity::Reading, Distribution::Normal, 0.01),
    ]
}

#[test]
fn intervals_of_95_percent_hold_95_of_100_true_values() {
    let (inputs, response, truth) = (inputs(), response(), formula(&AT, 1.0));
    let factor: Vec<Vec<f64>> =
        (0..inputs.len()).map(|k| (0..inputs.len()).map(|j| f64::from(u8::from(j == k))).collect()).collect();
    let drawn = Inputs { inputs: &inputs, factor: &factor, type_a: None, half_widths: &[], seed: 1 };
    let of_input = |input: &InputQuantity| Term {
        sensitivity: response.sensitivity(input).expect("known").value,
        uncertainty: input.standard_uncertainty(),
        dof: None,
    };
    let terms: Vec<Term> = inputs.iter().map(of_input).collect();
    // Realisations spread by as much as the inputs do: degrees of freedom count.
    let spread = combine(&terms, &factor).standard_uncertainty * (REALISATIONS as f64).sqrt();
    let (mut rng, mut errors) = (test_rng(11), vec![0.0; inputs.len()]);
    let mut held = 0;
    for _ in 0..INSTRUMENTS {
        drawn.draw(&mut rng, &mut errors);
        let level = reading(&by_quantity(&inputs, &errors));
        let seen: Vec<f64> = (0..REALISATIONS).map(|_| level + spread * rng::normal(&mut rng)).collect();
        let (value, se) = stats::mean_and_se(seen.iter().copied());
        let type_a =
            Term { sensitivity: 1.0, uncertainty: se.expect("eight"), dof: Some(REALISATIONS as f64 - 1.0) };
        let all: Vec<Term> = terms.iter().copied().chain([type_a]).collect();
        held += usize::from((value - truth).abs() <= combine(&all, &factor).expanded);
    }
    let coverage = held as f64 / INSTRUMENTS as f64;
    assert!((coverage - 0.95).abs() < 0.01, "{coverage}");
}

/// Both methods say the same of these instruments but for the tolerance of two digits: JCGM 101, 8.
#[test]
fn both_methods_agree_on_a_nearly_linear_instrument() {
    let (mut inputs, response) = (inputs(), response());
    // A tenth of the errors: what bends is a hundredth.
    inputs.iter_mut().for_each(|input| input.scale *= 0.1);
    let count = inputs.len();
    let factor: Vec<Vec<f64>> =
        (0..count).map(|k| (0..count).map(|j| f64::from(u8::from(j == k))).collect()).collect();
    let of_input = |input: &InputQuantity| Term {
        sensitivity: response.sensitivity(input).expect("known").value,
        uncertainty: input.standard_uncertainty(),
        dof: None,
    };
    let terms: Vec<Term> = inputs.iter().map(of_input).collect();
    let gum = combine(&terms, &factor);
    let drawn = Inputs { inputs: &inputs, factor: &factor, type_a: None, half_widths: &[], seed: 1 };
    let found = drawn.propagate(1_000_000, |x| response.value_at(&by_quantity(&inputs, x), |_| false));
    let agreement = gonio::budget::monte_carlo::Agreement::of(response.value, &gum, &found);
    assert_eq!(agreement.digits, 2, "{agreement:?} {gum:?} {found:?}");
}
