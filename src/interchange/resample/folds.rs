//! Azimuths of the light that were not measured, but follow from those that were: the law of a surface that the
//! program made is its own mirror image about both axes of the sample.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use crate::campaign;
use crate::campaign::SurfaceKind;
use crate::table::BrdfTable;

/// Azimuths nearer than this are one, rad.
const SAME: f64 = 1e-9;

/// A measured azimuth, or a mirror image of one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fold {
    /// Which of the measured ones, in increasing order.
    pub place: usize,
    /// The image of phi is sign phi + shift.
    sign: f64,
    shift: f64,
}

impl Fold {
    /// The measured azimuths alone.
    pub fn none(count: usize) -> Vec<Self> {
        (0..count).map(|place| Fold { place, sign: 1.0, shift: 0.0 }).collect()
    }

    /// An azimuth as the measured incidence sees it.
    pub fn azimuth(&self, phi: f64) -> f64 {
        self.sign * phi + self.shift
    }
}

/// The azimuths with their mirror images, increasing, where the campaign says that the surface has them; else as they
/// are.
// Tested by `a_quarter_of_the_azimuths_is_unfolded`, `an_imported_quarter_is_refused`.
pub(crate) fn unfolded(phi_i: &[f64], table: &BrdfTable) -> (Vec<f64>, Vec<Fold>) {
    let mut all: Vec<(f64, Fold)> = phi_i.iter().copied().zip(Fold::none(phi_i.len())).collect();
    if let Some(axis) = mirror_axis(table) {
        // About the axis, across it, and both.
        for (sign, shift) in [(-1.0, 2.0 * axis), (-1.0, 2.0 * axis + PI), (1.0, PI)] {
            for (place, &phi) in phi_i.iter().enumerate() {
                let image = (sign * (phi - shift)).rem_euclid(TAU);
                let off = |known: f64| (known - image + PI).rem_euclid(TAU) - PI;
                if all.iter().all(|(known, _)| off(*known).abs() > SAME) {
                    all.push((image, Fold { place, sign, shift }));
                }
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    all.into_iter().unzip()
}

/// The azimuth of the sample's x axis, rad, where the surface's law is known to be symmetric about it.
fn mirror_axis(table: &BrdfTable) -> Option<f64> {
    if table.campaign.is_empty() || table.grid.phi_r_relative {
        return None;
    }
    let surface = campaign::parse(&table.campaign, "campaign", Path::new("")).ok()?.campaign.surface;
    (!matches!(surface.kind, SurfaceKind::File(_))).then(|| surface.rotation_deg.to_radians())
}
