//! What a height map must have to be measured: positive lengths, enough cells and digits, slopes that units allow.

use super::prepare::refine::Cuts;
use super::samples::{MapSamples, Stored};
use crate::campaign::HeightMap;

/// Fewest cells along a side.
const MIN_CELLS: usize = 8;
/// Fewest steps of the number format that the relief of an f32 map must span.
const MIN_STEPS: f64 = 65_536.0;
/// Rms slopes beyond which a map is refused: walls of 88 degrees. Ground and blasted surfaces have 0.1 to 1, so that a
/// unit that is 1000 times too large ends up here.
pub const ABSURD_SDQ: f64 = 30.0;
/// Rms slopes outside of which a map is doubtful: steeper than 72 degrees, or smoother than a polished mirror and yet not
/// flat.
const DOUBTFUL_SDQ: [f64; 2] = [1e-3, 3.0];

/// Refuses slopes that only a slip of units makes, and names doubtful ones.
pub fn check_slopes(map: &HeightMap, cuts: &Cuts, notes: &mut Vec<String>) -> Result<(), String> {
    let sdq = cuts.sdq;
    let [smooth, steep] = DOUBTFUL_SDQ;
    let units = match (map.pitch_x_um, map.pitch_y_um, map.height_unit_um) {
        (Some(x), Some(y), Some(unit)) => format!("height_unit_um = {unit} on a pitch of {x} x {y} um"),
        _ => "by the file's own pitches and unit of heights".into(),
    };
    if sdq.is_nan() || sdq > ABSURD_SDQ {
        return Err(format!(
            "rms slope Sdq = {sdq:.3e}, {units}: above {ABSURD_SDQ} (88 degrees) only a slip of units has it; correct \
             height unit or pitch"
        ));
    }
    if sdq > steep {
        notes.push(format!(
            "rms slope Sdq = {sdq:.3}, {units}: steeper than 72 degrees; are the units right?"
        ));
    }
    if sdq < smooth {
        notes.push(format!(
            "rms slope Sdq = {sdq:.1e}, {units}: smoother than a polished mirror; are the units right?"
        ));
    }
    Ok(())
}

/// Slope per unit of height difference along one axis: height unit over pitch.
pub fn slope_factor(
    name: &str,
    pitch_um: Option<f64>,
    height_unit_um: Option<f64>,
    own: Option<f64>,
    no_pitch: impl Fn(&str) -> String,
) -> Result<f64, String> {
    let factor = match (pitch_um, own) {
        (Some(pitch), _) => {
            let unit = height_unit_um
                .ok_or_else(|| format!("surface.file.{name}_um needs surface.file.height_unit_um as well"))?;
            positive("height_unit_um", unit)? / positive(name, pitch)?
        }
        (None, Some(pitch)) => 1.0 / positive(name, pitch)?,
        (None, None) => return Err(no_pitch(name)),
    };
    positive(&format!("height unit over {name}"), factor)
}

pub fn positive(name: &str, value: f64) -> Result<f64, String> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(format!("{name} = {value}: must be positive and finite"))
    }
}

/// Cells along x and y.
pub fn check_size(file: &MapSamples, periodic: bool) -> Result<(usize, usize), String> {
    let extra = usize::from(!periodic);
    let (x, y) = (file.columns.saturating_sub(extra), file.rows.saturating_sub(extra));
    if x < MIN_CELLS || y < MIN_CELLS {
        return Err(format!("{x} x {y} cells; at least {MIN_CELLS} x {MIN_CELLS} are needed"));
    }
    Ok((x, y))
}

/// Refuses an f32 map whose offset has eaten the relief: fewer than 16 bits between lowest and highest.
pub fn check_precision(file: &MapSamples) -> Result<(), String> {
    let fold = |f: fn(f64, f64) -> f64, start| file.heights.iter().fold(start, |a, &h| f(a, h));
    let (low, high) = (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY));
    let largest = low.abs().max(high.abs()) as f32;
    if file.stored != Stored::Single || low == high || largest == f32::MAX {
        return Ok(());
    }
    let step = f64::from(largest.next_up() - largest);
    let steps = (high - low) / step;
    if steps >= MIN_STEPS {
        return Ok(());
    }
    Err(format!(
        "heights from {low} to {high} in f32 span only {steps} steps of the format; take the offset off before \
         saving, or save as f64"
    ))
}
