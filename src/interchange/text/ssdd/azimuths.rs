//! What an SSDD file's azimuths must be, and values that it lists under two of them.

use crate::error::wrong;
use crate::interchange::Checked;
use crate::interchange::text::azimuths::{Azimuths, SAME, widest_gap};
use crate::interchange::text::samples::alike;

/// The widest step between azimuths of the light that is interpolated over, degrees.
const WIDEST_GAP: f64 = 90.0;

/// Refuses azimuths of the light or the half vector that leave out more than the specification's own example; a single
/// one stands for all.
pub fn check_round(azimuths: &Azimuths) -> Checked<()> {
    let gap = widest_gap(&azimuths.angles, 360.0);
    if gap > WIDEST_GAP + SAME {
        return Err(wrong!("PARAM1_LIST: {gap} degrees without an azimuth; steps of at most 90 are read"));
    }
    Ok(())
}

/// Refuses azimuths of the sensor that leave out half of `turn`: two opposite ones are a scan in a plane, of more a
/// forgotten symmetry.
pub fn check_whole(azimuths: &Azimuths, turn: f64) -> Checked<()> {
    let (gap, half) = (widest_gap(&azimuths.angles, turn), 0.5 * turn);
    if gap > if azimuths.angles.len() == 2 { half + SAME } else { half - SAME } {
        return Err(wrong!(
            "PARAM3_LIST: {gap} degrees without an azimuth; half of {turn} is what a REDUCTION_TYPE leaves out"
        ));
    }
    Ok(())
}

/// The values of each colour over [a][azimuth][b][azimuth], the mean where an azimuth has several places, and a note
/// where those are not alike.
pub fn merged(
    total: &[Vec<f32>],
    [n0, n1, n2, n3]: [usize; 4],
    outer: &Azimuths,
    inner: &Azimuths,
) -> (Vec<Vec<f32>>, Option<String>) {
    let mut share = 0.0f64;
    let of_colour = |values: &Vec<f32>| -> Vec<f32> {
        let largest = values.iter().fold(f32::MIN_POSITIVE, |most, &value| most.max(value));
        let values: Vec<f64> = values.iter().map(|&value| value.into()).collect();
        let (values, off_outer) = outer.merged(&values, [n0, n1, n2 * n3], alike);
        let (values, off_inner) = inner.merged(&values, [n0 * outer.angles.len() * n2, n3, 1], alike);
        share = share.max(off_outer.max(off_inner) / f64::from(largest));
        values.into_iter().map(|value| value as f32).collect()
    };
    let merged = total.iter().map(of_colour).collect();
    let note = format!(
        "values of one direction under two azimuths differ by up to {:.1} % of the largest: their mean is taken",
        100.0 * share
    );
    (merged, (share > 0.0).then_some(note))
}
