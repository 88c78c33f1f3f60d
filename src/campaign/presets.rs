//! `[preset]`: the arms of a known instrument or data layout, in place of `[light]` and `[sensor]`.
//!
//! The campaign gets the arms that a preset means, and nothing else of it. Half-angles of
//! apertures that the sources do not give are defaults of ours, and can be set.

use serde::Serialize;

use super::parse::angles::{AxisRules, HALF_TURN, PHI, THETA_I, THETA_R, TO_SIXTY, axis};
use super::parse::arms::{
    APERTURE, OPEN, above_horizon, klems_light, light_azimuth, sensor_side, table_fits,
};
use super::parse::reader::{Slot, TableReader};
use super::schema::{Azimuth, BinLayout, LightArm, PhiFrom, SensorArm, SensorSide};

/// What a preset imitates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Preset {
    /// The word in the campaign.
    pub name: &'static str,
    /// Where the geometry is described.
    pub source: &'static str,
    /// What the campaign takes over.
    pub emulated: &'static str,
    /// What it does not.
    pub left_out: &'static str,
}

/// All of them.
pub const ALL: [Preset; 7] = [
    Preset {
        name: "utia",
        source: "Filip and Vavra 2014, Template-based sampling of anisotropic BRDFs (UTIA BRDF database)",
        emulated: "288 x 288 directions: theta 0 to 75 by 15, phi 0 to 352.5 by 7.5 degrees, absolute azimuths",
        left_out: "the camera's image and colours, the size of its lens and of the lamp (aperture_deg is ours)",
    },
    Preset {
        name: "merl",
        source: "Matusik, Pfister, Brand and McMillan 2003, A data-driven reflectance model",
        emulated: "an isotropic table, fine about every mirror direction, from which `export --to merl` fills the \
            90 x 90 x 180 half and difference angles",
        left_out: "the sphere of the sample and its camera; the cells are filled by interpolation at equal half vector",
    },
    Preset {
        name: "rgl",
        source: "Dupuy and Jakob 2018, An adaptive parameterization for efficient material acquisition and \
            rendering",
        emulated: "light at theta 80 (k/(n - 1))^2, denser towards the normal; `export --to rgl` warps the bins to its \
            adaptive grid",
        left_out: "the adaptive choice of the sensor's positions, the spectrometer (80 degrees and n are ours)",
    },
    Preset {
        name: "onera",
        source: "Serrot, Bodilis, Briottet and Cosnefroy 1998, Presentation of a new BRDF measurement device",
        emulated: "zenith angles 0 to 60 of light and sensor, relative azimuth 0 to 180 degrees",
        left_out: "the spectral range 0.42 to 0.95 um, the size of the source and of the field of view (steps and \
            aperture_deg are ours)",
    },
    Preset {
        name: "rosi",
        source: "Patrick, Zarobila and Germer 2013, The NIST Robotic Optical Scatter Instrument (ROSI)",
        emulated: "any pair of directions in and out of the plane of incidence, small circular apertures",
        left_out: "the laser's spot and the precision aperture's distance (aperture_deg is ours)",
    },
    Preset {
        name: "klems_full",
        source: "Klems and Warner 1995 (LBNL full basis), as Radiance's bsdf_m.c has it",
        emulated: "145 patches of the sensor, above and, of clear facets, below (side); light from the middles of the same \
            145 patches, from outside or inside (light_side)",
        left_out: "the mean over the patch of the light: a lobe narrower than 10 degrees falls between the incidences",
    },
    Preset {
        name: "in_plane",
        source: "the scan in the plane of incidence of any goniometer",
        emulated: "the sensor from theta_r -85 to 85 by 1 degree in the plane of incidence; negative: the lamp's side",
        left_out: "the shadow of the lamp's arm at theta_r = -theta_i",
    },
];

