//! Promise: the budget's methods are those of JCGM 100 and JCGM 101, by their own worked examples.

use gonio::budget::differences::{Derivative, mixed};
use gonio::budget::gum::{Term, combine, coverage_factor, tolerance};
use gonio::budget::monte_carlo::{Agreement, Inputs, MonteCarlo};
use gonio::budget::positions::Position;
use gonio::budget::response::{Group, Response, by_quantity};
use gonio::campaign::{Distribution, InputQuantity, QUANTITIES, Quantity};

const TRIALS: u64 = 1_000_000;

/// The first inputs of a campaign with these laws and scales.
fn inputs(laws: &[(Distribution, f64)]) -> Vec<InputQuantity> {
    let input = |(&(distribution, scale), (_, quantity)): (&(Distribution, f64), (&str, Quantity))| {
        InputQuantity { quantity, distribution, scale, dof: None, relative: false }
    };
    laws.iter().zip(QUANTITIES).map(input).collect()
}

fn independent(count: usize) -> Vec<Vec<f64>> {
    (0..count).map(|k| (0..count).map(|j| f64::from(u8::from(j == k))).collect()).collect()
}

fn propagated(inputs: &[InputQuantity], trials: u64, model: impl Fn(&[f64]) -> f64 + Sync) -> MonteCarlo {
    let factor = independent(inputs.len());
    Inputs { inputs, factor: &factor, type_a: None, half_widths: &[], seed: 3 }.propagate(trials, model)
}

fn terms(inputs: &[InputQuantity], sensitivity: f64) -> Vec<Term> {
    let term = |input: &InputQuantity| Term {
        sensitivity,
        uncertainty: input.standard_uncertainty(),
        dof: input.dof,
    };
    inputs.iter().map(term).collect()
}

/// JCGM 100, H.1: an end gauge, components of 25 nm (18 degrees of freedom), 9.7 nm (25.6), 2.9 nm (50) and 16.6 nm (2):
/// u_c = 32 nm, nu_eff = 16.7, t_99(16) = 2.92, U_99 = 93 nm, in the digits printed there.
#[test]
fn the_gum_example_h1() {
    let parts = [(25.0, 18.0), (9.7, 25.6), (2.9, 50.0), (16.6, 2.0)];
    let terms = parts.map(|(uncertainty, dof)| Term { sensitivity: 1.0, uncertainty, dof: Some(dof) });
    let found = combine(&terms, &[]);
    assert!((found.standard_uncertainty - 32.0).abs() < 0.5, "{found:?}");
    let dof = found.dof.expect("finite");
    assert!((dof - 16.7).abs() < 0.1, "{dof}");
    let k = coverage_factor(0.01, Some(dof));
    assert!((k - 2.92).abs() < 0.005, "{k}");
    assert!((k * found.standard_uncertainty - 93.0).abs() < 1.0);
    // Known uncertainties: the normal limit, 1.959964.
    assert!((coverage_factor(0.05, None) - 1.959_964).abs() < 5e-7);
}

/// Tables of Student's t at 97.5 %, three digits after the point; 1.959964 where nothing is unknown.
#[test]
fn limits_of_many_degrees_of_freedom_are_those_of_tables() {
    for (dof, value) in
        [(100.9, 1.984), (199.0, 1.972), (200.0, 1.972), (1000.0, 1.962), (9.9e6, 1.960), (1e9, 1.960)]
    {
        let found = coverage_factor(0.05, Some(dof));
        assert!((found - value).abs() < 6e-4, "{dof}: {found}");
    }
}

/// JCGM 101, 8.1: u = 0.00035 g has the digits 35e-5 and the tolerance 0.000005 g; digits are rounded, not cut.
#[test]
fn the_tolerance_is_half_a_unit_of_the_last_digit() {
    for (u, wanted) in [(0.000_35, 5e-6), (2.0, 0.05), (0.0996, 0.005), (0.0994, 0.0005), (10.1, 0.5)] {
        assert!((tolerance(u, 2) / wanted - 1.0).abs() < 1e-12, "{u}: {}", tolerance(u, 2));
    }
    // With one digit: 4e-4 and 1e1.
    for (u, wanted) in [(0.000_35, 5e-5), (10.1, 5.0)] {
        assert!((tolerance(u, 1) / wanted - 1.0).abs() < 1e-12, "{u}: {}", tolerance(u, 1));
    }
    assert_eq!(tolerance(0.0, 2), 0.0);
}

