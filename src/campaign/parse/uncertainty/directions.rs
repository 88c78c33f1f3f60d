//! `uncertainty.at` and `aperture_deg`: the pairs of directions of a budget, where the campaign has no arm.

use super::Around;
use crate::campaign::parse::angles::AZIMUTH;
use crate::campaign::parse::arms::OPEN;
use crate::campaign::parse::reader::{Bounds, GivenValue, Slot, plain};
use crate::campaign::schema::SensorArm;

/// Most pairs of directions: each is measured again and again.
const MOST_PAIRS: usize = 1000;

const THETA_I: Bounds = Bounds::closed(0.0, 90.0).high_open();
const THETA_R: Bounds = Bounds::closed(-90.0, 90.0).low_open().high_open();
const THETA_R_THROUGH: Bounds = Bounds::closed(-180.0, 180.0).low_open();

/// `[theta_i, phi_i, theta_r, phi_r]` of each pair, and the half-angle of the aperture; nothing with an arm.
pub(super) fn directions(
    [at, aperture]: [&Slot<'_>; 2],
    around: &Around<'_>,
) -> Option<(Vec<[f64; 4]>, Option<f64>)> {
    if let SensorArm::Arm { theta_r_deg, phi_r_deg, .. } = around.sensor {
        let why = "has no meaning with [sensor.arm]: a budget is made of all its positions";
        let absent = [at, aperture].map(|slot| slot.absent(why));
        let incidences = around.light.theta_i_deg.len() * azimuths(around);
        let pairs = incidences.saturating_mul(theta_r_deg.len()).saturating_mul(phi_r_deg.len());
        if pairs > MOST_PAIRS {
            return at
                .refuse(format!("{pairs} pairs of directions, at most {MOST_PAIRS}; take fewer angles"));
        }
        return absent.into_iter().collect::<Option<Vec<()>>>().map(|_| (vec![], None));
    }
    let aperture_deg = aperture
        .required("the half-angle of the aperture about the directions of `at`")
        .and_then(|i| i.float(&OPEN));
    let pairs = at
        .required(
            "the pairs of directions, [[theta_i, phi_i, theta_r, phi_r], ...]: a hemisphere has too many",
        )
        .and_then(|i| pairs(i, around, aperture_deg.unwrap_or(0.0)));
    Some((pairs?, Some(aperture_deg?)))
}

fn azimuths(around: &Around<'_>) -> usize {
    match &around.light.azimuth {
        crate::campaign::schema::Azimuth::Absolute(phis) => phis.len(),
        _ => 1,
    }
}

fn pairs(item: &GivenValue<'_>, around: &Around<'_>, aperture_deg: f64) -> Option<Vec<[f64; 4]>> {
    match item.list_length() {
        Some(0) => return item.refuse("must not be empty; give at least one pair"),
        Some(count) if count > MOST_PAIRS => {
            return item.refuse(format!("{count} pairs of directions, at most {MOST_PAIRS} are allowed"));
        }
        _ => {}
    }
    item.each(|one| pair(one, around, aperture_deg))
}

fn pair(item: &GivenValue<'_>, around: &Around<'_>, aperture_deg: f64) -> Option<[f64; 4]> {
    if item.list_length() != Some(4) {
        return item.refuse("must be [theta_i, phi_i, theta_r, phi_r] in degrees");
    }
    let through = around.optics.lets_through();
    let bounds = [&THETA_I, &AZIMUTH, if through { &THETA_R_THROUGH } else { &THETA_R }, &AZIMUTH];
    let parts = item.list()?;
    let read: Vec<Option<f64>> = parts.iter().zip(bounds).map(|(part, bounds)| part.float(bounds)).collect();
    let found: Vec<f64> = read.into_iter().collect::<Option<_>>()?;
    let [theta_i, phi_i, theta_r, phi_r] = found[..] else { return None };
    for (what, theta, half_angle) in
        [("source cone", theta_i, around.light.aperture_deg), ("aperture", theta_r, aperture_deg)]
    {
        if (90.0 - theta.abs()).abs() <= half_angle {
            return item.refuse(format!(
                "the {what} at theta = {} reaches the horizon; keep its half-angle, {} degrees, away from 90",
                plain(theta),
                plain(half_angle)
            ));
        }
    }
    Some([theta_i, phi_i, theta_r, phi_r])
}
