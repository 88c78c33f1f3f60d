//! Polarised light: Stokes vectors, Mueller matrices of facets and their frames.
//!
//! A Stokes vector (I, Q, U, V) belongs to a ray along the unit vector k and a frame (s, p, k), right-handed: p = k x s.
//! With the field E exp(-i w t): I = |E_s|^2 + |E_p|^2, Q = |E_s|^2 - |E_p|^2, U + i V = 2 E_s conj(E_p). So V > 0 is
//! light whose field turns clockwise for who looks against it. Source: Born and Wolf 1999, 1.4; Chipman 1995.

use glam::DVec3;

use super::fresnel::{FacetAngle, Fresnel, conductor, dielectric};

/// The Mueller matrix of a smooth facet in frames whose s lies across the plane of incidence, over its reflectance (or
/// transmittance) of unpolarised light: rows (1, a, 0, 0), (a, 1, 0, 0), (0, 0, b, -c), (0, 0, c, b), a^2 + b^2 + c^2 = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolarisedFacet {
    /// (F_s - F_p)/(F_s + F_p).
    pub a: f64,
    /// 2 Re(r_s conj(r_p))/(F_s + F_p).
    pub b: f64,
    /// 2 Im(r_s conj(r_p))/(F_s + F_p).
    pub c: f64,
}

impl PolarisedFacet {
    const MIRROR: Self = PolarisedFacet { a: 0.0, b: -1.0, c: 0.0 };

    /// Reflection by a material; r_p as the field along p = k x s has it, so that a perfect mirror has a = c = 0, b = -1.
    ///
    /// - F = 1, Schlick's formula and Lambert's law know no polarisation: as of a perfect mirror.
    /// - Dielectric: r_s = -m/(c + g)^2, r_p = m((eta^2 + 1)c^2 - 1)/(eta^2 c + g)^2 (up to the common sign); in total
    ///   reflection r_s conj(r_p) is the square of the unit number along eta^2 c^2 + g^2 - i m c g, g = sqrt(-m - c^2).
    /// - Numerics: relative to 1 a few ulp; no difference of cosines.
    // Tested by `facets_turn_polarised_light_as_reference_values_say` (tests/it/facets/mueller.rs).
    pub fn reflection(fresnel: &Fresnel, angle: FacetAngle) -> Self {
        match *fresnel {
            Fresnel::Dielectric { eta } => Self::dielectric_reflection(angle, eta),
            Fresnel::Conductor { eta, k } => {
                let polarised = conductor::f_conductor(angle, eta, k);
                let z = conductor::conductor_product(angle, eta, k);
                Self::of(polarised.s, polarised.p, z)
            }
            Fresnel::Perfect | Fresnel::Schlick { .. } | Fresnel::Diffuse { .. } => Self::MIRROR,
        }
    }

    fn dielectric_reflection(angle: FacetAngle, eta: f64) -> Self {
        if let Some([r_s, r_p]) = dielectric::dielectric_amplitudes(angle, eta) {
            return Self::of(r_s * r_s, r_p * r_p, [r_s * r_p, 0.0]);
        }
        let (c, m) = (angle.cos, (eta - 1.0) * (eta + 1.0));
        let g = (-m - c * c).max(0.0).sqrt();
        let [x, y] = [eta * eta * c * c + g * g, -m * c * g];
        let length2 = x * x + y * y;
        if length2 == 0.0 {
            // Light along the facet, of an index that is 1 to rounding.
            return Self::MIRROR;
        }
        PolarisedFacet { a: 0.0, b: (x * x - y * y) / length2, c: 2.0 * x * y / length2 }
    }

