//! What each law says of a table: passed, failed or not judged, with its figure, its limit and the reason.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::compare::Comparison;
use super::error_measures::Figures;
use super::expect::Bar;
use super::laws::{Energy, Reciprocity};
use super::seen::SeenLight;
use crate::stats;

/// Family level of the test of a table that is exact but for noise.
const LEVEL: f64 = 0.01;

pub(super) const LIGHT: &str = "light";
pub(super) const ENERGY: &str = "energy";
pub(super) const RECIPROCITY: &str = "reciprocity";
/// The model of the light that comes back, and of that which has gone through.
pub(super) const MODEL: &str = "model";
pub(super) const TRANSMISSION: &str = "transmission";

/// What is said of one law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ruling {
    /// The figure keeps to the limit, and the test could have failed.
    Passed,
    /// It does not.
    Failed,
    /// Nothing was tested, or noise hides the limit.
    #[serde(rename = "not judged")]
    NotJudged,
}

impl fmt::Display for Ruling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// One law and what is said of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Judgement {
    /// Its name.
    pub law: Cow<'static, str>,
    /// What is said of it.
    #[serde(rename = "verdict")]
    pub ruling: Ruling,
    /// What was found.
    pub figure: Option<f64>,
    /// What it is tested against.
    pub limit: Option<f64>,
    /// By how much noise may take the figure over the limit.
    pub allowance: Option<f64>,
    /// The figure, the limit and the allowance in words, or why nothing was judged.
    pub reason: String,
}

impl Judgement {
    pub(super) fn not_judged(law: &'static str, reason: impl Into<String>) -> Self {
        let ruling = Ruling::NotJudged;
        Judgement {
            law: law.into(),
            ruling,
            figure: None,
            limit: None,
            allowance: None,
            reason: reason.into(),
        }
    }
}

fn ruled(passes: bool) -> Ruling {
    if passes { Ruling::Passed } else { Ruling::Failed }
}

/// Light arrived, and none of it went where nothing is known of it.
pub(super) fn light(seen: &SeenLight) -> Judgement {
    let (law, count) = (LIGHT, seen.incidences);
    if seen.dark == count {
        let ruling = if seen.measured { Ruling::Failed } else { Ruling::NotJudged };
        let reason = if seen.measured {
            "no light arrived in any bin: too grazing, or heights or pitches in another unit"
        } else {
            "every value is 0"
        };
        return Judgement { ruling, figure: Some(0.0), ..Judgement::not_judged(law, reason) };
    }
    if seen.lost_light > seen.lost_limit {
        let reason = format!(
            "up to {:.4} of the light left the map by its edge, noise is {:.4}; errors cover where it may have gone",
            seen.lost_light, seen.lost_limit
        );
        let (figure, limit) = (Some(seen.lost_light), Some(seen.lost_limit));
        return Judgement { figure, limit, ..Judgement::not_judged(law, reason) };
    }
    if seen.dark > 0 {
        let reason = format!("at {} of {count} incidences no light arrived in any bin", seen.dark);
        return Judgement { figure: Some(seen.dark as f64), ..Judgement::not_judged(law, reason) };
    }
    Judgement {
        ruling: Ruling::Passed,
        ..Judgement::not_judged(law, format!("arrived at all {count} incidences"))
    }
}

/// No incidence reflects more than it gets, but for three standard errors where these are known.
pub(super) fn energy(energy: &Energy) -> Judgement {
    if let Some(why) = &energy.skipped {
        return Judgement::not_judged(ENERGY, why.clone());
    }
    let Some(albedo) = energy.largest_albedo else { return Judgement::not_judged(ENERGY, "no incidences") };
    if albedo == 0.0 {
        return Judgement::not_judged(ENERGY, "no light was seen");
    }
    let error = match energy.largest_albedo_se {
        Some(se) => format!("+- {se:.5}, limit 1 and 3 standard errors"),
        None if energy.counted => "(errors n/a), limit 1 and 3 errors of counting".into(),
        None => "(errors n/a), limit 1".into(),
    };
    let colour = energy.largest_albedo_colour.as_ref().map_or(String::new(), |name| format!(" ({name})"));
    let violations = match energy.violations {
        0 => String::new(),
        count => format!("; above it at {count} incidences and colours"),
    };
    Judgement {
        law: ENERGY.into(),
        ruling: ruled(energy.violations == 0),
        figure: Some(albedo),
        limit: Some(1.0),
        allowance: energy.largest_albedo_se.map(|se| 3.0 * se),
        reason: format!("largest albedo {albedo:.5}{colour} {error}{violations}"),
    }
}

