//! `[light]` and `[sensor]`: the two arms of the goniometer.

use super::angles::{PHI, THETA_I, THETA_R, THETA_R_THROUGH, axis};
use super::reader::{Bounds, GivenValue, Slot, TableReader, plain};
use crate::campaign::schema::{Azimuth, BinLayout, LightArm, LightSide, PhiFrom, SensorArm, SensorSide};

/// Words for [`BinLayout`].
pub(crate) const LAYOUTS: [(&str, BinLayout); 2] =
    [("centred", BinLayout::Centred), ("aligned", BinLayout::Aligned)];

/// Words for [`SensorSide`].
pub(crate) const SENSOR_SIDES: [(&str, SensorSide); 3] = [
    ("reflection", SensorSide::Reflection),
    ("transmission", SensorSide::Transmission),
    ("both", SensorSide::Both),
];

/// Words for the sides that light comes from.
pub(crate) const LIGHT_SIDES: [(&str, &[LightSide]); 3] = [
    ("front", &[LightSide::Front]),
    ("back", &[LightSide::Back]),
    ("both", &[LightSide::Front, LightSide::Back]),
];

/// Words for [`PhiFrom`].
pub(crate) const PHI_FROM: [(&str, PhiFrom); 2] = [("light", PhiFrom::Light), ("sample", PhiFrom::Sample)];

/// Words for the two kinds of [`Azimuth`] that go with lists of angles; the flag says whether it is relative.
const AZIMUTHS: [(&str, bool); 2] = [("relative", true), ("absolute", false)];

/// The word for both arms on the Klems full basis.
pub(crate) const KLEMS: &str = "klems_full";

/// Middles of the rings of the Klems full basis, degrees, and how many patches all rings have.
const KLEMS_RINGS: [f64; 9] = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 82.5];
const KLEMS_PATCHES: u64 = 145;

/// Most entries of one table.
const MOST_ENTRIES: u64 = 1 << 31;

/// Half-angles of cones.
pub(crate) const APERTURE: Bounds = Bounds::closed(0.0, 45.0);

/// Half-angles of the sensor's apertures: from a 250th of an arc second on. One path into a narrower one can make a BRDF
/// that f32 does not hold, where the cone lies as low as it may.
pub(crate) const OPEN: Bounds =
    Bounds::closed(1e-6, 45.0).advice("an aperture as good as closed collects no light", "");

/// Reads `[light]`. `isotropic` is unknown where the surface has faults of its own.
pub(crate) fn light(slot: &Slot<'_>, isotropic: Option<bool>) -> Option<LightArm> {
    let [theta_i, phi_i, azimuth, average, aperture, _] = slot.table()?.keys([
        "theta_i_deg",
        "phi_i_deg",
        "azimuth",
        "average_azimuth",
        "aperture_deg",
        "side",
    ]);
    if azimuth.given().and_then(GivenValue::as_text) == Some(KLEMS) {
        let why = "has no meaning with azimuth = \"klems_full\": the basis names the incidences";
        let absent = [&theta_i, &phi_i, &average].map(|slot| slot.absent(why));
        let light = klems_light(&aperture);
        return absent.into_iter().collect::<Option<Vec<()>>>().and(light);
    }
    let theta_i_deg = theta_i
        .required("the light's polar angles, such as [0, 30, 60] or { from = 0, to = 75, step = 15 }")
        .and_then(|i| axis(i, &THETA_I));
    let average_azimuth = average.or(false, |i| i.boolean());
    let azimuth = light_azimuth(&azimuth, &phi_i, &average, isotropic);
    let aperture_deg = aperture.or(0.0, |i| i.float(&APERTURE));
    let (theta_i_deg, aperture_deg) = (theta_i_deg?, aperture_deg?);
    above_horizon(&aperture, "source cone", &theta_i_deg, aperture_deg)?;
    Some(LightArm { theta_i_deg, azimuth: azimuth?, average_azimuth: average_azimuth?, aperture_deg })
}

/// The sides that light comes from, one table each: what a key of `[light]` or `[preset]` says.
pub(crate) fn light_sides(slot: &Slot<'_>, key: &'static str, through: bool) -> Option<Vec<LightSide>> {
    let side = match slot.given() {
        Some(light) if light.is_table() => light.table()?.slot(key),
        _ => return Some(vec![LightSide::Front]),
    };
    let sides = side.or(&[LightSide::Front][..], |i| i.choice(&LIGHT_SIDES))?;
    if !through && sides != [LightSide::Front] {
        return side
            .refuse(format!("must be \"front\": there is no light inside these facets; {CLEAR_FACETS}"));
    }
    Some(sides.to_vec())
}

