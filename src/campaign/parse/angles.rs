//! Angle axes: a list or a range, into strictly increasing degrees.

use super::lists::ranges::{range, refuse_at};
use super::reader::{Bounds, GivenValue, plain};
use crate::sphere::reduced_deg;

/// Most points of one axis.
pub(crate) const MOST_POINTS: usize = 100_000;

/// What azimuths may be given: a few turns either way. Beyond, degrees lose their digits.
pub(crate) const AZIMUTH: Bounds =
    Bounds::closed(-3600.0, 3600.0).advice("azimuths count in degrees", "azimuths count in degrees");

/// The rules of an axis.
pub(crate) struct AxisRules {
    bounds: Bounds,
    /// Whether angles that differ by 360 are the same.
    wraps: bool,
}

/// Polar angles of the light arm.
pub(crate) const THETA_I: AxisRules = AxisRules {
    bounds: Bounds::closed(0.0, 90.0).high_open().advice(
        "polar angles count from the normal; turn the azimuth instead",
        "the light arm stops below 90",
    ),
    wraps: false,
};

/// Polar angles of the sensor arm; negative ones lie on the far side of the azimuth.
pub(crate) const THETA_R: AxisRules = AxisRules {
    bounds: Bounds::closed(-90.0, 90.0)
        .low_open()
        .high_open()
        .advice("the sensor arm stops above -90", "the sensor arm stops below 90"),
    wraps: false,
};

/// Polar angles of a sensor arm that goes below the surface as well.
pub(crate) const THETA_R_THROUGH: AxisRules = AxisRules {
    bounds: Bounds::closed(-180.0, 180.0).low_open().advice(
        "180 is the same direction",
        "angles beyond 90 are of light that has gone through, up to 180",
    ),
    wraps: false,
};

/// Polar angles of an instrument that goes no lower than 60 degrees.
pub(crate) const TO_SIXTY: AxisRules = AxisRules {
    bounds: Bounds::closed(0.0, 60.0)
        .advice("its arms have one side", "its arms stop at 60; use [light] and [sensor]"),
    wraps: false,
};

/// Azimuths of an instrument with one half of the hemisphere.
pub(crate) const HALF_TURN: AxisRules = AxisRules {
    bounds: Bounds::closed(0.0, 180.0).advice("it turns through 0 to 180", "it turns through 0 to 180"),
    wraps: false,
};

/// Azimuths of either arm.
pub(crate) const PHI: AxisRules = AxisRules { bounds: AZIMUTH, wraps: true };

/// The angles of an axis, strictly increasing, in degrees.
pub(crate) fn axis(item: &GivenValue<'_>, rules: &AxisRules) -> Option<Vec<f64>> {
    let given = if item.is_table() { range(item, &rules.bounds, MOST_POINTS)? } else { list(item, rules)? };
    let mut angles: Vec<f64> =
        if rules.wraps { given.iter().map(|a| reduced_deg(*a)).collect() } else { given.clone() };
    check_order(item, &given, &angles)?;
    // From -90 to 90 increases as it is written; the table has what it reduces to in order.
    angles.sort_by(f64::total_cmp);
    if given != angles {
        item.note("azimuths are reduced to [0, 360)");
    }
    if !rules.wraps && angles.iter().all(|a| a.abs() <= 1.571) && angles.iter().any(|a| *a != 0.0) {
        item.note("all angles <= 1.571: degrees are expected");
    }
    Some(angles)
}

fn list(item: &GivenValue<'_>, rules: &AxisRules) -> Option<Vec<f64>> {
    match item.list_length() {
        None => item.wrong_type("a list such as [0, 30, 60] or a range { from = 0, to = 75, step = 15 }"),
        Some(0) => item.refuse("must not be empty; give at least one angle"),
        Some(n) if n > MOST_POINTS => {
            item.refuse(format!("has {n} points; at most {MOST_POINTS} are allowed"))
        }
        Some(_) => item.each(|i| i.float(&rules.bounds)),
    }
}

/// A fault at the first angle that is not above the one before it, as written, or is there twice once reduced.
fn check_order(item: &GivenValue<'_>, given: &[f64], angles: &[f64]) -> Option<()> {
    let falls = |list: &[f64]| list.windows(2).position(|pair| !matches!(pair, [a, b] if a < b));
    if falls(angles).is_none() {
        return Some(());
    }
    let twice = (1..angles.len()).find(|&index| angles[..index].contains(&angles[index]));
    let Some(index) = falls(given).map(|before| before + 1).or(twice) else { return Some(()) };
    let (angle, earlier) = (angles[index], angles[index - 1]);
    let seen_as =
        if given[index] == angle { String::new() } else { format!(" (reduced to {} here)", plain(angle)) };
    let fault = if angles[..index].contains(&angle) {
        format!("{} is there twice{seen_as}; each angle once", plain(given[index]))
    } else {
        format!("{} comes after {}{seen_as}; angles must increase", plain(given[index]), plain(earlier))
    };
    refuse_at(item, index, fault)
}
