//! The Klems bases: the hemisphere as 145, 73 or 41 patches in rings.
//!
//! Patch j of a ring of n is centred on azimuth 360 j/n. A patch of the light names the direction in which light
//! travels on, so its incidence is opposite. Source: Radiance's bsdf_m.c, after Klems and Warner 1995.

use std::str::FromStr;

use crate::campaign::SensorSide;
use crate::sphere;

/// Polar angles of a ring in degrees, and how many patches it has.
pub type Ring = (f64, f64, usize);

/// The rings of the full basis.
pub const FULL: [Ring; 9] = [
    (0.0, 5.0, 1),
    (5.0, 15.0, 8),
    (15.0, 25.0, 16),
    (25.0, 35.0, 20),
    (35.0, 45.0, 24),
    (45.0, 55.0, 24),
    (55.0, 65.0, 24),
    (65.0, 75.0, 16),
    (75.0, 90.0, 12),
];

/// The rings of the half basis.
const HALF: [Ring; 7] = [
    (0.0, 6.5, 1),
    (6.5, 19.5, 8),
    (19.5, 32.5, 12),
    (32.5, 46.5, 16),
    (46.5, 61.5, 20),
    (61.5, 76.5, 12),
    (76.5, 90.0, 4),
];

/// The rings of the quarter basis.
const QUARTER: [Ring; 5] =
    [(0.0, 9.0, 1), (9.0, 27.0, 8), (27.0, 46.0, 12), (46.0, 66.0, 12), (66.0, 90.0, 8)];

/// The bases that have a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// 145 patches.
    Full,
    /// 73 patches.
    Half,
    /// 41 patches.
    Quarter,
}

impl Basis {
    /// All.
    pub const ALL: [Basis; 3] = [Basis::Full, Basis::Half, Basis::Quarter];

    /// Its rings, from the normal outwards.
    pub fn rings(self) -> &'static [Ring] {
        match self {
            Basis::Full => &FULL,
            Basis::Half => &HALF,
            Basis::Quarter => &QUARTER,
        }
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Basis::Full => "LBNL/Klems Full",
            Basis::Half => "LBNL/Klems Half",
            Basis::Quarter => "LBNL/Klems Quarter",
        }
    }
}

impl FromStr for Basis {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "full" => Ok(Basis::Full),
            "half" => Ok(Basis::Half),
            "quarter" => Ok(Basis::Quarter),
            _ => Err("full, half or quarter needed".into()),
        }
    }
}

/// The rings that make these patches; `None` where they are no basis that reaches from the normal to the horizon.
pub fn rings_of(patches_deg: &[[f64; 4]]) -> Option<Vec<Ring>> {
    let mut rings: Vec<Ring> = vec![];
    for &[low, high, ..] in patches_deg {
        match rings.last_mut() {
            Some(ring) if (ring.0, ring.1) == (low, high) => ring.2 += 1,
            _ => rings.push((low, high, 1)),
        }
    }
    let whole = rings.first()?.0 == 0.0 && rings.last()?.1 == 90.0;
    let closed = rings.windows(2).all(|pair| pair[0].1 == pair[1].0);
    (whole && closed && patches(&rings) == patches_deg).then_some(rings)
}

/// The patches of a basis, ring by ring: [theta_lo, theta_hi, phi_lo, phi_hi] in degrees.
pub fn patches(rings: &[Ring]) -> Vec<[f64; 4]> {
    let ring = |&(low, high, n): &Ring| {
        let step = 360.0 / n as f64;
        (0..n).map(move |j| [low, high, step * (j as f64 - 0.5), step * (j as f64 + 0.5)])
    };
    rings.iter().flat_map(ring).collect()
}

/// The patches above the horizon, their images in its mirror below, or both.
pub fn patches_of_side(rings: &[Ring], side: SensorSide) -> Vec<[f64; 4]> {
    let above = patches(rings);
    let below = above.iter().map(|&[t1, t2, p1, p2]| [180.0 - t2, 180.0 - t1, p1, p2]);
    match side {
        SensorSide::Reflection => above,
        SensorSide::Transmission => below.collect(),
        SensorSide::Both => above.iter().copied().chain(below).collect(),
    }
}

/// (theta_i, phi_i) in degrees of the incidences in the middle of the light's patches; of a whole ring's at its upper
/// edge.
pub fn middles(light: &[[f64; 4]]) -> Vec<[f64; 2]> {
    let middle = |&[t1, t2, p1, p2]: &[f64; 4]| {
        let theta = if p2 - p1 == 360.0 { t1 } else { 0.5 * (t1 + t2) };
        [theta, sphere::reduced_deg(0.5 * (p1 + p2) + 180.0)]
    };
    light.iter().map(middle).collect()
}