/// JCGM 101, 9.2: four normal quantities of u = 1 have the interval +-3.92, four rectangular ones +-3.88, where the GUM says
/// +-3.92: within the tolerance 0.05 of u = 2.0. With u = 10 for one of them the interval is +-17.0, the GUM's +-19.9, and
/// the tolerance 0.5 of two digits is exceeded, that of one digit, 5, is not.
///
/// Rank statistics: the 2.5 % end of M trials has the error sqrt(0.025 0.975/M)/density; that is 0.0055 for the normal sum
/// (density 0.0292) and less for the others, 0.02 for u = 10 (density 0.0144/2 at the end of a flat top). 4.5 of them, and
/// half a unit of the last digit printed.
#[test]
fn the_sum_of_four_rectangular_quantities() {
    let root = 3f64.sqrt();
    let normal = [(Distribution::Normal, 1.0); 4];
    let even = [(Distribution::Rectangular, root); 4];
    let mut wide = even;
    wide[3].1 *= 10.0;
    for (laws, end, error, digits) in
        [(normal, 3.92, 0.0055, 2), (even, 3.88, 0.0055, 2), (wide, 17.0, 0.02, 1)]
    {
        let inputs = inputs(&laws);
        let found = propagated(&inputs, TRIALS, |x| x.iter().sum());
        let within = 4.5 * error + 0.05f64.min(0.005 * end);
        assert!((found.high - end).abs() < within && (found.low + end).abs() < within, "{found:?}");
        let gum = combine(&terms(&inputs, 1.0), &independent(4));
        assert_eq!(Agreement::of(0.0, &gum, &found).digits, digits, "{gum:?} {found:?}");
    }
}

/// The top of a lobe: no first derivative, y = 1 - x^2. With x normal of u = 0.1 the GUM says u = 0; 1 - y is 0.01 times
/// chi-square of one degree of freedom: mean 0.01, standard deviation 0.01 sqrt(2), ends 0.01 x 0.000982 and 0.01 x 5.024
/// (tables).
#[test]
fn at_the_top_of_a_lobe_the_methods_differ() {
    let first = Derivative { by_realisation: vec![0.0; 2], truncation: 0.0, second: -2.0, step: 0.1 };
    let response = Response {
        position: Position { theta_i_deg: 0.0, phi_i_deg: 0.0, theta_r_deg: 0.0, phi_r_deg: 0.0 },
        value: 1.0,
        arms: None,
        slopes: Some(Group::of(vec![first])),
        cone: None,
        aperture: None,
        optics: None,
        constants: vec![],
    };
    let scale = [InputQuantity {
        quantity: Quantity::HeightScale,
        distribution: Distribution::Normal,
        scale: 0.1,
        dof: None,
        relative: false,
    }];
    let sensitivity = response.sensitivity(&scale[0]).expect("measured").value;
    let gum = combine(&terms(&scale, sensitivity), &independent(1));
    let found = propagated(&scale, TRIALS, |x| response.value_at(&by_quantity(&scale, x), |_| false));
    assert_eq!(gum.standard_uncertainty, 0.0);
    // 4.5 standard errors of M trials: the mean's 0.01 sqrt(2/M), the deviation's 0.01 sqrt(2) sqrt((15 - 1)/(4 M)) (fourth
    // moment of chi-square 15 times its variance squared), the end's 0.01 sqrt(0.025 0.975/M)/0.0144.
    let root = (TRIALS as f64).sqrt();
    assert!((found.mean - 0.99).abs() < 4.5 * 0.0142 / root, "{found:?}");
    assert!((found.standard_uncertainty - 0.01 * 2f64.sqrt()).abs() < 4.5 * 0.0265 / root, "{found:?}");
    assert!((found.low - (1.0 - 0.050_24)).abs() < 4.5 * 0.01 * 0.156 / 0.0144 / root + 1e-5, "{found:?}");
    assert!((found.high - (1.0 - 9.82e-6)).abs() < 1e-6, "{found:?}");
    assert_eq!(Agreement::of(1.0, &gum, &found).digits, 0);
}

