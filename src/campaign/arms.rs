//! `[light]` and `[sensor]`: the two arms of the goniometer.

use super::angles::{PHI, THETA_I, THETA_R, axis};
use super::reader::{Bounds, Item, Slot, Table, plain};
use super::schema::{Azimuth, BinLayout, Light, PhiFrom, Sensor};

/// Words for [`BinLayout`].
pub(super) const LAYOUTS: [(&str, BinLayout); 2] =
    [("centred", BinLayout::Centred), ("aligned", BinLayout::Aligned)];

/// Words for [`PhiFrom`].
pub(super) const PHI_FROM: [(&str, PhiFrom); 2] = [("light", PhiFrom::Light), ("sample", PhiFrom::Sample)];

/// Words for the two kinds of [`Azimuth`]; the flag says whether it is relative.
const AZIMUTHS: [(&str, bool); 2] = [("relative", true), ("absolute", false)];

/// Most entries of one table.
const MOST_ENTRIES: u64 = 1 << 31;

/// Half-angles of cones.
const APERTURE: Bounds = Bounds::closed(0.0, 45.0);

/// Reads `[light]`. `isotropic` is unknown where the surface has faults of its own.
pub(super) fn light(slot: &Slot<'_>, isotropic: Option<bool>) -> Option<Light> {
    let [theta_i, phi_i, azimuth, average, aperture] =
        slot.table()?.keys(["theta_i_deg", "phi_i_deg", "azimuth", "average_azimuth", "aperture_deg"]);
    let theta_i_deg = theta_i
        .required("the light's polar angles, such as [0, 30, 60] or { from = 0, to = 75, step = 15 }")
        .and_then(|i| axis(i, &THETA_I));
    let average_azimuth = average.or(false, |i| i.boolean());
    let azimuth = light_azimuth(&azimuth, &phi_i, &average, isotropic);
    let aperture_deg = aperture.or(0.0, |i| i.float(&APERTURE));
    let (theta_i_deg, aperture_deg) = (theta_i_deg?, aperture_deg?);
    above_horizon(&aperture, "source cone", &theta_i_deg, aperture_deg)?;
    Some(Light { theta_i_deg, azimuth: azimuth?, average_azimuth: average_azimuth?, aperture_deg })
}

/// The rules between `azimuth`, `phi_i_deg`, `average_azimuth` and the surface.
fn light_azimuth(
    azimuth: &Slot<'_>,
    phi_i: &Slot<'_>,
    average: &Slot<'_>,
    isotropic: Option<bool>,
) -> Option<Azimuth> {
    let phis = phi_i.or(None, |i| axis(i, &PHI).map(Some));
    let relative = azimuth.or(None, |i| i.choice(&AZIMUTHS).map(Some));
    let averaged = average.given().and_then(Item::as_boolean);
    // Unknown isotropy blames nobody.
    let may_average = isotropic != Some(false) || averaged == Some(true);
    match (relative?, phis?) {
        (Some(true), Some(_)) => {
            phi_i.refuse("has no meaning with azimuth = \"relative\"; leave out one of the two")
        }
        (Some(false), None) => phi_i.refuse("required with azimuth = \"absolute\""),
        (None | Some(false), Some(_)) if averaged == Some(true) => {
            average.refuse("has no meaning with phi_i_deg; leave out one of the two")
        }
        (None | Some(false), Some(phis)) => Some(Azimuth::Absolute(phis)),
        (None | Some(true), None) if may_average => Some(Azimuth::Relative),
        (Some(true), None) => azimuth.refuse(
            "the surface is not isotropic; give phi_i_deg and azimuth = \"absolute\", or average_azimuth = true",
        ),
        (None, None) => phi_i.refuse(
            "required: the surface is not isotropic; or average over the azimuth with average_azimuth = true",
        ),
    }
}

/// Reads `[sensor]`. `light` is unknown where it has faults of its own.
pub(super) fn sensor(slot: &Slot<'_>, light: Option<&Light>) -> Option<Sensor> {
    let [hemisphere, arm] = slot.table()?.keys(["hemisphere", "arm"]);
    let rows_and_columns = hemisphere.given().map(|i| hemisphere_bins(i.table()?));
    let positions = arm.given().map(|i| arm_positions(i.table()?, light));
    let (sensor, kind) = match (rows_and_columns, positions) {
        (Some(sensor), None) => (sensor?, hemisphere.given()),
        (None, Some(sensor)) => (sensor?, arm.given()),
        (None, None) => {
            return slot.refuse("exactly one is required: [sensor.hemisphere] or [sensor.arm]");
        }
        (Some(_), Some(_)) => {
            return arm
                .refuse("exactly one sensor is allowed, and [sensor.hemisphere] is there as well: keep one");
        }
    };
    if let Some(light) = light {
        table_fits(kind?, light, &sensor)?;
    }
    Some(sensor)
}

