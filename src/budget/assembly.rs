//! Puts measured sensitivities and spreads together: terms, components, covariances.

use super::gum::{Combined, Term, combine};
use super::instruments;
use super::measured::Measured;
use super::monte_carlo::{Agreement, Inputs};
use super::report::{Budget, Component, Kind, Place, SCHEMA, ValueBudget};
use super::response::by_quantity;
use crate::campaign::{self, Distribution, InputQuantity, Optics, Quantity, Uncertainty};
use crate::error::{Error, Result};
use crate::stats;

/// A value by the places of its pair and colour, with the terms of its uncertainty.
struct Terms {
    pair: usize,
    colour: usize,
    value: f64,
    /// The inputs first, in their order; then the spread of realisations; then alternatives.
    terms: Vec<Term>,
    combined: Combined,
}

impl Measured {
    /// The budget of all values.
    pub(super) fn budget(
        &mut self,
        uncertainty: &Uncertainty,
        factor: &[Vec<f64>],
        stage: &dyn Fn(&str),
    ) -> Result<Budget> {
        let campaign = self.rig.campaign().clone();
        let colours = colour_names(&campaign.optics);
        let (mut all, mut dark) = (Vec::new(), Vec::new());
        for (pair, responses) in self.responses.iter().enumerate() {
            for (colour, response) in responses.iter().enumerate() {
                let place = Place { position: self.positions[pair], colour: colours[colour].clone() };
                match response.value > 0.0 {
                    true => all.push(self.terms(uncertainty, factor, pair, colour)?),
                    false => dark.push(place),
                }
            }
        }
        let mut values = Vec::new();
        for one in &all {
            values.push(self.value_budget(uncertainty, factor, one, &colours[one.colour], campaign.seed));
        }
        stage("measuring instruments with errors");
        let mut combined: Vec<Vec<f64>> =
            self.responses.iter().map(|colours| vec![0.0; colours.len()]).collect();
        all.iter().for_each(|one| combined[one.pair][one.colour] = one.combined.standard_uncertainty);
        let inputs = Inputs {
            inputs: &uncertainty.inputs,
            factor,
            type_a: None,
            half_widths: &[],
            seed: campaign.seed,
        };
        let check = instruments::check(
            &mut self.rig,
            (uncertainty, &inputs),
            &self.responses,
            &self.middle,
            &combined,
        )?;
        Ok(Budget {
            schema: SCHEMA,
            name: campaign.name.clone(),
            campaign: campaign::to_toml(&campaign) + &campaign::uncertainty_to_toml(uncertainty),
            realisations: self.nominal[0].brdf[0].len(),
            samples: self.samples,
            covariance: self.covariance(&all, uncertainty),
            values,
            check,
            left_out: self.left_out.clone(),
            dark,
            notes: self.notes.clone(),
        })
    }

    fn terms(
        &self,
        uncertainty: &Uncertainty,
        factor: &[Vec<f64>],
        pair: usize,
        colour: usize,
    ) -> Result<Terms> {
        let response = &self.responses[pair][colour];
        let of_input = |input: &InputQuantity| {
            let sensitivity = response.sensitivity(input).map(|found| found.value);
            sensitivity.map(|sensitivity| Term {
                sensitivity,
                uncertainty: input.standard_uncertainty(),
                dof: input.dof,
            })
        };
        let inputs: Option<Vec<Term>> = uncertainty.inputs.iter().map(of_input).collect();
        let mut terms = inputs.ok_or_else(|| Error::Internal("an input was not measured".into()))?;
        let (se, dof) = self.type_a(pair, colour);
        terms.push(Term { sensitivity: 1.0, uncertainty: se, dof: Some(dof) });
        let known =
            |half_width: f64| Term { sensitivity: 1.0, uncertainty: half_width / 3f64.sqrt(), dof: None };
        terms.extend(self.half_widths(pair, colour).into_iter().map(known));
        let combined = combine(&terms, factor);
        Ok(Terms { pair, colour, value: response.value, terms, combined })
    }

    fn value_budget(
        &self,
        uncertainty: &Uncertainty,
        factor: &[Vec<f64>],
        one: &Terms,
        colour: &str,
        seed: u64,
    ) -> ValueBudget {
        let (response, half_widths) =
            (&self.responses[one.pair][one.colour], self.half_widths(one.pair, one.colour));
        let type_a = Some(self.type_a(one.pair, one.colour));
        let inputs = Inputs { inputs: &uncertainty.inputs, factor, type_a, half_widths: &half_widths, seed };
        let relative = |quantity: Quantity| {
            uncertainty.inputs.iter().any(|input| input.quantity == quantity && input.relative)
        };
        let monte_carlo = inputs.propagate(uncertainty.trials, |errors| {
            response.value_at(&by_quantity(&uncertainty.inputs, errors), relative)
        });
        ValueBudget {
            place: Place { position: response.position, colour: colour.into() },
            value: one.value,
            hits: self.nominal[one.pair].hits,
            gum: one.combined,
            monte_carlo,
            agreement: Agreement::of(one.value, &one.combined, &monte_carlo),
            components: self.components(uncertainty, one),
        }
    }