    /// What goes through a dielectric of index `eta`: t_s/t_p = (eta^2 c + g)/(eta (c + g)), both real.
    ///
    /// - Below total reflection; there nothing goes through, and the answer means nothing.
    // Tested by `facets_turn_polarised_light_as_reference_values_say` (tests/it/facets/mueller.rs).
    pub fn transmission(angle: FacetAngle, eta: f64) -> Self {
        let c = angle.cos;
        let g = ((eta - 1.0) * (eta + 1.0) + c * c).max(0.0).sqrt();
        let [t_s, t_p] = [eta * eta * c + g, eta * (c + g)];
        Self::of(t_s * t_s, t_p * t_p, [t_s * t_p, 0.0])
    }

    fn of(s: f64, p: f64, [re, im]: [f64; 2]) -> Self {
        let mean = 0.5 * (s + p);
        PolarisedFacet { a: 0.5 * (s - p) / mean, b: re / mean, c: im / mean }
    }
}

/// A ray's frame: `s` and the direction `k`, unit vectors at right angles; p = k x s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Across.
    pub s: DVec3,
    /// Along the ray.
    pub k: DVec3,
}

impl Frame {
    /// The frame of a ray whose s is nearest to `across`, of any length and not along the ray.
    pub fn near(across: DVec3, k: DVec3) -> Self {
        Frame { s: (across - across.dot(k) * k).normalize(), k }
    }

    /// cos and sin of twice the angle from this frame's s towards its p at which another s lies.
    fn double_turn(&self, s: DVec3) -> [f64; 2] {
        let (x, y) = (s.dot(self.s), s.dot(self.k.cross(self.s)));
        let length2 = x * x + y * y;
        [(x * x - y * y) / length2, 2.0 * x * y / length2]
    }
}

/// The Mueller matrix of a path up to here, row by row, from the frame of its light to the frame of its last ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MuellerPath {
    rows: [[f64; 4]; 4],
    frame: Frame,
}

/// Below this sine of the angle of incidence a facet is met along its normal: all planes are alike to 1e-20, and the
/// cross product has lost six of its digits.
const ALONG_NORMAL: f64 = 1e-10;

impl MuellerPath {
    /// Light in its frame, met by nothing yet.
    pub fn new(light: Frame) -> Self {
        let row = |i: usize| std::array::from_fn(|j| f64::from(i == j));
        MuellerPath { rows: std::array::from_fn(row), frame: light }
    }

    /// A facet of this `normal` (unit vector, of either sign) sends the ray on along `to`.
    pub fn meet(&mut self, normal: DVec3, to: DVec3, facet: PolarisedFacet) {
        let across = self.frame.k.cross(normal);
        if across.length_squared() > ALONG_NORMAL * ALONG_NORMAL {
            self.turn(across.normalize());
        }
        let [one, two, three, four] = self.rows;
        let PolarisedFacet { a, b, c } = facet;
        let sum = |x: f64, first: [f64; 4], y: f64, second: [f64; 4]| {
            std::array::from_fn(|j| x * first[j] + y * second[j])
        };
        self.rows =
            [sum(1.0, one, a, two), sum(a, one, 1.0, two), sum(b, three, -c, four), sum(c, three, b, four)];
        self.frame = Frame::near(self.frame.s, to);
    }

    /// Its matrix in a frame whose s is nearest to `across`, row by row.
    pub fn seen(mut self, across: DVec3) -> [f64; 16] {
        self.turn(Frame::near(across, self.frame.k).s);
        std::array::from_fn(|element| self.rows[element / 4][element % 4])
    }

    fn turn(&mut self, s: DVec3) {
        let [cos, sin] = self.frame.double_turn(s);
        let [_, q, u, _] = self.rows;
        self.rows[1] = std::array::from_fn(|j| cos * q[j] + sin * u[j]);
        self.rows[2] = std::array::from_fn(|j| cos * u[j] - sin * q[j]);
        self.frame.s = s;
    }
}

/// The sign of each element for the mirror image of a path: where only one of Q and U (or V) stands, it turns about.
pub fn mirror_sign(element: usize) -> f64 {
    if (element / 4 < 2) == (element % 4 < 2) { 1.0 } else { -1.0 }
}