fn hemisphere_bins(table: Table<'_>) -> Option<Sensor> {
    let [theta_r_bins, phi_r_bins, bins] = table.keys(["theta_r_bins", "phi_r_bins", "bins"]);
    let theta_r_bins = theta_r_bins.or(18, |i| i.count(1..=9000));
    let phi_r_bins = phi_r_bins.or(36, |i| i.count(1..=36000));
    let bins = bins.or(BinLayout::Centred, |i| i.choice(&LAYOUTS));
    Some(Sensor::Hemisphere { theta_r_bins: theta_r_bins?, phi_r_bins: phi_r_bins?, bins: bins? })
}

fn arm_positions(table: Table<'_>, light: Option<&Light>) -> Option<Sensor> {
    let [theta_r, phi_r, aperture, from] =
        table.keys(["theta_r_deg", "phi_r_deg", "aperture_deg", "phi_r_from"]);
    let theta_r_deg = theta_r
        .required("the sensor's polar angles, such as [-60, 0, 60] or { from = -60, to = 60, step = 10 }")
        .and_then(|i| axis(i, &THETA_R));
    let phi_r_deg = phi_r.or(vec![0.0], |i| axis(i, &PHI));
    let bounds = APERTURE.low_open().advice("a closed aperture collects no light", "");
    let aperture_deg = aperture.required("the half-angle of the aperture").and_then(|i| i.float(&bounds));
    let phi_r_from = azimuth_origin(&from, light);
    let (theta_r_deg, aperture_deg) = (theta_r_deg?, aperture_deg?);
    above_horizon(&aperture, "aperture", &theta_r_deg, aperture_deg)?;
    Some(Sensor::Arm { theta_r_deg, phi_r_deg: phi_r_deg?, aperture_deg, phi_r_from: phi_r_from? })
}

/// What the sensor's azimuths count from. Averaged over the light's azimuth, only the light is left.
fn azimuth_origin(from: &Slot<'_>, light: Option<&Light>) -> Option<PhiFrom> {
    let relative = light.is_some_and(|light| light.azimuth == Azimuth::Relative);
    let default = if relative { PhiFrom::Light } else { PhiFrom::Sample };
    match from.or(default, |i: &Item<'_>| i.choice(&PHI_FROM))? {
        PhiFrom::Sample if relative => {
            from.refuse("has no meaning where the light's azimuth is averaged; use \"light\"")
        }
        origin => Some(origin),
    }
}

/// A fault where a cone of half-angle `aperture_deg` about one of `angles` reaches the horizon.
fn above_horizon(slot: &Slot<'_>, what: &str, angles: &[f64], aperture_deg: f64) -> Option<()> {
    let widest = angles.iter().fold(0.0, |widest: f64, angle| widest.max(angle.abs()));
    if widest + aperture_deg < 90.0 {
        return Some(());
    }
    slot.refuse(format!(
        "the {what} at theta = {} reaches the horizon; angle and aperture together must stay below 90",
        plain(widest)
    ))
}

/// A fault where the table has more entries than an image can hold, counted without overflow.
fn table_fits(item: &Item<'_>, light: &Light, sensor: &Sensor) -> Option<()> {
    let theta_i = light.theta_i_deg.len() as u64;
    let phi_i = match &light.azimuth {
        Azimuth::Relative => 1,
        Azimuth::Absolute(phis) => phis.len() as u64,
    };
    let (rows, columns) = match sensor {
        Sensor::Hemisphere { theta_r_bins, phi_r_bins, bins } => {
            let extra = u64::from(*bins == BinLayout::Centred);
            (u64::from(*theta_r_bins) + extra, u64::from(*phi_r_bins))
        }
        Sensor::Arm { theta_r_deg, phi_r_deg, .. } => (theta_r_deg.len() as u64, phi_r_deg.len() as u64),
    };
    let entries = [theta_i, phi_i, rows, columns].iter().try_fold(1u64, |n, axis| n.checked_mul(*axis));
    match entries {
        Some(entries) if entries <= MOST_ENTRIES => Some(()),
        _ => {
            // Total, single, multiple, two errors and hits of one colour: the least that an entry is stored as.
            let bytes = [theta_i, phi_i, rows, columns].iter().fold(24.0, |n: f64, axis| n * *axis as f64);
            item.too_large(format!(
                "theta_i x phi_i x theta_r x phi_r = {theta_i} x {phi_i} x {rows} x {columns} entries of {bytes:.1e} \
                 bytes: a table holds at most 2^31 ({:.1e} bytes); take fewer stops or wider bins",
                24.0 * MOST_ENTRIES as f64
            ))
        }
    }
}
