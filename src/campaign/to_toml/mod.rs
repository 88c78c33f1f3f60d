//! A campaign back into the TOML it could have been read from, with nothing left to defaults.

mod optics;
mod surface;
mod text;
mod uncertainty;

use super::parse::{arms, campaign};
use super::schema::{Azimuth, Campaign, Expect, LightArm, LightSide, PhysicalScale, SensorArm, SensorSide};
use text::{Text, quoted, word};

pub use uncertainty::uncertainty_to_toml;

/// The campaign as resolved, in the schema that [`parse`](super::parse()) reads: parsing it gives the campaign again.
///
/// Stored in every table. Keys that would have no effect are left out. Seeds above 2^63 - 1 are written as plain
/// integers, which this reader takes and other TOML readers may not. A random surface has either roughnesses that
/// are equal along x and y, or a single one that is not.
// By hand: checkpoints and digests of tables depend on these bytes, and the `toml` crate writes 1e-7 as 0.0000001. The
// `Serialize` of a `Campaign` is that of JSON reports, which have another shape.
pub fn to_toml(campaign: &Campaign) -> String {
    let mut text = Text(String::new());
    text.line("name", quoted(&campaign.name));
    text.line("seed", campaign.seed);
    surface::surface_table(&mut text, &campaign.surface);
    light_table(&mut text, &campaign.light, &campaign.optics.light_sides());
    sensor_table(&mut text, &campaign.sensor);
    optics::optics_table(&mut text, &campaign.optics);
    text.table("trace");
    text.line("bounces", campaign.trace.bounces);
    text.line("visibility", campaign.trace.visibility);
    text.line("fold", campaign.trace.fold);
    if campaign.trace.by_order {
        text.line("by_order", true);
    }
    text.table("stop");
    text.line("samples", campaign.stop.samples);
    let rules = [("relative_error", campaign.stop.relative_error), ("seconds", campaign.stop.seconds)];
    for (key, rule) in rules {
        if let Some(rule) = rule {
            text.floats(key, rule);
        }
    }
    expect_table(&mut text, &campaign.expect);
    scale_table(&mut text, &campaign.scale);
    if let Some(bench) = &campaign.bench {
        text.table("bench");
        text.floats("cells", &bench.cells);
        if campaign.surface.kind.is_random_heights() {
            text.floats("correlation_cells", &bench.correlation_cells);
        }
    }
    text.0
}

fn light_table(text: &mut Text, light: &LightArm, sides: &[LightSide]) {
    text.table("light");
    if light.azimuth != Azimuth::KlemsFull {
        text.floats("theta_i_deg", &light.theta_i_deg);
    }
    match &light.azimuth {
        Azimuth::KlemsFull => text.line("azimuth", quoted("klems_full")),
        Azimuth::Relative => text.line("azimuth", quoted("relative")),
        Azimuth::Absolute(phis) => {
            text.line("azimuth", quoted("absolute"));
            text.floats("phi_i_deg", phis);
        }
    }
    if light.azimuth != Azimuth::KlemsFull {
        text.line("average_azimuth", light.average_azimuth);
    }
    text.floats("aperture_deg", light.aperture_deg);
    if sides != [LightSide::Front] {
        text.line("side", word(&arms::LIGHT_SIDES, &sides));
    }
}

fn sensor_table(text: &mut Text, sensor: &SensorArm) {
    match sensor {
        SensorArm::Hemisphere { side, theta_r_bins, phi_r_bins, bins } => {
            text.table("sensor.hemisphere");
            text.line("theta_r_bins", theta_r_bins);
            text.line("phi_r_bins", phi_r_bins);
            text.line("bins", word(&arms::LAYOUTS, bins));
            side_line(text, side);
        }
        SensorArm::Arm { theta_r_deg, phi_r_deg, aperture_deg, phi_r_from } => {
            text.table("sensor.arm");
            text.floats("theta_r_deg", theta_r_deg);
            text.floats("phi_r_deg", phi_r_deg);
            text.floats("aperture_deg", aperture_deg);
            text.line("phi_r_from", word(&arms::PHI_FROM, phi_r_from));
        }
        SensorArm::KlemsFull { side } => {
            text.table("sensor.patches");
            text.line("basis", quoted("klems_full"));
            side_line(text, side);
        }
    }
}

/// Left out where it is the usual one.
fn side_line(text: &mut Text, side: &SensorSide) {
    if *side != SensorSide::Reflection {
        text.line("side", word(&arms::SENSOR_SIDES, side));
    }
}

fn expect_table(text: &mut Text, expect: &Expect) {
    if *expect == (Expect { masking: None, l1_model: None }) {
        return;
    }
    text.table("expect");
    if let Some(masking) = &expect.masking {
        text.line("masking", word(&campaign::MASKINGS, masking));
    }
    if let Some(l1_model) = expect.l1_model {
        text.floats("l1_model", l1_model);
    }
}

fn scale_table(text: &mut Text, scale: &PhysicalScale) {
    if *scale == PhysicalScale::default() {
        return;
    }
    text.table("scale");
    for (key, length) in [("pitch_um", scale.pitch_um), ("wavelength_nm", scale.wavelength_nm)] {
        if let Some(length) = length {
            text.floats(key, length);
        }
    }
}
