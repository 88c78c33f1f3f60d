//! Microfacet models as they are fitted: one roughness or two, and, where they are free, the power of the tails and the
//! index of clear facets.
//!
//! The shape is (a) or (a, b, c), then ln(gamma - 1) and ln(n - 1) where they are fitted: a roughness is the logarithm of its
//! matrix, [[a + b, c], [c, a - b]], which is smooth also where alpha_x = alpha_y and no rotation is defined. n is the index of
//! the inside over the outside.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::DVec3;

use super::nodes::IncidenceNodes;
use super::pilot::Pilot;
use crate::campaign::LightSide;
use crate::optics::FacetAngle;
use crate::optics::fresnel::dielectric::f_dielectric;
use crate::optics::fresnel::schlick_weight;
use crate::theory::smith::visibility;
use crate::theory::transmission::g2_opposite;
use crate::theory::{Masking, Microfacet, Ndf};

/// Slopes that a fit may return. Beyond 10 the facets stand on edge and every larger value looks the same; below, no
/// bin resolves the lobe.
pub(super) const SLOPES: [f64; 2] = [1e-4, 10.0];
/// Distance from a bound, in the shape's parameter, that is none.
pub(super) const ON_BOUND: f64 = 1e-9;
/// Student's gamma: GGX at 2; at 100 Beckmann to a hundredth.
const GAMMAS: [f64; 2] = [2.0, 100.0];
/// Where the fit of gamma starts.
const FIRST_GAMMA: f64 = 4.0;
/// n - 1: from an interface that reflects 2.5e-9 to the densest medium that a campaign may have.
const INDICES_LESS_ONE: [f64; 2] = [1e-4, 99.0];

/// Smith's masking of a law of normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MicrofacetLaw {
    /// Law of the normals.
    pub ndf: Ndf,
    /// How shadowing and masking are joined. The direction-correlated one takes lambda = 4.41 phi/(4.41 phi + 1) of
    /// the azimuth phi between the *stretched* directions (alpha_x x, alpha_y y), not between the arms themselves:
    /// the two differ where alpha_x and alpha_y do. Arms on opposite sides have that of correlated heights.
    pub masking: Masking,
    /// Whether alpha_x, alpha_y and the rotation are fitted.
    pub anisotropic: bool,
    /// Whether gamma of Student's t is fitted, whatever `ndf` says.
    pub free_gamma: bool,
    /// The side that the light comes from where facets are clear and their index is fitted.
    pub clear: Option<LightSide>,
}

/// A shape that means something.
struct Shape {
    roughness: (f64, f64, f64),
    ndf: Ndf,
    /// Index beyond over index here.
    eta: Option<f64>,
}

impl MicrofacetLaw {
    /// A law with nothing free but its roughness, for mirrors.
    pub fn new(ndf: Ndf, masking: Masking, anisotropic: bool) -> Self {
        MicrofacetLaw { ndf, masking, anisotropic, free_gamma: false, clear: None }
    }

    /// Numbers of the roughness.
    fn slopes(self) -> usize {
        if self.anisotropic { 3 } else { 1 }
    }

    /// What the numbers behind the roughness are: name, bounds, where the fit starts.
    fn further(self, pilot_index: f64) -> Vec<(&'static str, [f64; 2], f64)> {
        let gamma = ("gamma", GAMMAS.map(|gamma| (gamma - 1.0).ln()), (FIRST_GAMMA - 1.0).ln());
        let index = ("eta", INDICES_LESS_ONE.map(f64::ln), (pilot_index - 1.0).ln());
        self.free_gamma.then_some(gamma).into_iter().chain(self.clear.map(|_| index)).collect()
    }

    /// Where the fit of the shape starts.
    pub fn start(self, pilot: &Pilot) -> Vec<f64> {
        let mut shape = vec![pilot.log_alpha];
        if self.anisotropic {
            shape.extend(pilot.stretch);
        }
        shape.extend(self.further(pilot.index).into_iter().map(|(_, _, start)| start));
        self.confine(&mut shape);
        shape
    }

    /// What each parameter of the shape may be.
    pub fn bounds(self) -> Vec<[f64; 2]> {
        let free = [f64::NEG_INFINITY, f64::INFINITY];
        let mut bounds = vec![SLOPES.map(f64::ln)];
        bounds.resize(self.slopes(), free);
        bounds.extend(self.further(2.0).into_iter().map(|(_, bounds, _)| bounds));
        bounds
    }

    /// Shortens the stretch of an anisotropic shape until both roughnesses are slopes that a fit may return.
    pub fn confine(self, shape: &mut [f64]) {
        if let (true, [a, b, c, ..]) = (self.anisotropic, shape) {
            let (r, most) = (b.hypot(*c), (SLOPES[1].ln() - *a).min(*a - SLOPES[0].ln()));
            if r > most {
                (*b, *c) = (*b * most / r, *c * most / r);
            }
        }
    }

