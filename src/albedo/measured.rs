//! Albedos by measurement: the campaign's surface under light from every mu of the table, followed to its last order.

use rayon::prelude::*;

use super::formula::{FormulaSurface, SIDES};
use super::quantities::{OfIncidences, clear, mirror};
use super::setup::Setup;
use super::table::{AlbedoTable, Axes, Cell, Quantity};
use super::verdict::{Certificate, Pair};
use crate::campaign::{self, Campaign, LightArm, LightSide};
use crate::error::{Error, Result};
use crate::instrument::grid_of;
use crate::measure::accumulate::lost_light::with_bound;
use crate::measure::{self, IncidenceResult, Measured, Patches, Plan};
use crate::stats;
use crate::validate::prediction::model::Model;
use crate::validate::{Estimate, expect};

const ERRORS: &str = "standard error of the mean over realisations; -1 (n/a): a single realisation";
const AVERAGE: &str = "name_avg: 2 times the integral over mu of value(mu) mu dmu of the table as lookups interpolate it, \
    errors from the averages of each realisation";

/// Measures all cells. `done` is told of surface samples.
///
/// Errors: as [`measure::measure`]; `Refused` where light reaches no facet.
pub fn measure(
    setup: &Setup,
    plan: &Plan,
    patches: &Patches,
    done: &(dyn Fn(u64) + Sync),
) -> Result<(AlbedoTable, Certificate)> {
    let (results, _) = measure::measure(&setup.campaign, plan, patches, &|samples| done(samples))?;
    let table = Tabulated { setup, results: &results };
    table.check_light()?;
    let orders = setup.campaign.trace.bounces as usize;
    let measured = if setup.sides.is_empty() { mirror(orders) } else { clear(&setup.sides, orders) };
    let mut quantities: Vec<Quantity> =
        measured.into_iter().map(|(name, about, of)| table.quantity(name, about, &of)).collect();
    let formulas = table.formulas();
    let pairs: Vec<Pair> = formulas.iter().map(|(name, formula)| table.pair(name, formula)).collect();
    quantities.extend(formulas.into_iter().map(|(_, formula)| formula));
    let realisations = setup.campaign.surface.realisations as usize;
    let certificate = Certificate::of(&quantities, &pairs, &table.closures(), &setup.axes, realisations);
    let base = &setup.base;
    let origin = vec![
        ("campaign", campaign::to_toml(base)),
        ("replaced", "light, sensor, roughness and material are those of the axes".into()),
        ("seed", base.seed.to_string()),
        ("patch_digest", results[0].table.patch_digest.clone()),
        ("verdict", certificate.lines().join("\n")),
    ];
    let table = AlbedoTable {
        title: format!("albedos of {}, [surface.{}], measured", base.name, base.surface.kind.name()),
        axes: setup.axes.clone(),
        quantities,
        errors: ERRORS,
        average: AVERAGE,
        origin,
    };
    Ok((table, certificate))
}

/// What was measured, by cells.
struct Tabulated<'a> {
    setup: &'a Setup,
    /// \[alpha\]\[eta\]\[side, or F0 = 1 and F0 = 0\].
    results: &'a [Measured],
}

