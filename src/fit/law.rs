//! The models that are fitted: their parameters, and their means over the bins of an incidence.
//!
//! A model is a *shape* (roughness, exponent, ...) and amplitudes that it depends on linearly, one set for each colour:
//! f = amplitude_0 basis_0 + amplitude_1 basis_1 (empirical), f = basis_0 (F = 1) or f = F0 (basis_0 - basis_1) +
//! basis_1 (Schlick, basis_1 the mean with (1-c)^5). Shapes are fitted as logarithms, so every roughness is positive.

use std::f64::consts::FRAC_PI_2;

use super::data::FitData;
use super::microfacet_law::{MicrofacetLaw, ON_BOUND, SLOPES, with_schlick};
use super::nodes::IncidenceNodes;
use super::pilot::Pilot;
use crate::campaign::{LightSide, SurfaceKind};
use crate::theory::{Masking, Ndf, cavities, empirical};

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
    Microfacet(MicrofacetLaw),
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

/// Exponents: the lobe of 0.01 is the hemisphere's, that of 1e6 is as narrow as a slope of 0.0014.
const EXPONENTS: [f64; 2] = [0.01, 1e6];
/// Tilts: no facet is turned further than upright.
const TILTS: [f64; 2] = [1e-4, FRAC_PI_2];
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
        if data.grid.looks_below() {
            // None of them knows light that has gone through.
            laws.clear();
        }
        laws.extend([Ndf::Beckmann, Ndf::Ggx].into_iter().flat_map(|ndf| FitLaw::of_normals(ndf, data)));
        laws
    }

    /// One law of normals with every masking.
    pub fn of_normals(ndf: Ndf, data: &FitData) -> Vec<FitLaw> {
        let kinds: Vec<bool> = [false, true].into_iter().filter(|two| !two || data.absolute).collect();
        let sides: Vec<Option<LightSide>> =
            if data.clear.is_empty() { vec![None] } else { data.clear.iter().copied().map(Some).collect() };
        let mut laws = Vec::new();
        for masking in Masking::ALL {
            for &anisotropic in &kinds {
                let law = MicrofacetLaw::new(ndf, masking, anisotropic);
                laws.extend(sides.iter().map(|&clear| FitLaw::Microfacet(MicrofacetLaw { clear, ..law })));
            }
        }
        laws
    }

    /// Student's t with its gamma fitted, with every masking.
    // Tested by `a_students_patch_is_known_by_its_own_law` (tests/it/fit.rs).
    pub fn student_t(data: &FitData) -> Vec<FitLaw> {
        let mut laws = FitLaw::of_normals(Ndf::StudentT { gamma: 2.0 }, data);
        for law in &mut laws {
            if let FitLaw::Microfacet(law) = law {
                law.free_gamma = true;
            }
        }
        laws
    }

    /// The models of a surface's own law of normals where they are not among `all`.
    // Tested by `a_students_patch_is_known_by_its_own_law` (tests/it/fit.rs).
    pub fn of_surface(kind: &SurfaceKind, data: &FitData) -> Vec<FitLaw> {
        match kind {
            SurfaceKind::StudentT { .. } => FitLaw::student_t(data),
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
            FitLaw::Microfacet(law) => law.ndf.name(),
        }
    }

    /// The masking's name, where the model has one.
    pub fn masking(self) -> Option<&'static str> {
        match self {
            FitLaw::CookTorrance | FitLaw::TorranceSparrow => Some("v_cavity"),
            FitLaw::Microfacet(law) => Some(law.masking.name()),
            _ => None,
        }
    }

    /// Whether the model has two roughnesses.
    pub fn is_anisotropic(self) -> bool {
        matches!(self, FitLaw::Microfacet(law) if law.anisotropic)
    }

    /// How the basis makes a BRDF of this table's optics.
    pub fn amplitudes(self, perfect_mirror: bool) -> Amplitudes {
        match self {
            FitLaw::Lambert | FitLaw::OrenNayar => Amplitudes::One,
            FitLaw::Phong | FitLaw::BlinnPhong => Amplitudes::Two,
            FitLaw::Microfacet(law) if law.clear.is_some() => Amplitudes::Fixed,
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
            FitLaw::Microfacet(law) => law.start(pilot),
        }
    }

    /// What each parameter of the shape may be.
    pub fn bounds(self) -> Vec<[f64; 2]> {
        match self {
            FitLaw::Lambert => vec![],
            FitLaw::OrenNayar => vec![[0.0, TILTS[1]]],
            FitLaw::Phong | FitLaw::BlinnPhong => vec![EXPONENTS.map(f64::ln)],
            FitLaw::TorranceSparrow => vec![TILTS.map(f64::ln)],
            FitLaw::CookTorrance => vec![SLOPES.map(f64::ln)],
            FitLaw::Microfacet(law) => law.bounds(),
        }
    }

    /// Moves a shape to where a fit may end.
    pub fn confine(self, shape: &mut [f64]) {
        if let FitLaw::Microfacet(law) = self {
            law.confine(shape);
        }
    }

    /// Names of the shape's parameters that stand on a bound.
    pub fn on_bound(self, shape: &[f64]) -> Vec<&'static str> {
        if let FitLaw::Microfacet(law) = self {
            return law.on_bound(shape);
        }
        let on = |value: f64, [low, high]: [f64; 2]| value <= low + ON_BOUND || value >= high - ON_BOUND;
        let all = shape.iter().zip(self.bounds()).zip(self.shape_names());
        all.filter(|((value, bounds), _)| on(**value, *bounds)).map(|(_, name)| name).collect()
    }

    /// Names of the decoded shape.
    pub fn shape_names(self) -> Vec<&'static str> {
        match self {
            FitLaw::Lambert => vec![],
            FitLaw::OrenNayar => vec!["sigma_deg"],
            FitLaw::Phong | FitLaw::BlinnPhong => vec!["exponent"],
            FitLaw::CookTorrance => vec!["m"],
            FitLaw::TorranceSparrow => vec!["m_deg"],
            FitLaw::Microfacet(law) => law.shape_names(),
        }
    }

    /// The shape as reported. alpha_x belongs to the axis within 45 degrees of `rotation` (rad).
    pub fn decode(self, shape: &[f64], rotation: f64) -> Vec<f64> {
        match self {
            FitLaw::Lambert => vec![],
            FitLaw::OrenNayar => vec![shape[0].to_degrees()],
            FitLaw::TorranceSparrow => vec![shape[0].exp().to_degrees()],
            FitLaw::Microfacet(law) => law.decode(shape, rotation),
            _ => vec![shape[0].exp()],
        }
    }

    /// The narrowest lobe of a shape in slopes, for the layout of the nodes.
    pub fn narrowest(self, shape: &[f64]) -> Option<f64> {
        match self {
            FitLaw::Microfacet(law) => Some(law.narrowest(shape)),
            _ => None,
        }
    }

    /// The index of a shape, beyond over here, where it is fitted.
    pub fn eta(self, shape: &[f64]) -> Option<f64> {
        if let FitLaw::Microfacet(law) = self { law.eta(shape) } else { None }
    }

    /// Means of both bases over the bins of an incidence.
    pub fn means(self, shape: &[f64], nodes: &IncidenceNodes) -> Vec<[f64; 2]> {
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
            FitLaw::Microfacet(law) => law.means(shape, nodes),
        }
    }
}
