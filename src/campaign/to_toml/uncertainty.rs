//! `[uncertainty]` back into the TOML it could have been read from.

use crate::campaign::parse::uncertainty::DISTRIBUTIONS;
use crate::campaign::schema::{Distribution, InputQuantity, Uncertainty};

/// The table as resolved: after a campaign's own TOML ([`to_toml`](super::to_toml())) it reads as the same again.
// Tested by `uncertainties_survive_the_way_through_toml` (tests/it/budget/schema.rs).
pub fn uncertainty_to_toml(uncertainty: &Uncertainty) -> String {
    let mut text = "\n[uncertainty]\n".to_string();
    for input in &uncertainty.inputs {
        text.push_str(&format!("{} = {}\n", input.quantity.name(), input_table(input)));
    }
    if !uncertainty.correlations.is_empty() {
        let all = uncertainty.correlations.iter().map(|one| {
            let [a, b] = one.between.map(|quantity| quantity.name());
            format!("[\"{a}\", \"{b}\", {:?}]", one.coefficient)
        });
        text.push_str(&format!("correlations = [{}]\n", all.collect::<Vec<_>>().join(", ")));
    }
    if !uncertainty.at_deg.is_empty() {
        text.push_str(&format!("at = {:?}\n", uncertainty.at_deg));
    }
    if let Some(aperture_deg) = uncertainty.aperture_deg {
        text.push_str(&format!("aperture_deg = {aperture_deg:?}\n"));
    }
    if let Some(samples) = uncertainty.samples {
        text.push_str(&format!("samples = {samples}\n"));
    }
    text.push_str(&format!("trials = {}\n", uncertainty.trials));
    text
}

fn input_table(input: &InputQuantity) -> String {
    let words = DISTRIBUTIONS.iter().find(|(_, known)| *known == input.distribution);
    let name = words.map_or("normal", |(name, _)| name);
    let width =
        if matches!(input.distribution, Distribution::Normal | Distribution::T) { "u" } else { "half_width" };
    let dof = input.dof.map_or(String::new(), |dof| format!(", dof = {dof:?}"));
    let relative = if input.relative { ", relative = true" } else { "" };
    format!("{{ distribution = \"{name}\", {width} = {:?}{dof}{relative} }}", input.scale)
}
