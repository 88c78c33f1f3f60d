//! The models that are fitted: their parameters, and their means over the bins of a stop.
//!
//! A model is a *shape* (roughness, exponent, ...) and amplitudes that it depends on linearly, one set for each colour:
//! f = amplitude_0 basis_0 + amplitude_1 basis_1 (empirical), f = basis_0 (F = 1) or f = F0 (basis_0 - basis_1) +
//! basis_1 (Schlick, basis_1 the mean with (1-c)^5). Shapes are fitted as logarithms, so every roughness is positive;
//! an anisotropic one as the logarithm of its matrix, [[a + b, c], [c, a - b]], which is smooth also where alpha_x =
//! alpha_y and no rotation is defined.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::DVec3;

use super::data::FitData;
use super::nodes::StopNodes;
use super::pilot::Pilot;
use crate::campaign::SurfaceKind;
use crate::optics::fresnel::schlick_weight;
use crate::theory::smith::visibility;
use crate::theory::{Masking, Microfacet, Ndf, cavities, empirical};

/// A model that can be fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FitLaw {
    /// The same in all directions.
    Lambert,
    /// Rough and diffuse.
    OrenNayar,
    /// A lobe about the mirror direction, and a diffuse part.
    Phong,
    /// A lobe about the half vector, and a diffuse part.
    BlinnPhong,
    /// Beckmann's slopes on V-cavities.
    CookTorrance,
    /// Gaussian tilts on V-cavities.
    TorranceSparrow,
    /// Smith's masking.
    Microfacet {
        /// Law of the normals.
        ndf: Ndf,
        /// How shadowing and masking are joined. The direction-correlated one takes lambda = 4.41 phi/(4.41 phi + 1) of
        /// the azimuth phi between the *stretched* directions (alpha_x x, alpha_y y), not between the arms themselves:
        /// the two differ where alpha_x and alpha_y do.
        masking: Masking,
        /// Whether alpha_x, alpha_y and the rotation are fitted.
        anisotropic: bool,
    },
}

/// How the basis makes a BRDF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Amplitudes {
    /// F = 1: none.
    Fixed,
    /// F0.
    Schlick,
    /// One factor of basis 0.
    One,
    /// A factor of each basis.
    Two,
}

/// Names that `--model` takes.
pub const NAMES: [&str; 9] = [
    "lambert",
    "oren_nayar",
    "phong",
    "blinn_phong",
    "cook_torrance",
    "torrance_sparrow",
    "beckmann",
    "ggx",
    "student_t",
];

/// Slopes that a fit may return. Beyond 10 the facets stand on edge and every larger value looks the same; below, no
/// bin resolves the lobe.
const SLOPES: [f64; 2] = [1e-4, 10.0];
/// Exponents: the lobe of 0.01 is the hemisphere's, that of 1e6 is as narrow as a slope of 0.0014.
const EXPONENTS: [f64; 2] = [0.01, 1e6];
/// Tilts: no facet is turned further than upright.
const TILTS: [f64; 2] = [1e-4, FRAC_PI_2];
/// Distance from a bound, in the shape's parameter, that is none.
const ON_BOUND: f64 = 1e-9;

impl Amplitudes {
    /// Amplitudes that each colour adds to the parameters.
    pub fn per_colour(self) -> usize {
        match self {
            Amplitudes::Fixed => 0,
            Amplitudes::Schlick | Amplitudes::One => 1,
            Amplitudes::Two => 2,
        }
    }
}

impl FitLaw {
    /// All models that a table can be tested against: anisotropic ones only where azimuths are distinguished.
    pub fn all(data: &FitData) -> Vec<FitLaw> {
        let mut laws = vec![
            FitLaw::Lambert,
            FitLaw::OrenNayar,
            FitLaw::Phong,
            FitLaw::BlinnPhong,
            FitLaw::CookTorrance,
            FitLaw::TorranceSparrow,
        ];
        laws.extend([Ndf::Beckmann, Ndf::Ggx].into_iter().flat_map(|ndf| FitLaw::of_normals(ndf, data)));
        laws
    }

    /// One law of normals with every masking.
    pub fn of_normals(ndf: Ndf, data: &FitData) -> Vec<FitLaw> {
        let kinds = [false, true].into_iter().filter(|anisotropic| !anisotropic || data.absolute);
        let pairs =
            Masking::ALL.into_iter().flat_map(|masking| kinds.clone().map(move |kind| (masking, kind)));
        pairs.map(|(masking, anisotropic)| FitLaw::Microfacet { ndf, masking, anisotropic }).collect()
    }

