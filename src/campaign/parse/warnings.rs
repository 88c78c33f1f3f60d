//! Warnings about a campaign without faults.

use super::faults::Report;
use crate::campaign::schema::{Azimuth, BinLayout, Campaign, PhiFrom, SensorArm, SurfaceKind};

/// Roughness up to which the measurement was compared with theory.
const TESTED_ALPHA: f64 = 2.0;

/// Notes on a checked campaign.
pub(crate) fn note(report: &Report<'_>, campaign: &Campaign) {
    if let Some(theta) = sensor_in_the_light(campaign) {
        let text = "the sensor stands where the lamp is: a real instrument cannot measure there".to_string();
        report.note("sensor.arm.theta_r_deg", None, Some(format!("{theta}")), text);
    }
    if let Some(theta) = mirror_on_an_edge(campaign) {
        let text = "its mirror direction lies on an edge of the bins, and rounding decides between them: take bins = \
                    \"centred\""
            .to_string();
        report.note("light.theta_i_deg", None, Some(format!("{theta}")), text);
    }
    note_lobe(report, campaign);
}

/// The first angle of the light whose mirror direction, into which all light of a flat part goes, is an edge of two bins.
fn mirror_on_an_edge(campaign: &Campaign) -> Option<f64> {
    let kind = &campaign.surface.kind;
    let plane = kind.explicit_grains().is_some() && !kind.has_absorbing_base();
    let SensorArm::Hemisphere { theta_r_bins, phi_r_bins, bins: BinLayout::Aligned, .. } = &campaign.sensor
    else {
        return None;
    };
    if !(plane || matches!(kind, SurfaceKind::Mirror)) {
        return None;
    }
    let on_edge = |angle: f64, step: f64| (angle / step).fract() == 0.0;
    let (theta_step, phi_step) = (90.0 / f64::from(*theta_r_bins), 360.0 / f64::from(*phi_r_bins));
    let across = match &campaign.light.azimuth {
        Azimuth::Absolute(phis) => phis.iter().any(|phi| on_edge((phi + 180.0) % 360.0, phi_step)),
        Azimuth::Relative => on_edge(180.0, phi_step),
        Azimuth::KlemsFull => false,
    };
    let thetas = &campaign.light.theta_i_deg;
    thetas.iter().copied().find(|&theta| theta > 0.0 && (across || on_edge(theta, theta_step)))
}

/// The first position of the sensor's arm that is a lamp's as well. Positions count from the light, or both from x.
fn sensor_in_the_light(campaign: &Campaign) -> Option<f64> {
    let SensorArm::Arm { theta_r_deg, phi_r_deg, phi_r_from, .. } = &campaign.sensor else { return None };
    let lamps = match (&campaign.light.azimuth, phi_r_from) {
        (Azimuth::Absolute(phis), PhiFrom::Sample) => phis.as_slice(),
        _ => &[0.0],
    };
    theta_r_deg.iter().copied().find(|&theta| {
        // A negative angle lies on the far side of its azimuth, and at the zenith there is none.
        let turn = if theta < 0.0 { 180.0 } else { 0.0 };
        let at_a_lamp = |phi: &f64| theta == 0.0 || lamps.contains(&((phi + turn) % 360.0));
        campaign.light.theta_i_deg.contains(&theta.abs()) && phi_r_deg.iter().any(at_a_lamp)
    })
}

fn note_lobe(report: &Report<'_>, campaign: &Campaign) {
    let (key, alphas) = match &campaign.surface.kind {
        SurfaceKind::Ggx(alphas) => ("surface.ggx.alpha", alphas),
        SurfaceKind::Beckmann { alphas, .. } => ("surface.beckmann.alpha", alphas),
        SurfaceKind::StudentT { alphas, .. } => ("surface.student_t.alpha", alphas),
        SurfaceKind::BlinnPhong { alphas, .. } => ("surface.blinn_phong.exponent", alphas),
        SurfaceKind::Psd(psd) => ("surface.psd", &psd.alphas),
        SurfaceKind::Smith(smith) => ("surface.smith.alpha", &smith.alphas),
        SurfaceKind::Grains(grains) => ("surface.grains.alpha", &grains.alphas),
        _ => return,
    };
    let say = |key: &str, value: f64, text: String| report.note(key, None, Some(format!("{value}")), text);
    let largest = alphas.iter().fold(0.0, |a: f64, alpha| a.max(alpha.x).max(alpha.y));
    let smallest = alphas.iter().fold(f64::INFINITY, |a, alpha| a.min(alpha.x).min(alpha.y));
    if largest > TESTED_ALPHA {
        say(key, largest, format!("above {TESTED_ALPHA}: beyond the tested range"));
    }
    let quarter_lobe = (smallest / 4.0).to_degrees();
    let too_wide = format!("exceeds a quarter of alpha ({quarter_lobe:.3} degrees): the lobe is smeared");
    if campaign.light.aperture_deg > quarter_lobe {
        say("light.aperture_deg", campaign.light.aperture_deg, too_wide.clone());
    }
    match &campaign.sensor {
        SensorArm::Hemisphere { theta_r_bins, .. } => {
            let half_bin = (45.0 / f64::from(*theta_r_bins)).to_radians();
            if smallest < half_bin {
                let text = format!("the lobe is narrower than a bin (half a bin is {half_bin:.4} radians)");
                say(key, smallest, text);
            }
        }
        SensorArm::Arm { aperture_deg, .. } if *aperture_deg > quarter_lobe => {
            say("sensor.arm.aperture_deg", *aperture_deg, too_wide);
        }
        SensorArm::Arm { .. } => {}
        SensorArm::KlemsFull { .. } => {
            let half_patch = 5f64.to_radians();
            if smallest < half_patch {
                say(key, smallest, "the lobe is narrower than a patch of 10 degrees".into());
            }
        }
    }
}