/// Standard deviations of the distributions by their closed forms; the error of one of M trials is u sqrt((kurtosis - 1)/(4 M)),
/// at most 0.71 u/sqrt(M) of the normal one. t of 9 degrees of freedom: 2.262 at 97.5 % (tables).
#[test]
fn distributions_are_as_wide_as_they_say() {
    let laws =
        [Distribution::Normal, Distribution::Rectangular, Distribution::Triangular, Distribution::Arcsine];
    for law in laws {
        let one = inputs(&[(law, 0.5)]);
        let found = propagated(&one, TRIALS, |x| x[0]).standard_uncertainty;
        let wanted = one[0].standard_uncertainty();
        assert!(
            (found / wanted - 1.0).abs() < 4.5 * 0.71 / (TRIALS as f64).sqrt(),
            "{law:?} {found} {wanted}"
        );
    }
    let t = [InputQuantity { dof: Some(9.0), ..inputs(&[(Distribution::T, 1.0)])[0] }];
    let found = propagated(&t, TRIALS, |x| x[0]);
    // The density of t_9 at 2.262 is 0.0397.
    assert!((found.high - 2.262).abs() < 4.5 * 0.156 / 0.0397 / (TRIALS as f64).sqrt() + 5e-4, "{found:?}");
}

/// x - y of two normal numbers of u = 1 and r = 0.5 has the variance 1 + 1 - 2 r = 1; with r = 1 it is 0 exactly.
#[test]
fn correlations_count_in_both_methods() {
    let both = inputs(&[(Distribution::Normal, 1.0); 2]);
    let mut terms = terms(&both, 1.0);
    terms[1].sensitivity = -1.0;
    for (factor, wanted) in [([[1.0, 0.0], [0.5, 0.75f64.sqrt()]], 1.0), ([[1.0, 0.0], [1.0, 0.0]], 0.0)] {
        let factor: Vec<Vec<f64>> = factor.iter().map(|row| row.to_vec()).collect();
        let gum = combine(&terms, &factor).standard_uncertainty;
        assert!((gum - wanted).abs() < 1e-15, "{gum}");
        let drawn = Inputs { inputs: &both, factor: &factor, type_a: None, half_widths: &[], seed: 1 };
        let found = drawn.propagate(TRIALS, |x| x[0] - x[1]).standard_uncertainty;
        assert!((found - wanted).abs() <= 4.5 * 0.71 * wanted / (TRIALS as f64).sqrt(), "{found}");
    }
}

/// f = sin: Richardson's rule leaves 4 h^4/120 f''''' of the derivative and less of the second; what is said to be left is
/// as large. x^2 y^3 has the mixed derivative 6 x y^2; fourth derivatives, below 12 here, leave h^2 times less than 20.
#[test]
fn derivatives_of_known_functions() {
    let (at, step) = (0.7f64, 0.1);
    let points =
        [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| vec![(at + k * step).sin(), 3.0 * (at + k * step).sin()]);
    let found = Derivative::of(step, points.each_ref().map(|values| &values[..]));
    // Mean of 1 and 3 times.
    let off = (found.value() - 2.0 * at.cos()).abs();
    assert!(off < 2.0 * 4.0 * step.powi(4) / 120.0, "{off}");
    assert!(found.truncation >= 0.8 * off && found.truncation <= 2.0 * off, "{} {off}", found.truncation);
    assert!((found.second + 2.0 * at.sin()).abs() < 2.0 * step.powi(4), "{}", found.second);
    // The values are 1 and 3 times one another: standard error of the mean = the derivative of one.
    assert!((found.noise() - at.cos()).abs() < 1e-5);
    let (h, f) = (1e-3, |x: f64, y: f64| [x * x * y * y * y]);
    let (x, y) = (1.2, 0.8);
    let cross = mixed(
        h,
        &f(x, y),
        [&f(x + h, y + h), &f(x - h, y - h)],
        [&f(x + h, y), &f(x - h, y)],
        [&f(x, y + h), &f(x, y - h)],
    );
    assert!((cross - 6.0 * x * y * y).abs() < 20.0 * h * h + 1e-9 / h, "{cross}");
}