    /// The models of a surface's own law of normals where they are not among `all`: those of Student's t, whose gamma only
    /// the campaign knows.
    // Tested by `a_students_patch_is_known_by_its_own_law` (tests/it/fit.rs).
    pub fn of_surface(kind: &SurfaceKind, data: &FitData) -> Vec<FitLaw> {
        match kind {
            SurfaceKind::StudentT { gamma, .. } => FitLaw::of_normals(Ndf::StudentT { gamma: *gamma }, data),
            SurfaceKind::BlinnPhong { .. } => FitLaw::of_normals(Ndf::BlinnPhong, data),
            _ => Vec::new(),
        }
    }

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            FitLaw::Lambert => "lambert",
            FitLaw::OrenNayar => "oren_nayar",
            FitLaw::Phong => "phong",
            FitLaw::BlinnPhong => "blinn_phong",
            FitLaw::CookTorrance => "cook_torrance",
            FitLaw::TorranceSparrow => "torrance_sparrow",
            FitLaw::Microfacet { ndf, .. } => ndf.name(),
        }
    }

    /// The masking's name, where the model has one.
    pub fn masking(self) -> Option<&'static str> {
        match self {
            FitLaw::CookTorrance | FitLaw::TorranceSparrow => Some("v_cavity"),
            FitLaw::Microfacet { masking, .. } => Some(masking.name()),
            _ => None,
        }
    }

    /// Whether the model has two roughnesses.
    pub fn is_anisotropic(self) -> bool {
        matches!(self, FitLaw::Microfacet { anisotropic: true, .. })
    }

    /// How the basis makes a BRDF of this table's optics.
    pub fn amplitudes(self, perfect_mirror: bool) -> Amplitudes {
        match self {
            FitLaw::Lambert | FitLaw::OrenNayar => Amplitudes::One,
            FitLaw::Phong | FitLaw::BlinnPhong => Amplitudes::Two,
            _ if perfect_mirror => Amplitudes::Fixed,
            _ => Amplitudes::Schlick,
        }
    }

    /// Where the fit of the shape starts.
    pub fn start(self, pilot: &Pilot) -> Vec<f64> {
        let log_alpha = pilot.log_alpha;
        // Lobes of equal width: (cos d)^n against exp(-(d/alpha)^2), d the half vector's angle, n = 2/alpha^2.
        let exponent = (2.0f64.ln() - 2.0 * log_alpha).max(0.0);
        match self {
            FitLaw::Lambert => vec![],
            FitLaw::OrenNayar => vec![0.5],
            FitLaw::Phong => vec![exponent - 4.0f64.ln()],
            FitLaw::BlinnPhong => vec![exponent],
            FitLaw::CookTorrance | FitLaw::TorranceSparrow => vec![log_alpha],
            FitLaw::Microfacet { anisotropic: false, .. } => vec![log_alpha],
            FitLaw::Microfacet { anisotropic: true, .. } => {
                let mut shape = vec![log_alpha, pilot.stretch[0], pilot.stretch[1]];
                self.confine(&mut shape);
                shape
            }
        }
    }

    /// What each parameter of the shape may be.
    pub fn bounds(self) -> Vec<[f64; 2]> {
        let free = [f64::NEG_INFINITY, f64::INFINITY];
        match self {
            FitLaw::Lambert => vec![],
            FitLaw::OrenNayar => vec![[0.0, TILTS[1]]],
            FitLaw::Phong | FitLaw::BlinnPhong => vec![EXPONENTS.map(f64::ln)],
            FitLaw::TorranceSparrow => vec![TILTS.map(f64::ln)],
            FitLaw::CookTorrance | FitLaw::Microfacet { anisotropic: false, .. } => vec![SLOPES.map(f64::ln)],
            FitLaw::Microfacet { anisotropic: true, .. } => vec![SLOPES.map(f64::ln), free, free],
        }
    }

    /// Shortens the stretch of an anisotropic shape until both roughnesses are slopes that a fit may return.
    pub fn confine(self, shape: &mut [f64]) {
        if let [a, b, c] = shape {
            let (r, most) = (b.hypot(*c), (SLOPES[1].ln() - *a).min(*a - SLOPES[0].ln()));
            if r > most {
                (*b, *c) = (*b * most / r, *c * most / r);
            }
        }
    }

    /// Names of the shape's parameters that stand on a bound.
    pub fn on_bound(self, shape: &[f64]) -> Vec<&'static str> {
        let on = |value: f64, [low, high]: [f64; 2]| value <= low + ON_BOUND || value >= high - ON_BOUND;
        match shape {
            [a, b, c] => {
                let (r, slopes) = (b.hypot(*c), SLOPES.map(f64::ln));
                let ends = on(a + r, slopes) || on(a - r, slopes);
                if ends { vec!["alpha_x", "alpha_y"] } else { vec![] }
            }
            _ => {
                let all = shape.iter().zip(self.bounds()).zip(self.shape_names());
                all.filter(|((value, bounds), _)| on(**value, *bounds)).map(|(_, name)| *name).collect()
            }
        }
    }

    /// Names of the decoded shape.
    pub fn shape_names(self) -> &'static [&'static str] {
        match self {
            FitLaw::Lambert => &[],
            FitLaw::OrenNayar => &["sigma_deg"],
            FitLaw::Phong | FitLaw::BlinnPhong => &["exponent"],
            FitLaw::CookTorrance => &["m"],
            FitLaw::TorranceSparrow => &["m_deg"],
            FitLaw::Microfacet { anisotropic: false, .. } => &["alpha"],
            FitLaw::Microfacet { anisotropic: true, .. } => &["alpha_x", "alpha_y", "rotation_deg"],
        }
    }

    /// The shape as reported. alpha_x belongs to the axis within 45 degrees of `rotation` (rad).
    pub fn decode(self, shape: &[f64], rotation: f64) -> Vec<f64> {
        match self {
            FitLaw::Lambert => vec![],
            FitLaw::OrenNayar => vec![shape[0].to_degrees()],
            FitLaw::TorranceSparrow => vec![shape[0].exp().to_degrees()],
            FitLaw::Microfacet { anisotropic: true, .. } => {
                let (alpha_x, alpha_y, turn) = roughness(shape, rotation);
                vec![alpha_x, alpha_y, turn.to_degrees()]
            }
            _ => vec![shape[0].exp()],
        }
    }

    /// The narrowest lobe of a shape in slopes, for the layout of the nodes.
    pub fn narrowest(self, shape: &[f64]) -> Option<f64> {
        match self {
            FitLaw::Microfacet { anisotropic: true, .. } => Some((shape[0] - shape[1].hypot(shape[2])).exp()),
            FitLaw::Microfacet { .. } => Some(shape[0].exp()),
            _ => None,
        }
    }

    /// Means of both bases over the bins of a stop.
    pub fn means(self, shape: &[f64], nodes: &StopNodes) -> Vec<[f64; 2]> {
        let diffuse = empirical::LAMBERT;
        match self {
            FitLaw::Lambert => vec![[diffuse, 0.0]; nodes.ends.len()],
            FitLaw::OrenNayar => nodes.means(|wi| move |wo| [empirical::oren_nayar(wi, wo, shape[0]), 0.0]),
            FitLaw::Phong => nodes.means(|wi| move |wo| [empirical::phong(wi, wo, shape[0].exp()), diffuse]),
            FitLaw::BlinnPhong => {
                nodes.means(|wi| move |wo| [empirical::blinn_phong(wi, wo, shape[0].exp()), diffuse])
            }
            FitLaw::CookTorrance => {
                let m = shape[0].exp();
                nodes.means(|wi| move |wo| with_schlick(cavities::cook_torrance(wi, wo, m), wi, wo))
            }
            FitLaw::TorranceSparrow => {
                let m = shape[0].exp();
                let b = cavities::gaussian_tilt_scale(m);
                nodes.means(|wi| move |wo| with_schlick(cavities::torrance_sparrow(wi, wo, m, b), wi, wo))
            }
            FitLaw::Microfacet { ndf, masking, .. } => {
                let (alpha_x, alpha_y, rotation) = match shape {
                    [log_alpha] => (log_alpha.exp(), log_alpha.exp(), 0.0),
                    _ => roughness(shape, 0.0),
                };
                let model = Microfacet { ndf, alpha_x, alpha_y, rotation };
                nodes.means(|wi| {
                    let i = model.to_sample(wi);
                    let side = model.side(i);
                    move |wo| {
                        let o = model.to_sample(wo);
                        let unit = ndf.d_of_sum(i + o, alpha_x, alpha_y)
                            * visibility(masking, &side, &model.side(o));
                        with_schlick(unit, wi, wo)
                    }
                })
            }
        }
    }
}

fn with_schlick(unit: f64, wi: DVec3, wo: DVec3) -> [f64; 2] {
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