    fn components(&self, uncertainty: &Uncertainty, one: &Terms) -> Vec<Component> {
        let response = &self.responses[one.pair][one.colour];
        let variance = one.combined.standard_uncertainty.powi(2);
        let count = uncertainty.inputs.len();
        let input = |(input, term): (&InputQuantity, &Term)| {
            let found = response.sensitivity(input);
            let measured = found.filter(|found| found.step.is_some());
            Component {
                distribution: distribution_name(input.distribution),
                sensitivity_error: measured.map(|found| found.error),
                step: measured.and_then(|found| found.step),
                ..component(input.quantity.name(), Kind::Input, term, variance)
            }
        };
        let mut all: Vec<Component> = uncertainty.inputs.iter().zip(&one.terms).map(input).collect();
        all.extend(self.of_realisations(one, &one.terms[count], variance));
        for (alternative, term) in self.alternatives.iter().zip(&one.terms[count + 1..]) {
            let error = alternative.half_widths[one.pair][one.colour].error;
            all.push(Component {
                distribution: "rectangular",
                contribution_error: error.map(|error| error / 3f64.sqrt()),
                ..component(alternative.name, Kind::Alternative, term, variance)
            });
        }
        if !uncertainty.correlations.is_empty() {
            let alone: f64 = all.iter().map(|component| component.share).sum();
            all.push(Component {
                name: "correlations".into(),
                kind: Kind::Correlation,
                distribution: "",
                standard_uncertainty: None,
                dof: None,
                sensitivity: None,
                sensitivity_error: None,
                step: None,
                contribution: None,
                contribution_error: None,
                share: 1.0 - alone,
            });
        }
        all.sort_by(|a, b| b.share.abs().total_cmp(&a.share.abs()));
        all
    }

    /// The spread of realisations in two parts: the noise of counted paths, value/sqrt(hits), and what patches add. Together
    /// they are the standard error; where counting alone would give more than that (paths taken in steps are more even than
    /// random ones) all of it is said to be rays.
    fn of_realisations(&self, one: &Terms, term: &Term, variance: f64) -> [Component; 2] {
        let hits = self.nominal[one.pair].hits as f64;
        let rays = (one.value / hits.sqrt()).min(term.uncertainty);
        let patches = (term.uncertainty * term.uncertainty - rays * rays).sqrt();
        [("patches", patches), ("rays", rays)].map(|(name, uncertainty)| Component {
            distribution: "t",
            ..component(name, Kind::TypeA, &Term { uncertainty, ..*term }, variance)
        })
    }

    /// Sums over shared inputs and realisations; on the diagonal all of u_c^2.
    fn covariance(&self, all: &[Terms], uncertainty: &Uncertainty) -> Vec<Vec<f64>> {
        let (matrix, count) = (uncertainty.correlation_matrix(), uncertainty.inputs.len());
        let parts = |one: &Terms| {
            one.terms[..count].iter().map(|term| term.sensitivity * term.uncertainty).collect::<Vec<f64>>()
        };
        let parts: Vec<Vec<f64>> = all.iter().map(parts).collect();
        let shared = |a: usize, b: usize| {
            let row = |j: usize| matrix[j].iter().zip(&parts[b]).map(|(r, part)| r * part).sum::<f64>();
            let inputs: f64 = (0..count).map(|j| parts[a][j] * row(j)).sum();
            let values = |one: &Terms| &self.nominal[one.pair].brdf[one.colour];
            inputs + covariance_of_means(values(&all[a]), values(&all[b]))
        };
        let entry = |a: usize, b: usize| match a == b {
            true => all[a].combined.standard_uncertainty.powi(2),
            false => shared(a, b),
        };
        (0..all.len()).map(|a| (0..all.len()).map(|b| entry(a, b)).collect()).collect()
    }
}

fn component(name: &str, kind: Kind, term: &Term, variance: f64) -> Component {
    let contribution = (term.sensitivity * term.uncertainty).abs();
    Component {
        name: name.into(),
        kind,
        distribution: "",
        standard_uncertainty: Some(term.uncertainty),
        dof: term.dof,
        sensitivity: Some(term.sensitivity),
        sensitivity_error: None,
        step: None,
        contribution: Some(contribution),
        contribution_error: None,
        share: if variance > 0.0 { contribution * contribution / variance } else { 0.0 },
    }
}

/// Covariance of the means of paired values.
fn covariance_of_means(a: &[f64], b: &[f64]) -> f64 {
    let (mean_a, mean_b, count) = (stats::mean(a), stats::mean(b), a.len() as f64);
    let products: f64 = a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum();
    products / (count * (count - 1.0))
}

fn distribution_name(distribution: Distribution) -> &'static str {
    match distribution {
        Distribution::Normal => "normal",
        Distribution::Rectangular => "rectangular",
        Distribution::Triangular => "triangular",
        Distribution::Arcsine => "arcsine",
        Distribution::T => "t",
    }
}

/// As tables call them.
fn colour_names(optics: &Optics) -> Vec<String> {
    let nm = optics.wavelengths_nm();
    if !nm.is_empty() {
        return nm.iter().map(|nm| format!("{nm} nm")).collect();
    }
    let names: &[&str] = if optics.colours() == 1 { &["Y"] } else { &["R", "G", "B"] };
    names.iter().map(|name| name.to_string()).collect()
}