/// What lets light through.
const CLEAR_FACETS: &str = "optics.facet = \"dielectric\" lets it through";

/// Incidences in the middle of the patches of the Klems full basis.
pub(crate) fn klems_light(aperture: &Slot<'_>) -> Option<LightArm> {
    let theta_i_deg = KLEMS_RINGS.to_vec();
    let aperture_deg = aperture.or(0.0, |i| i.float(&APERTURE))?;
    above_horizon(aperture, "source cone", &theta_i_deg, aperture_deg)?;
    Some(LightArm { theta_i_deg, azimuth: Azimuth::KlemsFull, average_azimuth: false, aperture_deg })
}

/// The rules between `azimuth`, `phi_i_deg`, `average_azimuth` and the surface.
pub(crate) fn light_azimuth(
    azimuth: &Slot<'_>,
    phi_i: &Slot<'_>,
    average: &Slot<'_>,
    isotropic: Option<bool>,
) -> Option<Azimuth> {
    let phis = phi_i.or(None, |i| axis(i, &PHI).map(Some));
    let relative = azimuth.or(None, |i| i.choice(&AZIMUTHS).map(Some));
    let averaged = average.given().and_then(GivenValue::as_boolean);
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

/// Reads `[sensor]`. `light` is unknown where it has faults of its own; `through`: whether light goes through facets.
pub(crate) fn sensor(slot: &Slot<'_>, light: Option<&LightArm>, through: bool) -> Option<SensorArm> {
    let kinds = slot.table()?.keys(["hemisphere", "arm", "patches"]);
    let read = |item: &GivenValue<'_>| match item.name() {
        "hemisphere" => hemisphere_bins(item.table()?, through),
        "arm" => arm_positions(item.table()?, light, through),
        _ => patches(item.table()?, through),
    };
    let given: Vec<&Slot<'_>> = kinds.iter().filter(|slot| slot.given().is_some()).collect();
    let mut read: Vec<Option<SensorArm>> = given.iter().filter_map(|s| s.given()).map(read).collect();
    let sensor = match given[..] {
        [] if kinds.iter().any(Slot::is_misspelt) => return None,
        [] => {
            return slot
                .refuse("exactly one is required: [sensor.hemisphere], [sensor.arm] or [sensor.patches]");
        }
        [_] => read.pop().flatten()?,
        [first, second, ..] => {
            let first = first.given().map_or("hemisphere", GivenValue::name);
            return second.refuse(format!(
                "exactly one sensor is allowed, and [sensor.{first}] is there as well: keep one"
            ));
        }
    };
    if let Some(light) = light {
        table_fits(given[0].given()?, light, &sensor)?;
    }
    Some(sensor)
}

fn patches(table: TableReader<'_>, through: bool) -> Option<SensorArm> {
    let [basis, side] = table.keys(["basis", "side"]);
    let basis =
        basis.required("the basis of the patches: \"klems_full\"").and_then(|i| i.choice(&[(KLEMS, ())]));
    let side = sensor_side(&side, through);
    basis?;
    Some(SensorArm::KlemsFull { side: side? })
}

/// The hemispheres that a sensor looks at.
pub(crate) fn sensor_side(slot: &Slot<'_>, through: bool) -> Option<SensorSide> {
    let side = slot.or(SensorSide::Reflection, |i| i.choice(&SENSOR_SIDES))?;
    if side != SensorSide::Reflection && !through {
        return slot
            .refuse(format!("must be \"reflection\": no light goes through these facets; {CLEAR_FACETS}"));
    }
    Some(side)
}

fn hemisphere_bins(table: TableReader<'_>, through: bool) -> Option<SensorArm> {
    let [theta_r_bins, phi_r_bins, bins, side] = table.keys(["theta_r_bins", "phi_r_bins", "bins", "side"]);
    let theta_r_bins = theta_r_bins.or(18, |i| i.count(1..=9000));
    let phi_r_bins = phi_r_bins.or(36, |i| i.count(1..=36000));
    let bins = bins.or(BinLayout::Centred, |i| i.choice(&LAYOUTS));
    let side = sensor_side(&side, through)?;
    Some(SensorArm::Hemisphere { side, theta_r_bins: theta_r_bins?, phi_r_bins: phi_r_bins?, bins: bins? })
}