/// f(wi, wo) = f(wo, wi) over the pairs that can be judged.
pub(super) fn reciprocity(found: Option<&Reciprocity>, visibility: bool) -> Judgement {
    let Some(found) = found else {
        let why = if visibility { "no two directions see each other" } else { "visibility is switched off" };
        return Judgement::not_judged(RECIPROCITY, why);
    };
    let pairs = match found.kind.as_str() {
        "exact" => "pairs of equal apertures",
        _ => "pairs of bins, corrected by the model",
    };
    let l1 = found.l1.map_or(String::new(), |l1| format!(", L1 {l1:.4}"));
    let Some((most, limit)) = found.max_t.zip(found.limit) else {
        let why = found.not_judged.as_deref().unwrap_or("fewer than 4 realisations");
        return Judgement::not_judged(RECIPROCITY, format!("{why} ({} {pairs}{l1})", found.pairs));
    };
    Judgement {
        law: RECIPROCITY.into(),
        ruling: ruled(most <= limit),
        figure: Some(most),
        limit: Some(limit),
        allowance: None,
        reason: format!(
            "largest |t| {most:.2} of {} of {} {pairs}{l1}; limit {limit:.2} (1 % for all)",
            found.judged_pairs, found.pairs
        ),
    }
}

/// The distance from the model against what is known of the surface or expected by the campaign.
pub(super) fn model(
    law: &'static str,
    bar: Option<Bar>,
    comparisons: &[&Comparison],
    own_slopes: &str,
) -> Judgement {
    if comparisons.is_empty() {
        return Judgement::not_judged(law, "no model speaks of this surface");
    }
    let Some(bar) = bar else {
        return Judgement::not_judged(
            law,
            "nothing is known of this surface at these angles; [expect] sets a bar",
        );
    };
    let Some(comparison) = comparisons.iter().find(|c| c.masking == bar.masking) else {
        return Judgement::not_judged(law, format!("the model has no masking {}", bar.masking));
    };
    let mut judgement =
        if bar.l1_model == 0.0 { exactness(comparison) } else { distance(&comparison.figures, bar.l1_model) };
    judgement.law = law.into();
    let name = if bar.masking == "none" { String::new() } else { format!(" {}", bar.masking) };
    judgement.reason = format!("{}{name}: {}", comparison.model, judgement.reason);
    if judgement.ruling == Ruling::Failed {
        judgement.reason += own_slopes;
    }
    judgement
}

/// A bar of 0: nothing but noise lies between table and model, so that no bin differs by more than Sidak's limit.
fn exactness(comparison: &Comparison) -> Judgement {
    let judged: usize = comparison.incidences.iter().map(|incidence| incidence.judged).sum();
    let dof = comparison.incidences.first().map_or(0, |incidence| incidence.dof);
    let max_t = comparison.incidences.iter().filter_map(|incidence| incidence.max_t).reduce(f64::max);
    let (Some(most), true) = (max_t, dof > 0) else {
        return Judgement::not_judged(MODEL, "no bin has an error bar");
    };
    let limit = stats::student_limit(stats::sidak(LEVEL, judged), dof);
    Judgement {
        law: MODEL.into(),
        ruling: ruled(most <= limit),
        figure: Some(most),
        limit: Some(limit),
        allowance: None,
        reason: format!("largest |t| {most:.2} of {judged} bins; limit {limit:.2} (1 % for all)"),
    }
}

