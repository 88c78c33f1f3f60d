//! How a BRDF answers to errors of the instrument: a second-order surface, and the sensitivities that follow from it.
//!
//! y = f (1 + reading) times a factor for each group of variables: the arms, slopes, cone, aperture, optics. Each factor is
//! 1 + (g x + x H x/2)/f with the derivatives g and H of f: variables of one group may interact, groups multiply.

use super::differences::Derivative;
use super::positions::{AngleErrors, Position};
use crate::campaign::{InputQuantity, QUANTITIES, Quantity};
use crate::stats;

/// Errors of the inputs by [`Quantity`], in the units of the campaign.
pub type Errors = [f64; QUANTITIES.len()];

/// Variables that were moved together.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Of each variable.
    pub first: Vec<Derivative>,
    /// Second derivatives of all pairs.
    pub second: Vec<Vec<f64>>,
}

impl Group {
    /// Variables that do not interact.
    pub fn of(first: Vec<Derivative>) -> Self {
        let count = first.len();
        let row = |k: usize| (0..count).map(|j| if j == k { first[k].second } else { 0.0 }).collect();
        Group { second: (0..count).map(row).collect(), first }
    }

    /// g x + x H x/2.
    fn change(&self, x: &[f64]) -> f64 {
        let row = |k: usize| self.second[k].iter().zip(x).map(|(h, x)| h * x).sum::<f64>();
        x.iter().enumerate().map(|(k, at)| at * (self.first[k].value() + 0.5 * row(k))).sum()
    }
}

/// dy/dx of an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// 1/sr per unit of the input.
    pub value: f64,
    /// Its standard error: the spread of realisations and the truncation together.
    pub error: f64,
    /// The step of the variable that was moved; `None` where it is exact.
    pub step: Option<f64>,
}

/// The answer of one pair of directions in one colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// The pair.
    pub position: Position,
    /// f, 1/sr.
    pub value: f64,
    /// Moves of both arms on great circles, degrees.
    pub arms: Option<Group>,
    /// Slopes, relative.
    pub slopes: Option<Group>,
    /// The light's cone, relative.
    pub cone: Option<Group>,
    /// The sensor's aperture, relative.
    pub aperture: Option<Group>,
    /// n, f0 or albedo, then k; relative.
    pub optics: Option<Group>,
    /// What variables of `optics` they are, and their values.
    pub constants: Vec<(Quantity, f64)>,
}

/// Places of the angles in [`AngleErrors`].
const ANGLES: [Quantity; 6] = [
    Quantity::LampThetaDeg,
    Quantity::LampPhiDeg,
    Quantity::SensorThetaDeg,
    Quantity::SensorPhiDeg,
    Quantity::TiltXDeg,
    Quantity::TiltYDeg,
];

/// Whether a quantity is an angle of [`AngleErrors`].
pub fn is_angle(quantity: Quantity) -> bool {
    ANGLES.contains(&quantity)
}

/// The angles among some errors.
pub fn angles(errors: &Errors) -> AngleErrors {
    ANGLES.map(|quantity| errors[quantity as usize])
}

/// What all slopes are multiplied by: heights over pitch.
pub fn slope_factor(errors: &Errors) -> f64 {
    (1.0 + errors[Quantity::HeightScale as usize]) / (1.0 + errors[Quantity::PitchScale as usize])
}

/// The errors of the inputs by quantity.
pub fn by_quantity(inputs: &[InputQuantity], errors: &[f64]) -> Errors {
    let mut all = [0.0; QUANTITIES.len()];
    for (input, error) in inputs.iter().zip(errors) {
        all[input.quantity as usize] = *error;
    }
    all
}

impl Response {
    /// y where the inputs are off by `errors`; `relative` says of n, k, f0 and albedo whether theirs are parts of them.
    pub fn value_at(&self, errors: &Errors, relative: impl Fn(Quantity) -> bool) -> f64 {
        let factor = |group: &Option<Group>, x: &[f64]| match group {
            Some(group) => 1.0 + group.change(x) / self.value,
            None => 1.0,
        };
        let arms = match &self.arms {
            Some(_) => factor(&self.arms, &self.position.displacement(&angles(errors))),
            None => 1.0,
        };
        let mut constants = [0.0; 2];
        for (x, (quantity, value)) in constants.iter_mut().zip(&self.constants) {
            let error = errors[*quantity as usize];
            *x = if relative(*quantity) { error } else { error / value };
        }
        self.value
            * (1.0 + errors[Quantity::Reading as usize])
            * arms
            * factor(&self.slopes, &[slope_factor(errors) - 1.0])
            * factor(&self.cone, &[errors[Quantity::LampCone as usize]])
            * factor(&self.aperture, &[errors[Quantity::SensorAperture as usize]])
            * factor(&self.optics, &constants[..self.constants.len()])
    }

    /// dy/dx of an input; `None` where it was not measured.
    // Tested by `sensitivities_are_those_of_the_formula` (tests/it/budget/sensitivities.rs).
    pub fn sensitivity(&self, input: &InputQuantity) -> Option<Sensitivity> {
        let one = |group: &Option<Group>, scale: f64| along(group.as_ref()?, &[scale]);
        match input.quantity {
            Quantity::Reading => Some(Sensitivity { value: self.value, error: 0.0, step: None }),
            Quantity::HeightScale => one(&self.slopes, 1.0),
            Quantity::PitchScale => one(&self.slopes, -1.0),
            Quantity::LampCone => one(&self.cone, 1.0),
            Quantity::SensorAperture => one(&self.aperture, 1.0),
            Quantity::N | Quantity::K | Quantity::F0 | Quantity::Albedo => {
                let place = self.constants.iter().position(|(quantity, _)| *quantity == input.quantity)?;
                let mut direction = vec![0.0; self.constants.len()];
                direction[place] = if input.relative { 1.0 } else { 1.0 / self.constants[place].1 };
                along(self.optics.as_ref()?, &direction)
            }
            angle => {
                let place = ANGLES.iter().position(|known| *known == angle)?;
                along(self.arms.as_ref()?, &self.position.displacement_slope(place))
            }
        }
    }
}

/// The derivative of a group along a direction: realisation by realisation, so that errors of variables that vary together
/// are those of their sum.
fn along(group: &Group, direction: &[f64]) -> Option<Sensitivity> {
    let parts = || group.first.iter().zip(direction);
    let count = group.first.first()?.by_realisation.len();
    let at = |k: usize| parts().map(|(first, x)| x * first.by_realisation[k]).sum::<f64>();
    let (value, noise) = stats::mean_and_se((0..count).map(at));
    let truncation: f64 = parts().map(|(first, x)| (x * first.truncation).abs()).sum();
    let step = group.first.iter().zip(direction).filter(|(_, x)| **x != 0.0).map(|(first, _)| first.step);
    Some(Sensitivity { value, error: noise?.hypot(truncation), step: step.reduce(f64::max) })
}