    /// Names of the shape's parameters that stand on a bound.
    pub fn on_bound(self, shape: &[f64]) -> Vec<&'static str> {
        let on = |value: f64, [low, high]: [f64; 2]| value <= low + ON_BOUND || value >= high - ON_BOUND;
        let slopes = SLOPES.map(f64::ln);
        let (roughness, further) = shape.split_at(self.slopes());
        let mut names = match roughness {
            [a, b, c] if [1.0, -1.0].iter().any(|sign| on(a + sign * b.hypot(*c), slopes)) => {
                vec!["alpha_x", "alpha_y"]
            }
            [a] if on(*a, slopes) => vec!["alpha"],
            _ => vec![],
        };
        let known = further.iter().zip(self.further(2.0));
        names
            .extend(known.filter(|(value, (_, bounds, _))| on(**value, *bounds)).map(|(_, (name, ..))| name));
        names
    }

    /// Names of the decoded shape.
    pub fn shape_names(self) -> Vec<&'static str> {
        let roughness: &[&str] =
            if self.anisotropic { &["alpha_x", "alpha_y", "rotation_deg"] } else { &["alpha"] };
        roughness.iter().copied().chain(self.further(2.0).into_iter().map(|(name, ..)| name)).collect()
    }

    /// The shape as reported. alpha_x belongs to the axis within 45 degrees of `rotation` (rad).
    pub fn decode(self, shape: &[f64], rotation: f64) -> Vec<f64> {
        let (alpha, further) = shape.split_at(self.slopes());
        let mut all = if self.anisotropic {
            let (alpha_x, alpha_y, turn) = roughness(alpha, rotation);
            vec![alpha_x, alpha_y, turn.to_degrees()]
        } else {
            vec![alpha[0].exp()]
        };
        all.extend(further.iter().map(|value| 1.0 + value.exp()));
        all
    }

    /// The narrowest lobe of a shape in slopes, for the layout of the nodes.
    pub fn narrowest(self, shape: &[f64]) -> f64 {
        if self.anisotropic { (shape[0] - shape[1].hypot(shape[2])).exp() } else { shape[0].exp() }
    }

    /// The index of a shape, beyond over here, where it is fitted.
    pub fn eta(self, shape: &[f64]) -> Option<f64> {
        let (side, n) = (self.clear?, 1.0 + shape.last()?.exp());
        Some(if side == LightSide::Front { n } else { 1.0 / n })
    }

    fn meant(self, shape: &[f64]) -> Shape {
        let (alpha, further) = shape.split_at(self.slopes());
        let roughness =
            if self.anisotropic { roughness(alpha, 0.0) } else { (alpha[0].exp(), alpha[0].exp(), 0.0) };
        let ndf = match further {
            [gamma, ..] if self.free_gamma => Ndf::StudentT { gamma: 1.0 + gamma.exp() },
            _ => self.ndf,
        };
        Shape { roughness, ndf, eta: self.eta(shape) }
    }

    /// Means of both bases over the bins of an incidence.
    pub fn means(self, shape: &[f64], nodes: &IncidenceNodes) -> Vec<[f64; 2]> {
        let Shape { roughness: (alpha_x, alpha_y, rotation), ndf, eta } = self.meant(shape);
        let model = Microfacet { ndf, alpha_x, alpha_y, rotation };
        nodes.means(|wi| {
            let i = model.to_sample(wi);
            let side = model.side(i);
            move |wo| {
                let o = model.to_sample(wo);
                if let (Some(eta), true) = (eta, wo.z < 0.0) {
                    let flux = model.transmitted(&side, i, o, eta);
                    let f_t = flux.map_or(0.0, |(flux, o_side)| {
                        flux * g2_opposite(self.masking, &side, &o_side) / -wo.z
                    });
                    return [f_t, 0.0];
                }
                let unit =
                    ndf.d_of_sum(i + o, alpha_x, alpha_y) * visibility(self.masking, &side, &model.side(o));
                match eta {
                    Some(eta) => [unit * f_dielectric(FacetAngle::of_pair(wi, wo), eta).mean(), 0.0],
                    None => with_schlick(unit, wi, wo),
                }
            }
        })
    }
}

pub(super) fn with_schlick(unit: f64, wi: DVec3, wo: DVec3) -> [f64; 2] {
    [unit, unit * schlick_weight(wi, wo)]
}

/// (alpha_x, alpha_y, turn) of the logarithm (a, b, c) of a matrix of roughness, the turn within 45 degrees of `near`:
/// eigenvalues exp(a +- r), r = hypot(b, c), the larger one along atan2(c, b)/2.
// Tested by `a_matrix_of_roughness_has_its_axes` and the anisotropic fits of tests/it/fit.rs.
pub fn roughness(shape: &[f64], near: f64) -> (f64, f64, f64) {
    let (a, r) = (shape[0], shape[1].hypot(shape[2]));
    let axis = 0.5 * shape[2].atan2(shape[1]);
    let quarters = ((near - axis) / FRAC_PI_2).round();
    let turn = axis + quarters * FRAC_PI_2;
    debug_assert!((turn - near).abs() <= FRAC_PI_4 + 1e-9);
    let swapped = quarters.rem_euclid(2.0) == 1.0;
    let r = if swapped { -r } else { r };
    ((a + r).exp(), (a - r).exp(), turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_of_roughness_has_its_axes() {
        // alpha 0.1 along 30 degrees and 0.4 across: the larger one lies along 120, so b and c point to 240.
        let (a, r) = (0.5 * (0.1f64 * 0.4).ln(), 0.5 * 4.0f64.ln());
        let (sin, cos) = 240f64.to_radians().sin_cos();
        let (alpha_x, alpha_y, turn) = roughness(&[a, r * cos, r * sin], 20f64.to_radians());
        // Exponentials and arc tangents of numbers near 1.
        assert!((alpha_x - 0.1).abs() < 1e-15 && (alpha_y - 0.4).abs() < 1e-15, "{alpha_x} {alpha_y}");
        assert!((turn.to_degrees() - 30.0).abs() < 1e-13, "{turn}");
        let (alpha_x, _, turn) = roughness(&[a, r * cos, r * sin], 100f64.to_radians());
        assert!((alpha_x - 0.4).abs() < 1e-15 && (turn.to_degrees() - 120.0).abs() < 1e-13);
    }
}