/// l1_model above its bar with its whole interval fails; below it, with noise no larger than the bar or with the whole
/// interval, passes; else noise hides the bar.
fn distance(figures: &Figures, bar: f64) -> Judgement {
    let Some((found, low, high)) = interval(figures) else {
        return Judgement::not_judged(MODEL, "the noise is not known: more realisations are needed");
    };
    let noise = figures.l1_noise.unwrap_or(f64::INFINITY);
    let ruling = if low > bar {
        Ruling::Failed
    } else if high <= bar || (found <= bar && noise <= bar) {
        Ruling::Passed
    } else {
        Ruling::NotJudged
    };
    let advice = if ruling == Ruling::NotJudged { more_realisations(noise, bar) } else { String::new() };
    Judgement {
        law: MODEL.into(),
        ruling,
        figure: Some(found),
        limit: Some(bar),
        allowance: Some(found - low),
        reason: format!(
            "l1_model {found:.4}, 95 % within [{low:.4}, {high:.4}], noise {noise:.4}; limit {bar:.4}{advice}"
        ),
    }
}

/// What to do about noise, which falls as the root of the number of realisations.
fn more_realisations(noise: f64, bar: f64) -> String {
    let times = (noise / bar).powi(2).ceil();
    match times > 1.0 && times.is_finite() {
        true => format!(": noise hides the limit, {times:.0} times the realisations would do"),
        false => ": noise hides the limit, more realisations would tell".into(),
    }
}

/// The distance from the model and its 95 % interval; without realisations, from the noise.
fn interval(figures: &Figures) -> Option<(f64, f64, f64)> {
    if let (Some(found), Some(low), Some(high)) =
        (figures.l1_model, figures.l1_model_low, figures.l1_model_high)
    {
        return Some((found, low, high));
    }
    // Without realisations nothing is known of the sum of the bins but its noise, were all of them off together.
    let noise = figures.l1_noise?;
    if let Some(found) = figures.l1_model {
        return Some((found, (found - noise).max(0.0), found + noise));
    }
    // Of fewer than four realisations there is only l1, which noise alone makes as large as itself, and its estimate of
    // noise is rough.
    let l1 = figures.l1?;
    Some((l1, (l1 - 3.0 * noise).max(0.0), l1 + noise))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(l1_model: f64, half: Option<f64>, noise: f64) -> Figures {
        Figures {
            l1: Some(l1_model.hypot(noise)),
            l1_noise: Some(noise),
            l1_model: Some(l1_model),
            l1_model_low: half.map(|half| (l1_model - half).max(0.0)),
            l1_model_high: half.map(|half| l1_model + half),
            ..Figures::default()
        }
    }

    #[test]
    fn a_distance_fails_passes_or_is_hidden_by_noise() {
        let ruling = |found, half, noise| distance(&figures(found, half, noise), 0.0035).ruling;
        // A table of alpha 0.3 that is said to be of 0.1.
        assert_eq!(ruling(0.895, Some(0.01), 0.007), Ruling::Failed);
        assert_eq!(ruling(0.895, None, 0.007), Ruling::Failed);
        // Noise is twice the bar, and the interval holds it.
        assert_eq!(ruling(0.004, Some(0.003), 0.007), Ruling::NotJudged);
        assert_eq!(ruling(0.001, Some(0.003), 0.007), Ruling::NotJudged);
        assert_eq!(ruling(0.001, None, 0.007), Ruling::NotJudged);
        // Below the bar, whole or with little noise.
        assert_eq!(ruling(0.001, Some(0.002), 0.007), Ruling::Passed);
        assert_eq!(ruling(0.001, Some(0.003), 0.003), Ruling::Passed);
        // Just above the bar, which the interval holds.
        assert_eq!(ruling(0.004, Some(0.001), 0.003), Ruling::NotJudged);
        // Noise falls as the root of the realisations: four times as many halve it.
        let reason = distance(&figures(0.001, Some(0.003), 0.007), 0.0035).reason;
        assert!(reason.ends_with("4 times the realisations would do"), "{reason}");
        // Three realisations have no l1_model.
        let few = |l1, noise| {
            let figures = Figures { l1: Some(l1), l1_noise: Some(noise), ..Figures::default() };
            distance(&figures, 0.0165).ruling
        };
        assert_eq!(few(0.4746, 0.4325), Ruling::NotJudged);
        assert_eq!(few(0.895, 0.007), Ruling::Failed);
        let unknown = Figures { l1: Some(0.9), ..Figures::default() };
        assert_eq!(distance(&unknown, 0.0035).ruling, Ruling::NotJudged);
    }
}
