//! What a path carries besides its geometry: the (1-c)^5 of its first bounce and the light left in each colour.

use glam::DVec3;

use crate::campaign::Optics;
use crate::optics::fresnel::schlick_weight;
use crate::trace::Bounce;

/// F0 in each colour; `None` for F = 1.
pub fn f0_of(optics: &Optics) -> Option<[f64; 3]> {
    match optics {
        Optics::PerfectMirror => None,
        Optics::Schlick { f0, .. } => Some(*f0),
    }
}

/// F0 of each colour of the table: one `None` for F = 1.
pub fn colours_of(optics: &Optics) -> Vec<Option<f64>> {
    f0_of(optics).map_or_else(|| vec![None], |f0| f0.map(Some).to_vec())
}

/// The light of one path.
#[derive(Debug, Clone, Copy)]
pub struct Light {
    f0: Option<[f64; 3]>,
    /// (1-c)^5 of the first bounce.
    pub first: f64,
    /// Light left in each colour.
    pub throughput: [f64; 3],
    bounces: u32,
}

impl Light {
    /// The light at a start.
    pub fn new(f0: Option<[f64; 3]>) -> Self {
        Light { f0, first: 0.0, throughput: [1.0; 3], bounces: 0 }
    }
}

impl Bounce for Light {
    /// Schlick at the facet: F = F0 + (1 - F0) (1-c)^5.
    fn bounce(&mut self, wi: DVec3, wo: DVec3) {
        let Some(f0) = self.f0 else { return };
        let fifth = schlick_weight(wi, wo);
        if self.bounces == 0 {
            self.first = fifth;
        }
        self.bounces += 1;
        for (left, f0) in self.throughput.iter_mut().zip(f0) {
            *left *= f0 + (1.0 - f0) * fifth;
        }
    }
}