fn arm_positions(table: TableReader<'_>, light: Option<&LightArm>, through: bool) -> Option<SensorArm> {
    let [theta_r, phi_r, aperture, from] =
        table.keys(["theta_r_deg", "phi_r_deg", "aperture_deg", "phi_r_from"]);
    let theta_r_deg = theta_r
        .required("the sensor's polar angles, such as [-60, 0, 60] or { from = -60, to = 60, step = 10 }")
        .and_then(|i| axis(i, if through { &THETA_R_THROUGH } else { &THETA_R }));
    let phi_r_deg = phi_r.or(vec![0.0], |i| axis(i, &PHI));
    let aperture_deg = aperture.required("the half-angle of the aperture").and_then(|i| i.float(&OPEN));
    let phi_r_from = azimuth_origin(&from, light);
    let (theta_r_deg, aperture_deg) = (theta_r_deg?, aperture_deg?);
    off_horizon(&aperture, "aperture", &theta_r_deg, aperture_deg)?;
    Some(SensorArm::Arm { theta_r_deg, phi_r_deg: phi_r_deg?, aperture_deg, phi_r_from: phi_r_from? })
}

/// What the sensor's azimuths count from. Averaged over the light's azimuth, only the light is left.
fn azimuth_origin(from: &Slot<'_>, light: Option<&LightArm>) -> Option<PhiFrom> {
    let relative = light.is_some_and(|light| light.azimuth == Azimuth::Relative);
    let default = if relative { PhiFrom::Light } else { PhiFrom::Sample };
    match from.or(default, |i: &GivenValue<'_>| i.choice(&PHI_FROM))? {
        PhiFrom::Sample if relative => {
            from.refuse("has no meaning where the light's azimuth is averaged; use \"light\"")
        }
        origin => Some(origin),
    }
}

/// A fault where a cone of half-angle `aperture_deg` about one of `angles` reaches the horizon.
pub(crate) fn above_horizon(slot: &Slot<'_>, what: &str, angles: &[f64], aperture_deg: f64) -> Option<()> {
    let widest = angles.iter().fold(0.0, |widest: f64, angle| widest.max(angle.abs()));
    if widest + aperture_deg < 90.0 {
        return Some(());
    }
    slot.refuse(format!(
        "the {what} at theta = {} reaches the horizon; angle and aperture together must stay below 90",
        plain(widest)
    ))
}

/// The same for angles of both hemispheres.
fn off_horizon(slot: &Slot<'_>, what: &str, angles: &[f64], aperture_deg: f64) -> Option<()> {
    let (above, below): (Vec<f64>, Vec<f64>) = angles.iter().partition(|angle| angle.abs() <= 90.0);
    above_horizon(slot, what, &above, aperture_deg)?;
    let nearest = below.iter().fold(180.0, |nearest: f64, angle| nearest.min(angle.abs()));
    if nearest - aperture_deg > 90.0 {
        return Some(());
    }
    slot.refuse(format!(
        "the {what} at theta = {} reaches the horizon; angle less aperture must stay beyond 90",
        plain(nearest)
    ))
}

/// A fault where the table has more entries than an image can hold, counted without overflow.
pub(crate) fn table_fits(item: &GivenValue<'_>, light: &LightArm, sensor: &SensorArm) -> Option<()> {
    let hemispheres = |side| if side == SensorSide::Both { 2 } else { 1 };
    let (theta_i, phi_i) = match &light.azimuth {
        Azimuth::Relative => (light.theta_i_deg.len() as u64, 1),
        Azimuth::Absolute(phis) => (light.theta_i_deg.len() as u64, phis.len() as u64),
        Azimuth::KlemsFull => (KLEMS_PATCHES, 1),
    };
    let (rows, columns) = match sensor {
        SensorArm::Hemisphere { side, theta_r_bins, phi_r_bins, bins } => {
            let extra = u64::from(*bins == BinLayout::Centred);
            (hemispheres(*side) * (u64::from(*theta_r_bins) + extra), u64::from(*phi_r_bins))
        }
        SensorArm::Arm { theta_r_deg, phi_r_deg, .. } => (theta_r_deg.len() as u64, phi_r_deg.len() as u64),
        SensorArm::KlemsFull { side } => (hemispheres(*side) * KLEMS_PATCHES, 1),
    };
    let entries = [theta_i, phi_i, rows, columns].iter().try_fold(1u64, |n, axis| n.checked_mul(*axis));
    match entries {
        Some(entries) if entries <= MOST_ENTRIES => Some(()),
        _ => {
            // Total, single, multiple, two errors and hits of one colour: the least that an entry is stored as.
            let bytes = [theta_i, phi_i, rows, columns].iter().fold(24.0, |n: f64, axis| n * *axis as f64);
            item.too_large(format!(
                "theta_i x phi_i x theta_r x phi_r = {theta_i} x {phi_i} x {rows} x {columns} entries of {bytes:.1e} \
                 bytes: a table holds at most 2^31 ({:.1e} bytes); take fewer incidences or wider bins",
                24.0 * MOST_ENTRIES as f64
            ))
        }
    }
}
