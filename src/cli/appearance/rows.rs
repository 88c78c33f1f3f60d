//! The figures of `gonio appearance` as CSV: a line each.

use serde::Serialize;

use crate::appearance::colorimetry::{Illuminant, Observer};
use crate::appearance::report::AppearanceAtAzimuth;
use crate::appearance::{Appearance, Quantity};
use crate::error::{Error, Result};

/// One line.
#[derive(Debug, Clone, Default, Serialize)]
struct FigureRow {
    phi_i_deg: f64,
    theta_i_deg: Option<f64>,
    theta_r_deg: Option<f64>,
    geometry: String,
    figure: &'static str,
    observer_deg: &'static str,
    illuminant: &'static str,
    value: Option<f64>,
    se: Option<f64>,
    bins: Option<f64>,
    note: Option<String>,
}

/// All figures of all azimuths.
pub fn csv(found: &Appearance) -> Result<Vec<u8>> {
    let failed = |why: &dyn std::fmt::Display| Error::Internal(format!("writing CSV: {why}"));
    let mut out = csv::Writer::from_writer(Vec::new());
    for row in found.azimuths.iter().flat_map(rows) {
        out.serialize(row).map_err(|why| failed(&why))?;
    }
    out.into_inner().map_err(|why| failed(&why))
}

fn rows(at: &AppearanceAtAzimuth) -> Vec<FigureRow> {
    let phi_i_deg = at.phi_i_deg;
    let of = |geometry: &str, theta_i_deg: f64, figure, quantity: &Quantity| FigureRow {
        phi_i_deg,
        theta_i_deg: Some(theta_i_deg),
        geometry: geometry.into(),
        figure,
        value: quantity.value,
        se: quantity.se,
        bins: quantity.bins,
        note: quantity.note.clone(),
        ..FigureRow::default()
    };
    let mut rows: Vec<FigureRow> =
        at.gloss.iter().map(|gloss| of("ISO 2813", gloss.angle_deg, "gloss", &gloss.gloss)).collect();
    let haze = &at.haze;
    rows.extend([
        of("ISO 13803", 20.0, "reflection_haze", &haze.reflection_haze),
        of("ISO 13803", 20.0, "log_haze", &haze.log_haze),
        of("ASTM E430", 30.0, "haze_2", &haze.haze_2),
        of("ASTM E430", 30.0, "haze_5", &haze.haze_5),
        of("ASTM E430", 30.0, "doi", &haze.doi),
    ]);
    for scatter in &at.scatter {
        rows.push(of("hemisphere", scatter.theta_i_deg, "reflectance", &scatter.reflectance));
        rows.push(of("hemisphere", scatter.theta_i_deg, "tis", &scatter.tis));
    }
    for reflected in &at.reflectance {
        rows.push(of(&reflected.geometry, reflected.theta_i_deg, "factor", &reflected.factor));
        for colour in &reflected.colours {
            let six = [(colour.xyz, colour.xyz_se), (colour.lab, colour.lab_se)];
            let names = [["X", "Y", "Z"], ["L*", "a*", "b*"]];
            for ((values, errors), names) in six.iter().zip(names) {
                for k in 0..3 {
                    let quantity = Quantity { value: Some(values[k]), se: errors[k], ..Quantity::default() };
                    rows.push(FigureRow {
                        observer_deg: if colour.observer == Observer::Two { "2" } else { "10" },
                        illuminant: Illuminant::name(colour.illuminant),
                        ..of(&reflected.geometry, reflected.theta_i_deg, names[k], &quantity)
                    });
                }
            }
        }
    }
    for incidence in &at.ars {
        for angle in &incidence.angles {
            for (figure, value) in [("brdf", angle.brdf), ("ars", angle.ars)] {
                let quantity = Quantity { value: Some(value), ..Quantity::default() };
                let theta_r_deg = Some(angle.theta_r_deg);
                rows.push(FigureRow {
                    theta_r_deg,
                    ..of("in plane", incidence.theta_i_deg, figure, &quantity)
                });
            }
        }
    }
    rows
}
