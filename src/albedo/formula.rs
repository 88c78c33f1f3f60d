//! Albedos of order 1 by quadrature of the analytical model.

use glam::DVec3;
use rayon::prelude::*;

use super::table::{AlbedoTable, Axes, Cell, Quantity};
use crate::optics::Fresnel;
use crate::optics::reflectance::Reflectance;
use crate::theory::grains::bare_mirror_flux;
use crate::theory::{Masking, Microfacet, Ndf};
use crate::validate::prediction::quadrature::gauss_kronrod::both_orders;
use crate::validate::{Estimate, albedo, transmittance};

/// A rough surface whose albedos of order 1 are known by formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormulaSurface {
    /// Its facets.
    pub surface: Microfacet,
    /// How they hide each other.
    pub masking: Masking,
    /// Whether a plane between grains reflects as well.
    pub mirror_base: bool,
}

/// Of mirror facets, in the order of [`FormulaSurface::mirror`].
pub const MIRROR: [(&str, &str); 3] = [
    ("E", "albedo with F = 1; E(F0, F90) = F0 E_f0 + F90 E_f90 by Schlick's formula"),
    ("E_f0", "the part of F0: albedo with F = 1 - (1 - c)^5"),
    ("E_f90", "the part of F90: albedo with F = (1 - c)^5"),
];
/// Of clear facets, for light from one side.
pub const CLEAR: [(&str, &str); 3] = [
    ("R", "share that comes back"),
    ("T", "share that goes through"),
    ("rest", "1 - R - T: what later orders have"),
];
/// The sides of a clear surface that light comes from.
pub const SIDES: [&str; 2] = ["outside", "inside"];

impl FormulaSurface {
    /// A rough surface without grains.
    pub fn new(ndf: Ndf, alpha: f64, masking: Masking) -> Self {
        FormulaSurface { surface: Microfacet::isotropic(ndf, alpha), masking, mirror_base: false }
    }

    /// E with F = 1, and its parts of F0 and of F90.
    ///
    /// - `wi`: unit vector, wi.z > 0. Returns shares of the incident flux, [0, 1].
    /// - Numerics: two orders of the cubature agree to 1e-8 (1e-7 with kinked maskings); 1e-10 of 108 values of another
    ///   program.
    /// - Source: the split of Karis 2013, "Real Shading in Unreal Engine 4", for light from every direction.
    // Tested by `albedos_match_another_program` (tests/it/albedo/formula.rs).
    pub fn mirror(&self, wi: DVec3) -> [Estimate; 3] {
        let [mut white, mut f90] = albedo(&self.surface, wi, self.masking, None);
        if let (true, Ndf::Grains { coverage }) = (self.mirror_base, self.surface.ndf) {
            let side = self.surface.side(self.surface.to_sample(wi));
            let bare = bare_mirror_flux(side.canonical(), coverage);
            white.value += bare;
            f90.value += bare * (1.0 - wi.z).powi(5);
        }
        [white, Estimate { value: white.value - f90.value, error: white.error + f90.error }, f90]
    }

    /// R, T and 1 - R - T of clear facets; `eta`: index beyond over index on the light's side, > 0 and not 1.
    ///
    /// - `wi`: unit vector, wi.z > 0. Not for grains.
    /// - Numerics: 1e-7 of 56 values of another program, eta from 1.0001 to 2.4, both sides.
    // Tested by `albedos_of_glass_match_another_program` (tests/it/albedo/formula.rs).
    pub fn clear(&self, wi: DVec3, eta: f64) -> [Estimate; 3] {
        let fresnel = Reflectance::unpolarised(Fresnel::Dielectric { eta });
        let [_, back] = albedo(&self.surface, wi, self.masking, Some(fresnel));
        let through = transmittance(&self.surface, wi, self.masking, eta);
        let rest = Estimate { value: 1.0 - back.value - through.value, error: back.error + through.error };
        [back, through, rest]
    }

    /// Of an isotropic surface: [`MIRROR`], or with `eta` (inside over outside) [`CLEAR`] from each of [`SIDES`].
    pub fn at(&self, mu: f64, eta: Option<f64>) -> Vec<Estimate> {
        let wi = DVec3::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, mu);
        match eta {
            None => self.mirror(wi).to_vec(),
            Some(eta) => [self.clear(wi, eta), self.clear(wi, 1.0 / eta)].concat(),
        }
    }
}

/// What a disagreement of two orders is an error of.
const ERRORS: &str = "by how much two orders of the quadrature disagree: an upper estimate";
const AVERAGE: &str =
    "name_avg: the exact 2 times the integral over mu of value(mu) mu dmu, not of the interpolated table";

