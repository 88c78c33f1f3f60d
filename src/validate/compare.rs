//! The table against every masking of a model, incidence by incidence, and the nearest of several models. `error_measures`
//! defines the figures.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::counted_bins::counted_bins;
use super::error_measures::{ColourFigures, Figures, IncidenceData};
use super::model_distance;
use super::parts::Parts;
use super::prediction::Prediction;
use crate::campaign::Campaign;
use crate::instrument::{GridKind, folded_incidences};
use crate::stats;
use crate::table::BrdfTable;

/// A model tested against a table.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Comparison {
    /// Law of the normals, or the surface's own model.
    pub model: String,
    /// The masking's name.
    pub masking: String,
    /// What is compared: `single`, order 1 of light that comes back; `single_through`, of light that has gone through.
    pub scope: String,
    /// Means over incidences and colours of the figures below.
    #[serde(flatten)]
    pub figures: Figures,
    /// Each incidence.
    #[serde(rename = "stops")]
    pub incidences: Vec<IncidenceComparison>,
    /// Mean over incidences and colours of what each realisation adds to `l1_model`; one entry where they are not known.
    #[serde(skip)]
    pub by_part: Vec<f64>,
}

/// One incidence of a comparison.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct IncidenceComparison {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Azimuth of the light.
    pub phi_i_deg: f64,
    /// The model's flux into all bins, mean of the colours; null for an arm.
    pub albedo_model: Option<f64>,
    /// The error measures.
    #[serde(flatten)]
    pub figures: Figures,
    /// Largest |f-m|/se.
    pub max_t: Option<f64>,
    /// Share of the bins whose 95 % interval misses the model.
    pub share_outside_95: Option<f64>,
    /// Degrees of freedom of t: realisations - 1.
    pub dof: usize,
    /// Bins and colours that t was computed for.
    #[serde(skip)]
    pub judged: usize,
    /// As in [`Comparison`], the mean of the colours.
    #[serde(skip)]
    pub by_part: Vec<f64>,
}

impl Comparison {
    /// Of these incidences.
    pub fn new(model: &str, masking: &str, incidences: Vec<IncidenceComparison>) -> Self {
        let (figures, by_part) =
            Figures::mean(incidences.iter().map(|incidence| (&incidence.figures, &incidence.by_part[..])));
        Comparison {
            model: model.into(),
            masking: masking.into(),
            scope: "single".into(),
            figures,
            incidences,
            by_part,
        }
    }
}

/// The number of realisations behind a table: the campaign's (a map's start regions included).
fn realisations_of(campaign: &Campaign) -> usize {
    campaign.surface.realisations as usize
}

/// A table against every masking of a model; realisations and prediction are those of its incidences.
pub fn compare(
    table: &BrdfTable,
    campaign: &Campaign,
    realisations: Option<Parts>,
    Prediction { model, means }: &Prediction,
) -> Vec<Comparison> {
    let names = model.maskings();
    let folded = folded_incidences(campaign, &table.grid);
    let of = |(index, masking): (usize, &&str)| {
        let of_incidence = |incidence: usize| {
            compare_incidence(
                (table, realisations),
                campaign,
                (incidence, folded[incidence]),
                &means[incidence].values[index],
            )
        };
        let incidences = (0..table.grid.incidences()).into_par_iter().map(of_incidence).collect();
        Comparison::new(&model.name(), masking, incidences)
    };
    names.iter().enumerate().map(of).collect()
}

