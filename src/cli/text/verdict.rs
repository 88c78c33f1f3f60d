//! The verdict in words and columns, at most 100 wide.

use super::layout::{columns, wrapped};
use super::numbers::or_na;
use crate::validate::compare::{self, Comparison};
use crate::validate::error_measures::Figures;
use crate::validate::prediction::model::{DIFFUSE, LAYERED};
use crate::validate::verdict::{SCOPES, Verdict};
use crate::validate::{GeometricOptics, words};

/// A verdict: its comparisons, then all laws in words, then each.
pub fn lines(verdict: &Verdict) -> Vec<String> {
    [comparisons(verdict), ruling(verdict)].concat()
}

/// The table against each model, incidence by incidence.
pub fn comparisons(verdict: &Verdict) -> Vec<String> {
    SCOPES.iter().flat_map(|scope| comparison_lines(verdict, scope)).collect()
}

/// All laws in a line and in plain words, then each with its figures.
pub fn ruling(verdict: &Verdict) -> Vec<String> {
    let overall = format!("{}. {}", verdict.verdict, words::in_words(&verdict.judgements));
    let each = verdict.judgements.iter().flat_map(|judgement| {
        wrapped(&format!("  {}: ", judgement.law), &format!("{}: {}", judgement.ruling, judgement.reason))
    });
    let waves = verdict.geometric_optics.iter().filter_map(GeometricOptics::words);
    let waves = waves.flat_map(|text| wrapped("  waves: ", &text));
    wrapped("verdict: ", &overall).into_iter().chain(each).chain(waves).collect()
}

/// Models whose names fit the last column as they are.
const MOST_WITH_NAMES: usize = 5;

/// The name of a model as a heading.
fn short(name: &str) -> String {
    name.replace("_correlated", "").replace("direction", "direct.").replace("oren_nayar", "o-n")
}

/// The table of the comparisons of one kind of light, where there are any.
fn comparison_lines(verdict: &Verdict, scope: &str) -> Vec<String> {
    let all: Vec<&Comparison> = verdict.comparisons.iter().filter(|c| c.scope == scope).collect();
    let [first, ..] = all[..] else { return vec![] };
    let several = all.len() > 1;
    let maskings: Vec<String> = all.iter().map(|c| short(&c.masking)).collect();
    // Many columns leave no room for whole names.
    let named = |masking: String| if all.len() > MOST_WITH_NAMES { short(&masking) } else { masking };
    let mut headings = vec!["theta_i", "phi_i", "noise"];
    headings.extend(maskings.iter().map(String::as_str));
    headings.extend(several.then_some("nearest"));
    let row = |[theta, phi]: [String; 2], figures: Vec<&Figures>, nearest: String| {
        let distances = figures.iter().map(|figures| figures.shown());
        let nearest = several.then_some(nearest);
        [theta, phi, or_na(figures[0].l1_noise, 4)].into_iter().chain(distances).chain(nearest).collect()
    };
    let of_incidence = |incidence: usize| {
        let angles = [first.incidences[incidence].theta_i_deg, first.incidences[incidence].phi_i_deg]
            .map(|angle| angle.to_string());
        row(
            angles,
            all.iter().map(|c| &c.incidences[incidence].figures).collect(),
            named(nearest_at(&all, incidence)),
        )
    };
    let mut rows: Vec<Vec<String>> = (0..first.incidences.len()).map(of_incidence).collect();
    let of_all = verdict.comparisons.first().is_some_and(|c| c.scope == scope);
    let nearest = verdict.nearest_masking.clone().filter(|_| of_all).unwrap_or_default();
    rows.push(row(["mean".into(), String::new()], all.iter().map(|c| &c.figures).collect(), named(nearest)));
    let (light, formula) = if scope == SCOPES[0] {
        ("order 1", formula(&first.model))
    } else {
        ("light through, order 1,", format!("{}'s BTDF (Walter 2007)", first.model))
    };
    let title = format!("{light} against {formula}, flux-weighted L1 of bin means, noise taken off:");
    [vec![title], columns(&headings, &rows)].concat()
}

/// The nearest masking at an incidence; `alike` where all are below their floors, the two nearest are not distinguished by
/// the paired test at the 5 % level, or all differ by less than a hundredth of the noise.
fn nearest_at(all: &[&Comparison], incidence: usize) -> String {
    let models: Vec<(&Figures, &[f64])> = all
        .iter()
        .map(|c| (&c.incidences[incidence].figures, &c.incidences[incidence].by_part[..]))
        .collect();
    let l1 = models.iter().filter_map(|(figures, _)| figures.l1);
    let [low, high] = l1.fold([f64::INFINITY, 0.0f64], |[low, high], l1| [low.min(l1), high.max(l1)]);
    if high - low <= 0.01 * models[0].0.l1_noise.unwrap_or(0.0) {
        return "alike".into();
    }
    match compare::nearest(&models).filter(|nearest| nearest.p.is_none_or(|p| p < 0.05)) {
        Some(nearest) => all[nearest.index].masking.clone(),
        None => "alike".into(),
    }
}

/// The model as a formula where it has one for every pair of directions.
fn formula(model: &str) -> String {
    match model {
        "mirror" | "torrance_sparrow" | "lambert" | "layered" => format!("the {model} model"),
        matt if matt.starts_with(DIFFUSE) => {
            format!("{matt} facets, the integral of D G2 <l.m><v.m>/(pi |n.l||n.v|)")
        }
        layered if layered.starts_with(LAYERED) => {
            format!("{layered} facets, D F G2/(4 |n.l||n.v|) and the integral over those of their bases")
        }
        ndf => format!("{ndf} D F G2/(4 |n.l||n.v|)"),
    }
}
