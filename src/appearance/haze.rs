//! Reflection haze at 20 degrees (ISO 13803), haze and distinctness of image at 30 degrees (the quantities of ASTM E430).
//!
//! Receptors off the mirror direction stand on both sides of it in the plane of incidence; what they read is added.

use serde::Serialize;

use super::gloss::{IMAGE_DEG, glass_reflectance, slit_reading};
use super::incidence::LightAzimuth;
use super::quantity::Quantity;
use super::reading::Reading;
use super::samples::TableSamples;

/// ISO 13803:2014: angle of the light; receptors of haze, their distance from the mirror direction.
const REFLECTION_HAZE: (f64, [f64; 2], f64) = (20.0, [1.80, 5.5], 1.9);
/// Light of the goniophotometer, degrees.
const ANGLE_DEG: f64 = 30.0;
/// Its slits for the mirror direction and 0.3 degrees off, and for haze; and its source's image.
const FINE_DEG: [f64; 2] = [0.14, 3.0];
const WIDE_DEG: [f64; 2] = [0.4, 3.0];
const FINE_IMAGE_DEG: [f64; 2] = [0.14, 3.0];

/// What instruments for haze and images say.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Haze {
    /// ISO 13803, linear: 100 times the flux into both receptors at 18.1 and 21.9 degrees over the glass's in the mirror's.
    pub reflection_haze: Quantity,
    /// 1285 log10(reflection_haze/20 + 1).
    pub log_haze: Quantity,
    /// 100 times the mean BRDF 2 degrees off the mirror direction over that in it.
    pub haze_2: Quantity,
    /// The same 5 degrees off.
    pub haze_5: Quantity,
    /// 100 (1 - the mean BRDF 0.3 degrees off the mirror direction over that in it).
    pub doi: Quantity,
}

/// Haze and distinctness of image.
// Tested by `haze_and_doi_are_ratios_of_the_analytic_brdf` (tests/it/appearance/gloss.rs).
pub fn haze(samples: &TableSamples, light: &LightAzimuth) -> Haze {
    let (angle, size, off) = REFLECTION_HAZE;
    let glass = glass_reflectance(angle);
    let beside = both_sides(samples, light, angle, (off, size, IMAGE_DEG));
    let linear = |v: &[f64]| 100.0 * samples.luminance(v, 0) / glass;
    let of_beside = |f: &dyn Fn(&[f64]) -> f64| match &beside {
        Ok(reading) => samples.quantity(&[reading], f),
        Err(why) => Quantity::missing(why.clone()),
    };
    Haze {
        reflection_haze: of_beside(&linear),
        log_haze: of_beside(&|v| 1285.0 * (linear(v) / 20.0 + 1.0).log10()),
        haze_2: ratio(samples, light, (2.0, WIDE_DEG), |r| 100.0 * r),
        haze_5: ratio(samples, light, (5.0, WIDE_DEG), |r| 100.0 * r),
        doi: ratio(samples, light, (0.3, FINE_DEG), |r| 100.0 * (1.0 - r)),
    }
}

/// A figure of the mean BRDF so many degrees off the mirror direction over that in it.
fn ratio(
    samples: &TableSamples,
    light: &LightAzimuth,
    (off_deg, size_deg): (f64, [f64; 2]),
    of: impl Fn(f64) -> f64,
) -> Quantity {
    let specular = slit_reading(samples, light, ANGLE_DEG, (0.0, FINE_DEG, FINE_IMAGE_DEG));
    let beside = both_sides(samples, light, ANGLE_DEG, (off_deg, size_deg, FINE_IMAGE_DEG));
    let (specular, beside) = match (specular, beside) {
        (Ok(specular), Ok(beside)) => (mean(specular), mean(beside)),
        (Err(why), _) | (_, Err(why)) => return Quantity::missing(why),
    };
    samples.quantity(&[&specular, &beside], |v| of(samples.luminance(v, 1) / samples.luminance(v, 0)))
}

fn mean(reading: Reading) -> Reading {
    let measure = reading.measure;
    reading.scaled(1.0 / measure)
}

/// What two slits read together, as far on either side of the mirror direction.
fn both_sides(
    samples: &TableSamples,
    light: &LightAzimuth,
    angle_deg: f64,
    (off_deg, size_deg, image_deg): (f64, [f64; 2], [f64; 2]),
) -> Result<Reading, String> {
    let side = |off| slit_reading(samples, light, angle_deg, (off, size_deg, image_deg));
    Ok(side(-off_deg)?.plus(side(off_deg)?))
}
