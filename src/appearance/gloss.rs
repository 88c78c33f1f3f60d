//! Specular gloss at 20, 60 and 85 degrees (ISO 2813:2014, ASTM D523).

use serde::Serialize;

use super::incidence::LightAzimuth;
use super::quantity::Quantity;
use super::reading::Reading;
use super::receptor::Receptor;
use super::samples::TableSamples;
use crate::optics::{FacetAngle, Fresnel};
use crate::sphere;

/// The source's image at the receptor: in the plane of incidence, across; degrees.
pub(super) const IMAGE_DEG: [f64; 2] = [0.75, 2.5];
/// Index of the black glass that has 100 gloss units at every angle.
pub const GLASS: f64 = 1.567;
/// Bins may be as large as this part of a slit.
pub(super) const PART_OF_SLIT: f64 = 0.5;

/// A glossmeter: its angle, and its receptor's in the plane of incidence and across, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glossmeter {
    /// Of light and receptor from the normal.
    pub angle_deg: f64,
    /// The receptor's field.
    pub receptor_deg: [f64; 2],
}

/// The three of ISO 2813:2014 and ASTM D523, Table 1.
pub const GLOSSMETERS: [Glossmeter; 3] = [
    Glossmeter { angle_deg: 20.0, receptor_deg: [1.80, 3.6] },
    Glossmeter { angle_deg: 60.0, receptor_deg: [4.4, 11.7] },
    Glossmeter { angle_deg: 85.0, receptor_deg: [4.0, 6.0] },
];

/// What a glossmeter says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gloss {
    /// Its angle.
    pub angle_deg: f64,
    /// Gloss units: 100 times the flux into the receptor over that of the glass.
    pub gloss: Quantity,
}

/// The reflectance of the polished black glass, which the receptor collects whole: Fresnel's for unpolarised light.
pub fn glass_reflectance(angle_deg: f64) -> f64 {
    let (sin, cos) = sphere::sin_cos_deg(angle_deg);
    Fresnel::Dielectric { eta: GLASS }.reflectance(FacetAngle { cos, sin2: sin * sin })
}

/// Gloss at the three angles.
///
/// 100 (integral of f share cos over the receptor)/F(angle; 1.567), with the luminance of `ColourScale` and the
/// share of `Receptor::slit`.
// Tested by `polished_glass_has_100_gloss_units`, `gloss_is_the_direct_quadrature_over_source_and_receptor`
// (tests/it/appearance/gloss.rs).
pub fn gloss(samples: &TableSamples, light: &LightAzimuth) -> Vec<Gloss> {
    let of = |meter: &Glossmeter| {
        let reading = slit_reading(samples, light, meter.angle_deg, (0.0, meter.receptor_deg, IMAGE_DEG));
        let glass = glass_reflectance(meter.angle_deg);
        let units = |reading| samples.quantity(&[&reading], |v| 100.0 * samples.luminance(v, 0) / glass);
        Gloss { angle_deg: meter.angle_deg, gloss: reading.map_or_else(Quantity::missing, units) }
    };
    GLOSSMETERS.iter().map(of).collect()
}

/// What a slit collects that stands off the mirror direction by some degrees in the plane of incidence.
pub(super) fn slit_reading(
    samples: &TableSamples,
    light: &LightAzimuth,
    angle_deg: f64,
    (off_deg, size_deg, image_deg): (f64, [f64; 2], [f64; 2]),
) -> Result<Reading, String> {
    light.at(angle_deg, |theta_i, incidence| {
        let at = [theta_i + off_deg, light.mirror_phi_deg()];
        Reading::new(samples.table, incidence, &Receptor::slit(at, size_deg, image_deg), PART_OF_SLIT)
    })
}