impl Tabulated<'_> {
    /// Tables of one cell's eta and alpha.
    fn materials(&self) -> usize {
        self.setup.sides.len().max(1) + usize::from(self.setup.sides.is_empty())
    }

    fn tables(&self, slab: usize, alpha: usize) -> &[Measured] {
        let first = (alpha * self.setup.axes.slabs() + slab) * self.materials();
        &self.results[first..first + self.materials()]
    }

    /// The incidence of a cell in each material; incidences are in the order of theta, cells in that of mu.
    fn incidences(&self, slab: usize, alpha: usize, mu: usize) -> Vec<&IncidenceResult> {
        let incidence = self.setup.axes.mu.len() - 1 - mu;
        self.tables(slab, alpha).iter().map(|measured| &measured.incidences[incidence]).collect()
    }

    /// (slab, alpha) in the order of averages.
    fn rows(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (slabs, alphas) = (self.setup.axes.slabs(), self.setup.axes.alpha.len());
        (0..slabs).flat_map(move |slab| (0..alphas).map(move |alpha| (slab, alpha)))
    }

    fn check_light(&self) -> Result<()> {
        let dark =
            self.results.iter().any(|measured| measured.incidences.iter().any(IncidenceResult::is_dark));
        if dark {
            return Err(Error::Refused(format!(
                "{}: light of the smallest mu reaches no facet; --mu without it, or more samples",
                self.setup.base.name
            )));
        }
        Ok(())
    }

    fn quantity(&self, name: String, about: String, of: &OfIncidences) -> Quantity {
        let weights = self.setup.axes.mu_weights();
        let (mut cells, mut averages) = (Vec::new(), Vec::new());
        for (slab, alpha) in self.rows() {
            let mut average = vec![0.0; self.setup.campaign.surface.realisations as usize];
            let mut lost = 0.0;
            for (mu, weight) in weights.iter().enumerate() {
                let incidences = self.incidences(slab, alpha, mu);
                let values = of(&incidences);
                // What an open map loses over its edge may be missing at any order.
                let bound = incidences.iter().map(|incidence| incidence.lost_light[1]).fold(0.0, f64::max);
                average.iter_mut().zip(&values).for_each(|(sum, value)| *sum += weight * value);
                lost += weight * bound;
                cells.push(mean_of(&values, bound));
            }
            averages.push(mean_of(&average, lost));
        }
        Quantity { name, about, cells, averages }
    }

    /// All light of every cell and material, by realisation; none where the law of energy does not hold by itself.
    fn closures(&self) -> Vec<Vec<f64>> {
        let surface = &self.setup.campaign.surface.kind;
        if surface.is_open_map() || !self.setup.campaign.trace.visibility {
            return vec![];
        }
        let mus = self.setup.axes.mu.len();
        let of_row = |(slab, alpha)| {
            (0..mus)
                .flat_map(move |mu| self.incidences(slab, alpha, mu))
                .map(|incidence| incidence.closure.clone())
        };
        self.rows().flat_map(of_row).collect()
    }

    /// The formula next to what was measured, where the surface has one: (measured quantity, formula).
    fn formulas(&self) -> Vec<(String, Quantity)> {
        let surfaces = self.rows().map(|(slab, alpha)| Some((slab, self.formula(slab, alpha)?)));
        let Some(surfaces) = surfaces.collect::<Option<Vec<_>>>() else { return vec![] };
        let Axes { mu, eta, .. } = &self.setup.axes;
        let of_row = |&(slab, surface): &(usize, FormulaSurface)| -> Vec<Vec<Estimate>> {
            mu.par_iter().map(|&mu| surface.at(mu, eta.get(slab).copied())).collect()
        };
        let rows: Vec<Vec<Vec<Estimate>>> = surfaces.iter().map(of_row).collect();
        let weights = self.setup.axes.mu_weights();
        let of_name = |(name, place): (String, usize)| {
            let cell = |value: f64, error: f64| Cell { value, error: Some(error) };
            let cells = rows.iter().flatten().map(|all| cell(all[place].value, all[place].error)).collect();
            let mean = |row: &Vec<Vec<Estimate>>| {
                let of = |pick: fn(&Estimate) -> f64| {
                    row.iter().zip(&weights).map(|(all, weight)| weight * pick(&all[place])).sum()
                };
                cell(of(|estimate| estimate.value), of(|estimate| estimate.error))
            };
            let averages = rows.iter().map(mean).collect();
            let about = format!("the model's {name}; its error is the quadrature's");
            let formula = Quantity { name: format!("{name}_formula"), about, cells, averages };
            (name, formula)
        };
        self.judged().into_iter().map(of_name).collect()
    }

    /// Quantities that have a formula, and their places in [`FormulaSurface::at`].
    fn judged(&self) -> Vec<(String, usize)> {
        if self.setup.sides.is_empty() {
            return vec![("E_order1".into(), 0), ("E_f90_order1".into(), 2)];
        }
        let sides = self.setup.sides.iter().map(|&side| usize::from(side == LightSide::Back));
        let of_side = |side: usize| {
            [("R", 0), ("T", 1)]
                .map(|(name, part)| (format!("{name}_{}_order1", SIDES[side]), 3 * side + part))
        };
        sides.flat_map(of_side).collect()
    }

    /// The isotropic model of a row, if it has one.
    fn formula(&self, slab: usize, alpha: usize) -> Option<FormulaSurface> {
        let campaign = &self.tables(slab, alpha)[0].campaign;
        match Model::of(campaign)? {
            model @ Model::Microfacet { .. } => {
                let place = model.masking_index(Some(expect::masking(campaign)));
                let Model::Microfacet { surface, maskings, mirror_base } = model else { return None };
                surface.is_isotropic().then_some(FormulaSurface {
                    surface,
                    masking: maskings[place],
                    mirror_base,
                })
            }
            _ => None,
        }
    }

    /// A measured quantity beside its formula, with what the surface is known to keep between the two.
    fn pair(&self, name: &str, formula: &Quantity) -> Pair {
        let through = name.starts_with('T');
        let mus = &self.setup.axes.mu;
        let of_row = |(slab, alpha)| {
            let campaign = &self.tables(slab, alpha)[0].campaign;
            let at = |mu: usize| {
                let theta = self.setup.campaign.light.theta_i_deg[mus.len() - 1 - mu];
                let light = LightArm { theta_i_deg: vec![theta], ..campaign.light.clone() };
                let one = Campaign { light, ..campaign.clone() };
                let bar = if through { expect::bar_through(&one) } else { expect::bar(&one, &grid_of(&one)) };
                bar.map(|bar| bar.l1_model)
            };
            (0..mus.len()).map(at).collect::<Vec<_>>()
        };
        Pair {
            measured: name.into(),
            formula: formula.name.clone(),
            allowed: self.rows().flat_map(of_row).collect(),
        }
    }
}

fn mean_of(values: &[f64], bound: f64) -> Cell {
    let (value, se) = stats::mean_and_se(values.iter().copied());
    Cell { value, error: se.map(|se| with_bound(se, bound)) }
}