/// The arms that a preset means; `isotropic` is unknown where the surface has faults of its own; `through`: whether light
/// goes through facets. `None` in place of an arm, or of everything, where it has faults.
pub(super) fn arms(
    slot: &Slot<'_>,
    isotropic: Option<bool>,
    through: bool,
) -> Option<(Preset, Option<LightArm>, Option<SensorArm>)> {
    let table = || slot.table();
    let words = ALL.map(|preset| (preset.name, preset));
    let preset = table()?.slot("name").required("the instrument, such as \"utia\"")?.choice(&words)?;
    let (light, sensor) = match preset.name {
        "utia" => utia(table()?),
        "merl" => merl(table()?, isotropic),
        "rgl" => rgl(table()?, isotropic),
        "onera" => onera(table()?, isotropic),
        "rosi" => rosi(table()?, isotropic),
        "klems_full" => klems(table()?, through),
        _ => in_plane(table()?, isotropic),
    };
    if let Some((light, sensor)) = light.as_ref().zip(sensor.as_ref()) {
        table_fits(slot.given()?, light, sensor)?;
    }
    Some((preset, light, sensor))
}

type Arms = (Option<LightArm>, Option<SensorArm>);

/// `count` angles from `from` in equal steps.
fn steps(from: f64, step: f64, count: u32) -> Vec<f64> {
    (0..count).map(|k| from + step * f64::from(k)).collect()
}

/// The keys of light that is averaged over the azimuth, or comes from azimuths that are given.
struct LightKeys<'a> {
    /// Never given: no preset has the key.
    azimuth: Slot<'a>,
    theta_i: Slot<'a>,
    phi_i: Slot<'a>,
    average: Slot<'a>,
}

impl LightKeys<'_> {
    /// Parallel light, at `default` where no angles are given.
    fn light(&self, default: Vec<f64>, rules: &AxisRules, isotropic: Option<bool>) -> Option<LightArm> {
        let theta_i_deg = self.theta_i.or(default, |i| axis(i, rules));
        let average_azimuth = self.average.or(false, |i| i.boolean());
        let azimuth = light_azimuth(&self.azimuth, &self.phi_i, &self.average, isotropic);
        let (theta_i_deg, azimuth) = (theta_i_deg?, azimuth?);
        Some(LightArm { theta_i_deg, azimuth, average_azimuth: average_azimuth?, aperture_deg: 0.0 })
    }
}

/// An arm above the horizon.
fn arm(
    aperture: &Slot<'_>,
    default_deg: f64,
    theta_r_deg: Option<Vec<f64>>,
    phi_r_deg: Option<Vec<f64>>,
    phi_r_from: PhiFrom,
) -> Option<SensorArm> {
    let aperture_deg = aperture.or(default_deg, |i| i.float(&OPEN));
    let (theta_r_deg, aperture_deg) = (theta_r_deg?, aperture_deg?);
    above_horizon(aperture, "aperture", &theta_r_deg, aperture_deg)?;
    Some(SensorArm::Arm { theta_r_deg, phi_r_deg: phi_r_deg?, aperture_deg, phi_r_from })
}

fn utia(table: TableReader<'_>) -> Arms {
    let [_, aperture, light_aperture] = table.keys(["name", "aperture_deg", "light_aperture_deg"]);
    let (theta, phi) = (steps(0.0, 15.0, 6), steps(0.0, 7.5, 48));
    let light = light_aperture.or(0.0, |i| i.float(&APERTURE)).and_then(|aperture_deg| {
        above_horizon(&light_aperture, "source cone", &theta, aperture_deg)?;
        let azimuth = Azimuth::Absolute(phi.clone());
        Some(LightArm { theta_i_deg: theta.clone(), azimuth, average_azimuth: false, aperture_deg })
    });
    (light, arm(&aperture, 2.0, Some(theta), Some(phi), PhiFrom::Sample))
}

/// Two degrees either way: the steps of `configs/ground_truth_merl.toml`.
fn merl(table: TableReader<'_>, isotropic: Option<bool>) -> Arms {
    let azimuth = table.slot("azimuth");
    let [_, theta_i, phi_i, average, rows, columns] =
        table.keys(["name", "theta_i_deg", "phi_i_deg", "average_azimuth", "theta_r_bins", "phi_r_bins"]);
    let keys = LightKeys { azimuth, theta_i, phi_i, average };
    (keys.light(steps(0.0, 5.0, 18), &THETA_I, isotropic), hemisphere(&rows, 45, &columns, 180))
}

