//! Analytic BRDFs as tables, for the tests of files: bin means by quadrature, or values at points.

use glam::DVec3;
use gonio::instrument::{Grid, GridKind};
use gonio::interchange::{Brdf, Colour, resample};
use gonio::optics::Fresnel;
use gonio::table::BrdfTable;
use gonio::theory::{Masking, Microfacet, Ndf};

/// GGX with separable masking, F = 1, times a tint for each colour.
pub struct Ggx {
    pub model: Microfacet,
    pub tint: Vec<f64>,
}

impl Ggx {
    pub fn new(alpha_x: f64, alpha_y: f64) -> Self {
        Ggx { model: Microfacet { ndf: Ndf::Ggx, alpha_x, alpha_y, rotation: 0.0 }, tint: vec![1.0] }
    }
}

impl Brdf for Ggx {
    fn colours(&self) -> usize {
        self.tint.len()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let f = self.model.brdf(wi, wo, Masking::Separable, &Fresnel::Perfect);
        std::array::from_fn(|c| f * self.tint.get(c).copied().unwrap_or(1.0))
    }
}

/// An even part of this albedo, and so much of a lobe beside it.
pub struct Painted {
    pub paint: f64,
    pub lobe: Option<(f64, Ggx)>,
}

impl Brdf for Painted {
    fn colours(&self) -> usize {
        1
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let lobe = self.lobe.as_ref().map_or(0.0, |(share, lobe)| share * lobe.brdf(wi, wo)[0]);
        [self.paint / std::f64::consts::PI + lobe; 3]
    }
}

/// Even steps from 0.
pub fn steps(step: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| step * k as f64).collect()
}

/// Incidences over rows x columns of bins, 90/rows and 360/columns degrees each, edges on multiples of the step.
pub fn hemisphere(theta_i_deg: Vec<f64>, phi_i_deg: Option<Vec<f64>>, rows: usize, columns: usize) -> Grid {
    Grid {
        theta_i_deg,
        phi_r_relative: phi_i_deg.is_none(),
        phi_i_deg: phi_i_deg.unwrap_or(vec![0.0]),
        theta_r_edges_deg: (0..=rows).map(|k| 90.0 * k as f64 / rows as f64).collect(),
        phi_r_edges_deg: (0..=columns).map(|k| 360.0 * k as f64 / columns as f64).collect(),
        ..Grid::default()
    }
}

/// Points over theta x phi.
pub fn points(theta_i_deg: Vec<f64>, phi_i_deg: Vec<f64>, theta_r: &[f64], phi_r: &[f64]) -> Grid {
    let row = |&t: &f64| phi_r.iter().map(move |&p| [t, p]).collect::<Vec<_>>();
    Grid {
        kind: GridKind::Points,
        phi_r_relative: phi_i_deg.len() == 1,
        theta_i_deg,
        phi_i_deg,
        points_deg: theta_r.iter().flat_map(row).collect(),
        ..Grid::default()
    }
}

pub fn table(brdf: &dyn Brdf, grid: &Grid) -> BrdfTable {
    resample(brdf, grid).expect("a sound grid")
}

/// Every channel different, for round trips.
pub fn measured_looking(brdf: &dyn Brdf, grid: &Grid) -> BrdfTable {
    let mut table = table(brdf, grid);
    for (c, colour) in table.colours.iter_mut().enumerate() {
        let shift = |k: usize, by: f32| (k % 97) as f32 * 0.01 + by + c as f32;
        colour.single.iter_mut().enumerate().for_each(|(k, v)| *v = shift(k, 0.5));
        colour.multiple.iter_mut().enumerate().for_each(|(k, v)| *v = shift(k, 0.25));
        colour.stderr.iter_mut().enumerate().for_each(|(k, v)| *v = shift(k, 0.125));
        colour.stderr_single.iter_mut().enumerate().for_each(|(k, v)| *v = shift(k, 0.0625));
    }
    table.hits.iter_mut().enumerate().for_each(|(k, hits)| *hits = k as u32);
    (table.campaign, table.seed, table.patch_digest) = ("name = \"µ\"\n".into(), u64::MAX, "ab12".into());
    table
}

/// sum |a - b| w / sum b w over pairs with sines and cosines as weights: polar angles in steps of 2 degrees up to
/// `last_deg` for the light, 1 degree for the sensor, azimuths in steps of 7.
pub fn l1(found: &dyn Brdf, wanted: &dyn Brdf, light: &[(f64, f64)], last_deg: f64) -> f64 {
    let (mut distance, mut sum) = (0.0, 0.0);
    for &(theta_i, phi_i) in light {
        let wi = gonio::sphere::direction_deg(theta_i, phi_i);
        for k in 0..(last_deg as usize) {
            for p in 0..51 {
                let wo = gonio::sphere::direction_deg(k as f64 + 0.5, 7.0 * f64::from(p) + 1.3);
                let w = wo.z * wo.x.hypot(wo.y);
                let (f, g) = (found.brdf(wi, wo)[0], wanted.brdf(wi, wo)[0]);
                distance += w * (f - g).abs();
                sum += w * g;
            }
        }
    }
    distance / sum
}