/// The table of a law and a masking. `done` is told of finished cells and averages, see [`work`].
pub fn by_formula(ndf: Ndf, masking: Masking, axes: &Axes, done: &(dyn Fn(u64) + Sync)) -> AlbedoTable {
    let of_slab = |eta: Option<f64>, alpha: f64| {
        let surface = FormulaSurface::new(ndf, alpha, masking);
        let at = |mu: f64| surface.at(mu, eta);
        let cells: Vec<Vec<Estimate>> = axes.mu.par_iter().map(|&mu| at(mu)).inspect(|_| done(1)).collect();
        let average = hemisphere_mean(at, eta);
        done(1);
        (cells, average)
    };
    let etas: Vec<Option<f64>> =
        if axes.eta.is_empty() { vec![None] } else { axes.eta.iter().copied().map(Some).collect() };
    let rows: Vec<(Option<f64>, f64)> =
        etas.iter().flat_map(|&eta| axes.alpha.iter().map(move |&alpha| (eta, alpha))).collect();
    let slabs: Vec<_> = rows.par_iter().map(|&(eta, alpha)| of_slab(eta, alpha)).collect();
    let cell = |estimate: &Estimate| Cell { value: estimate.value, error: Some(estimate.error) };
    let quantities = names(!axes.eta.is_empty()).into_iter().enumerate().map(|(k, (name, about))| Quantity {
        name,
        about,
        cells: slabs.iter().flat_map(|(cells, _)| cells.iter().map(|values| cell(&values[k]))).collect(),
        averages: slabs.iter().map(|(_, average)| cell(&average[k])).collect(),
    });
    let mut origin = vec![("law", ndf.name().to_string()), ("masking", masking.name().to_string())];
    if let Ndf::StudentT { gamma } = ndf {
        origin.push(("gamma", gamma.to_string()));
    }
    AlbedoTable {
        title: format!("albedos of order 1 by formula, {}, {}", ndf.name(), masking.name()),
        axes: axes.clone(),
        quantities: quantities.collect(),
        errors: ERRORS,
        average: AVERAGE,
        origin,
    }
}

/// How often [`by_formula`] tells of something finished.
pub fn work(axes: &Axes) -> u64 {
    (axes.slabs() * axes.alpha.len() * (axes.mu.len() + 1)) as u64
}

/// Names and meanings of the quantities.
fn names(clear: bool) -> Vec<(String, String)> {
    if !clear {
        return MIRROR.map(|(name, about)| (name.to_string(), format!("{about}; order 1"))).to_vec();
    }
    let of_side = |side: &&str| {
        let side = *side;
        CLEAR.map(|(name, about)| (format!("{name}_{side}"), format!("{about}; order 1, light from {side}")))
    };
    SIDES.iter().flat_map(of_side).collect()
}

/// Halvings of the range of an average before its error is left as it is.
const MOST_PANELS: usize = 64;
/// What the two orders of averages may disagree by: of mirror facets, and of clear ones, whose values cost ten times as much.
const AVERAGE_ERROR: [f64; 2] = [1e-8, 1e-6];

/// 2 times the integral of values(mu) mu dmu from 0 to 1, with mu = u^2: 4 u^3 takes the grazing end off.
///
/// Adaptive: the panel whose two orders disagree most is halved. Of clear facets panels begin where those that lie flat
/// begin to reflect all light from inside. The values' own errors are added.
// Tested by `averages_are_those_of_a_double_integral` (tests/it/albedo/formula.rs).
fn hemisphere_mean(at: impl Fn(f64) -> Vec<Estimate> + Sync, eta: Option<f64>) -> Vec<Estimate> {
    let panel = |ends: [f64; 2]| {
        let rules = both_orders(ends);
        let nodes: Vec<Vec<Estimate>> = rules.par_iter().map(|(u, _)| at(u * u)).collect();
        let mut sums = vec![[0.0; 3]; nodes[0].len()];
        for ((u, weights), values) in rules.iter().zip(&nodes) {
            for (sum, estimate) in sums.iter_mut().zip(values) {
                let scale = 4.0 * u * u * u;
                sum[0] += weights[0] * scale * estimate.value;
                sum[1] += weights[1] * scale * estimate.value;
                sum[2] += weights[0] * scale * estimate.error;
            }
        }
        (ends, sums)
    };
    let disagreement = |sums: &[[f64; 3]]| sums.iter().map(|sum| (sum[0] - sum[1]).abs()).fold(0.0, f64::max);
    let critical = eta.map(|eta| (1.0 - 1.0 / (eta * eta)).abs().sqrt().sqrt());
    let marks: Vec<f64> = [0.0].into_iter().chain(critical).chain([1.0]).collect();
    let allowed = AVERAGE_ERROR[usize::from(eta.is_some())];
    let mut panels: Vec<_> = marks.windows(2).map(|ends| panel([ends[0], ends[1]])).collect();
    while panels.len() < MOST_PANELS {
        let total: f64 = panels.iter().map(|(_, sums)| disagreement(sums)).sum();
        let ranked = panels.iter().enumerate();
        let worst = ranked.max_by(|a, b| disagreement(&a.1.1).total_cmp(&disagreement(&b.1.1)));
        let Some((worst, _)) = worst.filter(|_| total > allowed) else { break };
        let [a, b] = panels.swap_remove(worst).0;
        let middle = 0.5 * (a + b);
        panels.extend([panel([a, middle]), panel([middle, b])]);
    }
    let quantities = panels[0].1.len();
    let of = |k: usize| {
        let parts = || panels.iter().map(|(_, sums)| sums[k]);
        let error = parts().map(|[high, low, own]| (high - low).abs() + own).sum();
        Estimate { value: parts().map(|[high, ..]| high).sum(), error }
    };
    (0..quantities).map(of).collect()
}