fn rgl(table: TableReader<'_>, isotropic: Option<bool>) -> Arms {
    let [azimuth, theta_i] = ["azimuth", "theta_i_deg"].map(|never| table.slot(never));
    let [_, count, phi_i, average, rows, columns] =
        table.keys(["name", "theta_i_count", "phi_i_deg", "average_azimuth", "theta_r_bins", "phi_r_bins"]);
    let nodes = count.or(8, |i| i.count(2..=64)).map(|count| {
        let warped = |k: u32| 80.0 * (f64::from(k) / f64::from(count - 1)).powi(2);
        (0..count).map(warped).collect::<Vec<f64>>()
    });
    let keys = LightKeys { azimuth, theta_i, phi_i, average };
    let light = nodes.and_then(|nodes| keys.light(nodes, &THETA_I, isotropic));
    (light, hemisphere(&rows, 45, &columns, 120))
}

fn hemisphere(rows: &Slot<'_>, theta_r: u32, columns: &Slot<'_>, phi_r: u32) -> Option<SensorArm> {
    let theta_r_bins = rows.or(theta_r, |i| i.count(1..=9000));
    let phi_r_bins = columns.or(phi_r, |i| i.count(1..=36_000));
    let (side, bins) = (SensorSide::Reflection, BinLayout::Centred);
    Some(SensorArm::Hemisphere { side, theta_r_bins: theta_r_bins?, phi_r_bins: phi_r_bins?, bins })
}

/// The keys of an instrument that measures pairs of directions: of the light, and theta_r, phi_r and aperture.
fn pair_keys(table: TableReader<'_>) -> (LightKeys<'_>, [Slot<'_>; 3]) {
    let azimuth = table.slot("azimuth");
    let [_, theta_i, phi_i, average, sensor @ ..] = table.keys([
        "name",
        "theta_i_deg",
        "phi_i_deg",
        "average_azimuth",
        "theta_r_deg",
        "phi_r_deg",
        "aperture_deg",
    ]);
    (LightKeys { azimuth, theta_i, phi_i, average }, sensor)
}

fn onera(table: TableReader<'_>, isotropic: Option<bool>) -> Arms {
    let (keys, [theta_r, phi_r, aperture]) = pair_keys(table);
    let light = keys.light(steps(0.0, 15.0, 5), &TO_SIXTY, isotropic);
    let theta_r = theta_r.or(steps(0.0, 10.0, 7), |i| axis(i, &TO_SIXTY));
    let phi_r = phi_r.or(steps(0.0, 15.0, 13), |i| axis(i, &HALF_TURN));
    (light, arm(&aperture, 2.0, theta_r, phi_r, PhiFrom::Light))
}

fn rosi(table: TableReader<'_>, isotropic: Option<bool>) -> Arms {
    let (keys, [theta_r, phi_r, aperture]) = pair_keys(table);
    let what = "a preset of pairs: the angles of the arm, such as [45]";
    let both = [&keys.theta_i, &theta_r].map(|slot| slot.required(what).is_some());
    let light = keys.light(vec![], &THETA_I, isotropic).filter(|_| both[0]);
    let theta_r = theta_r.or(vec![], |i| axis(i, &THETA_R)).filter(|_| both[1]);
    let phi_r = phi_r.or(vec![180.0], |i| axis(i, &PHI));
    (light, arm(&aperture, 0.5, theta_r, phi_r, PhiFrom::Light))
}

/// `light_side` is read with the sides of other lights.
fn klems(table: TableReader<'_>, through: bool) -> Arms {
    let [_, light_aperture, side, _] = table.keys(["name", "light_aperture_deg", "side", "light_side"]);
    (klems_light(&light_aperture), sensor_side(&side, through).map(|side| SensorArm::KlemsFull { side }))
}

fn in_plane(table: TableReader<'_>, isotropic: Option<bool>) -> Arms {
    let azimuth = table.slot("azimuth");
    let [_, theta_i, phi_i, average, theta_r, aperture] =
        table.keys(["name", "theta_i_deg", "phi_i_deg", "average_azimuth", "theta_r_deg", "aperture_deg"]);
    let keys = LightKeys { azimuth, theta_i, phi_i, average };
    let light = keys.light(steps(0.0, 15.0, 6), &THETA_I, isotropic);
    let theta_r = theta_r.or(steps(-85.0, 1.0, 171), |i| axis(i, &THETA_R));
    (light, arm(&aperture, 0.5, theta_r, Some(vec![180.0]), PhiFrom::Light))
}
