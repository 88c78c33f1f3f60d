//! Instruments with random errors, measured: how far the second-order surface is from them.

use serde::Serialize;

use super::monte_carlo::Inputs;
use super::positions::Position;
use super::response::{Errors, Response, angles, by_quantity, slope_factor};
use super::rig::{OpticsChange, Rig, Seen, Setting, Wanted};
use crate::campaign::{Quantity, Uncertainty};
use crate::error::Result;
use crate::rng::{self, Purpose, StreamId};
use crate::stats;

/// Instruments that are measured.
const INSTRUMENTS: u64 = 3;
/// Realisation of the stream that they are drawn from; trials have 0.
const STREAM: u64 = 1;

/// What the instruments showed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Check {
    /// Instruments that were measured; those with an arm beyond the horizon are not.
    pub instruments: usize,
    /// Root mean square over instruments and values of measured less predicted change, in units of u_c; null without any.
    pub rms: Option<f64>,
    /// The same of the standard error of the measured change: what of it noise alone gives.
    pub noise: Option<f64>,
}

/// Measures some instruments. `middle`: one without errors; `combined`: u_c of every value, by pair and colour.
pub fn check(
    rig: &mut Rig,
    (uncertainty, inputs): (&Uncertainty, &Inputs),
    responses: &[Vec<Response>],
    middle: &[Seen],
    combined: &[Vec<f64>],
) -> Result<Check> {
    let positions: Vec<Position> = responses.iter().map(|colours| colours[0].position).collect();
    let relative = |quantity: Quantity| {
        uncertainty.inputs.iter().any(|input| input.quantity == quantity && input.relative)
    };
    let (mut squares, mut noises, mut count, mut instruments) = (0.0, 0.0, 0usize, 0usize);
    for number in 0..INSTRUMENTS {
        let id = StreamId {
            seed: inputs.seed,
            purpose: Purpose::Budget,
            realisation: STREAM,
            incidence: 0,
            block: number,
        };
        let mut drawn = vec![0.0; uncertainty.inputs.len()];
        inputs.draw(&mut rng::stream(id), &mut drawn);
        let errors = by_quantity(&uncertainty.inputs, &drawn);
        let Some((setting, wanted)) = instrument(rig, &positions, &errors, &responses[0][0], &relative)
        else {
            continue;
        };
        instruments += 1;
        let moved = rig.read(&setting, &wanted)?;
        for (pair, responses) in responses.iter().enumerate() {
            for (colour, response) in responses.iter().enumerate() {
                let u = combined[pair][colour];
                if !(u > 0.0 && response.value > 0.0) {
                    continue;
                }
                // Errors of the reading are exact: both sides without them.
                let mut optical = errors;
                optical[Quantity::Reading as usize] = 0.0;
                let predicted = response.value_at(&optical, relative) - response.value;
                let change =
                    moved[pair].brdf[colour].iter().zip(&middle[pair].brdf[colour]).map(|(a, b)| a - b);
                let (measured, se) = stats::mean_and_se(change);
                squares += ((measured - predicted) / u).powi(2);
                noises += (se.unwrap_or(0.0) / u).powi(2);
                count += 1;
            }
        }
    }
    let root = |sum: f64| (count > 0).then(|| (sum / count as f64).sqrt());
    Ok(Check { instruments, rms: root(squares), noise: root(noises) })
}

/// The setting and the directions of an instrument; `None` where an arm would be beyond the horizon, a cone closed, or the
/// material none.
fn instrument(
    rig: &Rig,
    positions: &[Position],
    errors: &Errors,
    response: &Response,
    relative: &impl Fn(Quantity) -> bool,
) -> Option<(Setting, Vec<Wanted>)> {
    let at = |quantity: Quantity| errors[quantity as usize];
    let mut optics = OpticsChange::NONE;
    for &(quantity, _) in &response.constants {
        let place = OpticsChange::place(quantity);
        match relative(quantity) {
            true => optics.factors[place] += at(quantity),
            false => optics.shifts[place] += at(quantity),
        }
    }
    optics.applied(&rig.campaign().optics)?;
    let setting = Setting {
        slopes: slope_factor(errors),
        cone: 1.0 + at(Quantity::LampCone),
        aperture: 1.0 + at(Quantity::SensorAperture),
        optics,
    };
    let [cone, aperture] = rig.half_angles_deg();
    let [cone, aperture] = [cone * setting.cone, aperture * setting.aperture];
    let moved = |position: &Position| {
        let at = position.moved(position.displacement(&angles(errors)));
        let fits = at.same_sides(position) && at.room_deg(cone, aperture) > 0.0;
        fits.then_some(Wanted { drawn_as: Some(*position), at })
    };
    let wanted: Option<Vec<Wanted>> = positions.iter().map(moved).collect();
    let open = setting.cone > 0.0 && setting.aperture > 0.0 && setting.slopes > 0.0;
    Some((setting, wanted.filter(|_| open)?))
}