/// One incidence (and whether it is folded) against the model's means by colour.
fn compare_incidence(
    (table, parts): (&BrdfTable, Option<Parts>),
    campaign: &Campaign,
    (incidence, folded): (usize, bool),
    model: &[Vec<f64>],
) -> IncidenceComparison {
    let grid = &table.grid;
    let bins = grid.bins();
    let here = incidence * bins..(incidence + 1) * bins;
    let size = grid.sizes(incidence);
    let counted = counted_bins(grid, incidence, folded);
    let realisations = realisations_of(campaign);
    let figures = |(colour, model): (usize, &Vec<f64>)| {
        let channels = &table.colours[colour];
        IncidenceData {
            value: &channels.single[here.clone()],
            stderr: &channels.stderr_single[here.clone()],
            hits: &table.hits[here.clone()],
            model,
            size: &size,
            counted: &counted,
            realisations,
            parts: parts.map_or(vec![], |parts| parts.single(colour, incidence, bins)),
        }
        .figures()
    };
    let colours: Vec<ColourFigures> = model.iter().enumerate().map(figures).collect();
    let count = colours.len() as f64;
    let bins_judged: usize = colours.iter().map(|c| c.bins).sum();
    let outside: usize = colours.iter().map(|c| c.outside).sum();
    let whole = grid.kind == GridKind::Hemisphere;
    let (theta_i_deg, phi_i_deg) = grid.incidence_deg(incidence);
    let (figures, by_part) = Figures::mean(colours.iter().map(|c| (&c.figures, &c.by_part[..])));
    IncidenceComparison {
        theta_i_deg,
        phi_i_deg,
        albedo_model: whole.then(|| colours.iter().map(|c| c.albedo_model).sum::<f64>() / count),
        figures,
        max_t: colours.iter().filter_map(|c| c.max_t).reduce(f64::max),
        share_outside_95: (bins_judged > 0).then(|| outside as f64 / bins_judged as f64),
        dof: realisations.saturating_sub(1),
        judged: bins_judged,
        by_part,
    }
}

/// The nearest of several models.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Its place among them.
    pub index: usize,
    /// The probability of such a lead over the second where both are as near, by the same realisations: a paired
    /// t-test of what each adds. `None` where they are not known.
    pub p: Option<f64>,
}

/// The model with the smallest distance; `None` where all of several are below their floors, or nothing is known.
// Tested by `models_below_their_floors_have_no_nearest`.
pub fn nearest(models: &[(&Figures, &[f64])]) -> Option<Nearest> {
    let distance = |(k, (figures, _)): (usize, &(&Figures, &[f64]))| Some((figures.distance().1?, k));
    let mut known: Vec<(f64, usize)> = models.iter().enumerate().filter_map(distance).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(_, first) = known.first()?;
    let Some(&(_, second)) = known.get(1) else { return Some(Nearest { index: first, p: None }) };
    if models.iter().all(|(figures, _)| figures.is_below_floor()) {
        return None;
    }
    let lead: Vec<f64> = models[first].1.iter().zip(models[second].1).map(|(a, b)| b - a).collect();
    let (mean, se) = if lead.is_empty() { (0.0, None) } else { model_distance::mean_and_se(&lead) };
    let p = se.filter(|&se| se > 0.0).map(|se| stats::student_p(mean / se, lead.len() - 1));
    Some(Nearest { index: first, p })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_below_their_floors_have_no_nearest() {
        let figures = |by_part: &[f64]| {
            let known = Figures { l1: Some(0.1), l1_noise: Some(0.1), ..Figures::default() };
            known.with_model(by_part)
        };
        let (true_one, alike) = ([0.01, -0.01, 0.02, -0.02], [0.02, -0.02, 0.01, -0.01]);
        let of = |parts: &[&[f64]]| {
            let all: Vec<Figures> = parts.iter().map(|parts| figures(parts)).collect();
            nearest(&all.iter().zip(parts).map(|(figures, parts)| (figures, *parts)).collect::<Vec<_>>())
        };
        assert_eq!(of(&[&true_one, &alike]), None);
        let found = of(&[&[0.11, 0.1, 0.12, 0.09], &true_one]).expect("one is far");
        assert_eq!(found.index, 1);
        // Leads 0.10, 0.11, 0.10, 0.11: mean 0.105, standard error 0.002887 doubled, t = 18.19, p = 0.00036 for 3.
        assert!((found.p.expect("four realisations") - 3.6e-4).abs() < 1e-5, "{found:?}");
    }
}
