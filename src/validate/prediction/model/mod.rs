//! The analytic answer to a campaign: which models speak of its surface, and their means over the table's bins.

use glam::DVec3;

use super::formulas::DiffuseModel;
use crate::campaign::{Campaign, Optics, SmithNdf, SurfaceKind};
use crate::instrument::grid_of;
use crate::optics::layered::Interface;
use crate::theory::{Masking, Microfacet, Ndf};

mod means;

/// What theory says about a surface.
#[derive(Clone)]
pub enum Model {
    /// D G2 F/(4 cos cos) with each of the maskings.
    Microfacet {
        /// The surface.
        surface: Microfacet,
        /// In the order of the comparisons.
        maskings: Vec<Masking>,
        /// Whether a plane between grains reflects as well.
        mirror_base: bool,
    },
    /// Matt facets with each of the maskings.
    Diffuse {
        /// The surface.
        surface: Microfacet,
        /// In the order of the comparisons.
        maskings: Vec<Masking>,
        /// Further models, of isotropic Gaussian slopes, after those.
        formulas: Vec<DiffuseModel>,
        /// What lies over each facet, and mirrors D F G2/(4 cos cos) besides.
        interface: Option<Interface>,
    },
    /// A flat matt surface: the same in every bin.
    Lambert,
    /// A flat layered surface.
    Flat(Interface),
    /// Mirror directions that carry all the flux.
    Lobes {
        /// The model's name.
        name: &'static str,
        /// The masking's name.
        masking: &'static str,
        /// V-groove slope; `None` for a flat mirror.
        slope: Option<f64>,
        /// The sample's turn.
        rotation: f64,
    },
}

/// Begins the names of models of matt facets.
pub const DIFFUSE: &str = "matt ";
/// Begins those of layered facets.
pub const LAYERED: &str = "layered ";

/// The law of a surface's normals; `None` of a mirror, of grooves, and of a measured map.
pub fn ndf_of(kind: &SurfaceKind) -> Option<Ndf> {
    match kind {
        SurfaceKind::Ggx(_) => Some(Ndf::Ggx),
        SurfaceKind::Beckmann { .. } | SurfaceKind::Psd(_) => Some(Ndf::Beckmann),
        SurfaceKind::StudentT { gamma, .. } => Some(Ndf::StudentT { gamma: *gamma }),
        SurfaceKind::BlinnPhong { .. } => Some(Ndf::BlinnPhong),
        SurfaceKind::Smith(smith) if smith.ndf == SmithNdf::Ggx => Some(Ndf::Ggx),
        SurfaceKind::Smith(_) => Some(Ndf::Beckmann),
        SurfaceKind::Grains(grains) => Some(Ndf::Grains { coverage: grains.alphas[0].coverage? }),
        SurfaceKind::Mirror | SurfaceKind::VGroove { .. } | SurfaceKind::File(_) => None,
    }
}

/// \[masking\]\[colour\]\[bin\], 1/sr.
type Means = Vec<Vec<Vec<f64>>>;

/// One model's means over the bins of one incidence.
pub struct IncidenceMeans {
    /// \[masking\]\[colour\]\[bin\], 1/sr.
    pub values: Means,
}

impl Model {
    /// The models of a campaign; `None` where theory has nothing to say: of a measured map, of what goes through grooves or
    /// grains, which are seen from inside, and of matt and layered ones.
    // Tested by `what_goes_through_grooves_and_grains_is_not_predicted` (tests/it/validate/transmittance.rs).
    pub fn of(campaign: &Campaign) -> Option<Self> {
        let kind = &campaign.surface.kind;
        // Both have tables of their own: no other material beside them.
        let interface = match campaign.optics {
            Optics::Layered { eta, .. } => Some(Interface::new(eta)),
            _ => None,
        };
        let matt = interface.is_some() || matches!(campaign.optics, Optics::Diffuse { .. });
        let special = matches!(kind, SurfaceKind::VGroove { .. } | SurfaceKind::Grains(_));
        if special && (matt || grid_of(campaign).looks_below()) {
            return None;
        }
        let rotation = campaign.surface.rotation_deg.to_radians();
        let lobes = |name, masking, slope| Some(Model::Lobes { name, masking, slope, rotation });
        match kind {
            SurfaceKind::Mirror if matt => Some(interface.map_or(Model::Lambert, Model::Flat)),
            SurfaceKind::Mirror => lobes("mirror", "none", None),
            SurfaceKind::VGroove { slope } => lobes("torrance_sparrow", "v_cavity", Some(*slope)),
            kind => {
                let (ndf, alpha) = (ndf_of(kind)?, campaign.alphas()[0]?);
                let surface = Microfacet { ndf, alpha_x: alpha.x, alpha_y: alpha.y, rotation };
                let mut maskings =
                    if campaign.trace.visibility { &Masking::ALL[1..] } else { &Masking::ALL[..1] }.to_vec();
                if matt {
                    let bare_gaussian = ndf == Ndf::Beckmann && surface.is_isotropic() && interface.is_none();
                    let formulas = if bare_gaussian { DiffuseModel::ALL.to_vec() } else { vec![] };
                    return Some(Model::Diffuse { surface, maskings, formulas, interface });
                }
                let grains = matches!(kind, SurfaceKind::Grains(_));
                if grains && campaign.trace.visibility {
                    maskings.splice(0..0, [Masking::Grains, Masking::GrainsProduct]);
                }
                // Among the slopes of heights is the plane's as well.
                let mirror_base = grains && !kind.has_absorbing_base();
                Some(Model::Microfacet { surface, maskings, mirror_base })
            }
        }
    }

    /// The model's name in the summary.
    pub fn name(&self) -> String {
        match self {
            Model::Microfacet { surface, .. } => surface.ndf.name().into(),
            Model::Diffuse { surface, interface: None, .. } => format!("{DIFFUSE}{}", surface.ndf.name()),
            Model::Diffuse { surface, .. } => format!("{LAYERED}{}", surface.ndf.name()),
            Model::Lambert => "lambert".into(),
            Model::Flat(_) => "layered".into(),
            Model::Lobes { name, .. } => (*name).into(),
        }
    }

    /// Names of the maskings, in the order of `IncidenceMeans::values`.
    pub fn maskings(&self) -> Vec<&'static str> {
        match self {
            Model::Microfacet { maskings, .. } => maskings.iter().map(|masking| masking.name()).collect(),
            Model::Diffuse { maskings, formulas, .. } => {
                let further = formulas.iter().map(|formula| formula.name());
                maskings.iter().map(|masking| masking.name()).chain(further).collect()
            }
            Model::Lambert | Model::Flat(_) => vec![Masking::None.name()],
            Model::Lobes { masking, .. } => vec![masking],
        }
    }

    /// The place of the masking of this name, 0 where there is none.
    pub fn masking_index(&self, wanted: Option<&str>) -> usize {
        self.maskings().iter().position(|name| Some(*name) == wanted).unwrap_or(0)
    }

    /// What Smith's model says of the light: its masking G1, the same for every facet that is turned to it, and the
    /// slope along its azimuth from which on facets are turned away, units of alpha (infinite along the normal).
    ///
    /// With s = hypot(alpha_x w.x, alpha_y w.y): w.m >= 0 where the slope is at most w.z/s. `None` for other models, for
    /// a surface without shadows, and (`averaged`) where an anisotropic one is averaged over the azimuth. `wi`: unit
    /// vector, stage's frame.
    // Tested by `smith_masks_all_facets_alike_up_to_a_slope`.
    pub fn smith(&self, wi: DVec3, averaged: bool) -> Option<[f64; 2]> {
        let (Model::Microfacet { surface, maskings, .. } | Model::Diffuse { surface, maskings, .. }) = self
        else {
            return None;
        };
        let smith = !maskings.contains(&Masking::None) && !matches!(surface.ndf, Ndf::Grains { .. });
        if (averaged && !surface.is_isotropic()) || !smith {
            return None;
        }
        let w = surface.to_sample(wi);
        let along = (surface.alpha_x * w.x).hypot(surface.alpha_y * w.y);
        Some([surface.side(w).g1(), w.z / along])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere;

    #[test]
    fn smith_masks_all_facets_alike_up_to_a_slope() {
        let wi = sphere::direction_deg(60.0, 90.0);
        let surface = Microfacet { ndf: Ndf::Ggx, alpha_x: 0.1, alpha_y: 0.5, rotation: 0.0 };
        let model = Model::Microfacet { surface, maskings: vec![Masking::Separable], mirror_base: false };
        // GGX along y: G1 = 2/(1 + sqrt(1 + 0.5^2 tan^2 60)), facets turned away from cot 60/0.5 on; a few ulp.
        let [g1, steepest] = model.smith(wi, false).expect("Smith's");
        assert!((g1 - 2.0 / (1.0 + 1.75f64.sqrt())).abs() < 1e-14, "{g1}");
        assert!((steepest - 2.0 / 3f64.sqrt()).abs() < 1e-14, "{steepest}");
        assert!(model.smith(wi, true).is_none());
    }
}
