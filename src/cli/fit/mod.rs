//! `gonio fit`: analytic models fitted to a stored table, or laws to the slopes of a map, best first.

mod surface;

use std::path::PathBuf;

use clap::Args;

use super::streams::folder;
use super::table_file;
use super::text::layout::{columns, wrapped};
use super::text::numbers::or_na;
use super::text::output::{Output, to_json};
use super::text::progress::Stage;
use crate::campaign::Optics;
use crate::error::{Error, Result};
use crate::fit::{self, Fit, FitData, FitLaw, Fits, NAMES};
use crate::stats;

/// L1 from which on the best model is called no good one.
const POOR: f64 = 0.25;

/// What the name of a masking leaves open.
const STRETCHED: &str = "direction_correlated: lambda takes the azimuth between the stretched directions \
                         (alpha_x x, alpha_y y), not between the arms";

/// Fit analytic models to a table, each bin weighted by its size over the model
#[derive(Args)]
#[command(
    after_help = "Errors come from leaving out one realisation at a time. Amplitudes are held at 0 or above,\n\
    F0 in 0 .. 1, slopes in 0.0001 .. 10; a parameter on its bound is named and has no error.\n\
    Of dielectric facets eta is fitted with the roughness, one index for all colours, to light\n\
    that comes back and light that has gone through together. student_t fits gamma too.\n\
    Gaps of an imported table (error -2) are left out. direction_correlated takes the\n\
    azimuth between the stretched directions (alpha_x x, alpha_y y).\n\n\
    Example: gonio fit out/quickstart/quickstart.exr --model ggx"
)]
pub struct Arguments {
    /// The table; <stem>.realisations.exr next to it gives the jackknife's errors
    table: PathBuf,
    /// TABLE is the campaign of a map: fit the law of its slopes, and measure both
    #[arg(long, conflicts_with = "model")]
    surface: bool,
    /// With --surface: folder of both tables and <name>.law.html [default: out/<name>]
    #[arg(short, long, value_name = "DIR", value_parser = folder(), requires = "surface")]
    output: Option<PathBuf>,
    /// With --surface: replace results that are there
    #[arg(long, requires = "surface")]
    force: bool,
    /// One model, as ggx or cook_torrance; a wrong name lists them all
    #[arg(long, value_name = "NAME")]
    model: Option<String>,
    /// Print one JSON document: fits
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments, threads: usize) -> Result<u8> {
    if arguments.surface {
        return surface::run(arguments, threads);
    }
    if let Some(name) = arguments.model.as_deref().filter(|name| !NAMES.contains(name)) {
        return Err(Error::Usage(format!("--model {name}: one of {}", NAMES.join(", "))));
    }
    let path = &arguments.table;
    let table = table_file::load(path)?;
    let campaign = table_file::campaign_if_any(path, &table)?;
    if campaign.as_ref().is_some_and(|campaign| matches!(campaign.optics, Optics::Layered { .. })) {
        let why = "optics.facet = \"layered\": no model that is fitted has a base under an interface; gonio validate compares";
        return Err(Error::Usage(format!("{}: {why}", path.display())));
    }
    let parts = table_file::realisations_beside(path, &table)?;
    let data = FitData::new(&table, campaign.as_ref(), parts.as_ref());
    if data.is_dark() {
        return Err(Error::format(path, "channel `single` is 0 everywhere: nothing can be fitted"));
    }
    let mut laws = fit::models(&data, campaign.as_ref());
    if let Some(name) = &arguments.model {
        laws.retain(|law| law.name() == name);
        if laws.is_empty() && name == "student_t" {
            laws = FitLaw::student_t(&data);
        }
        if laws.is_empty() {
            let why =
                format!("--model {name} knows no light that has gone through: beckmann, ggx or student_t");
            return Err(Error::Usage(format!("{}: {why}", path.display())));
        }
    }
    let stage = Stage::begin("fitting");
    let fits = fit::fit(&data, &laws);
    drop(stage);
    let mut out = Output::default();
    if arguments.json {
        out.json(&to_json(&fits)?)?;
    } else {
        out.lines(lines(&fits))?;
    }
    Ok(0)
}

fn lines(fits: &Fits) -> Vec<String> {
    let mut lines = wrapped("", &winner(fits));
    lines.push(format!("order 1, {} values, best first:", fits.values));
    let mut rows = Vec::new();
    for fit in fits.fits.iter().filter(|fit| fit.did_not_fit.is_none()) {
        for (k, (name, value)) in fit.parameters.0.iter().enumerate() {
            let head = |text: String| if k == 0 { text } else { String::new() };
            let bound = fit.on_bound.contains(name);
            let error = if bound { "on bound".into() } else { narrow(half(fit, name)) };
            rows.push(vec![
                head(fit.model.into()),
                head(fit.masking.unwrap_or("").into()),
                name.clone(),
                narrow(*value),
                error,
                head(fit.chi2_per_dof.map_or("n/a".into(), |ratio| short(ratio, 2))),
                head(or_na(fit.l1, 4)),
                head(short(fit.behind, 0)),
            ]);
        }
    }
    let headers = ["model", "masking", "parameter", "value", "+-", "chi2/dof", "l1", "behind"];
    lines.extend(columns(&headers, &rows));
    lines.extend(lost(fits));
    lines.extend(wrapped("+-: ", &kind_of_errors(fits)));
    let values = || fits.fits.iter().map(|fit| fit.fitted_values);
    if let Some((some, all)) = values().min().zip(values().max()).filter(|(some, all)| some < all) {
        let fitted = format!(
            "models far behind were fitted to {some} of {all} values of a colour; their l1 is of all"
        );
        lines.extend(wrapped("", &fitted));
    }
    if fits.fits.iter().any(|fit| fit.anisotropic && fit.masking == Some("direction_correlated")) {
        lines.extend(wrapped("", STRETCHED));
    }
    lines
}

/// What did not fit, reason by reason.
fn lost(fits: &Fits) -> Vec<String> {
    let mut reasons: Vec<(&str, Vec<String>)> = Vec::new();
    for (fit, why) in fits.fits.iter().filter_map(|fit| Some((fit, fit.did_not_fit.as_deref()?))) {
        match reasons.iter_mut().find(|(known, _)| *known == why) {
            Some((_, names)) => names.push(fit.name()),
            None => reasons.push((why, vec![fit.name()])),
        }
    }
    let line = |(why, names): &(&str, Vec<String>)| {
        wrapped("did not fit: ", &format!("{}: {why}", names.join(", ")))
    };
    reasons.iter().flat_map(line).collect()
}

/// A number in nine columns.
fn narrow(value: Option<f64>) -> String {
    or_na(value, if value.is_some_and(|value| value.abs() >= 1000.0) { 1 } else { 5 })
}

/// A number that may be huge in seven columns.
fn short(value: f64, decimals: usize) -> String {
    if value.abs() < 1e4 { format!("{value:.decimals$}") } else { format!("{value:.1e}") }
}

/// The first line: the best model with its parameters, and what the realisations do not distinguish from it.
fn winner(fits: &Fits) -> String {
    let Some(best) = fits.fits.first().filter(|fit| fit.did_not_fit.is_none()) else {
        return "no model fits this table".into();
    };
    let shown = |(name, value): &(String, Option<f64>)| {
        let range = best.intervals_95.as_ref().and_then(|all| all.get(name));
        let range = range.map_or(String::new(), |[low, high]| format!(" (95 %: {low:.5} .. {high:.5})"));
        format!("{name} {}{range}", narrow(*value))
    };
    let parameters: Vec<String> = best.parameters.0.iter().map(shown).collect();
    let alike = fits.fits[1..].iter().filter(|fit| fit.alike == Some(true) && fit.did_not_fit.is_none());
    let alike: Vec<String> = alike.map(Fit::name).collect();
    let alike = match (fits.realisations, alike.is_empty()) {
        (0 | 1, _) => String::new(),
        (_, true) => "; every other model is significantly worse".into(),
        (_, false) => format!("; alike within the realisations' noise: {}", alike.join(", ")),
    };
    // Noise alone makes a large l1 of few rays, but no large chi2.
    let poor = best.l1.is_some_and(|l1| l1 > POOR) && best.chi2_per_dof.is_none_or(|ratio| ratio > 2.0);
    let head = if poor { "no model fits well, the nearest" } else { "best" };
    let colon = if parameters.is_empty() { "" } else { ": " };
    format!("{head}: {}{colon}{}, l1 {}{alike}", best.name(), parameters.join(", "), or_na(best.l1, 4))
}

/// Half the width of the interval of 95 %; one standard error where only that is known.
fn half(fit: &Fit, name: &str) -> Option<f64> {
    match &fit.intervals_95 {
        Some(all) => all.get(name).map(|[low, high]| 0.5 * (high - low)),
        None => fit.standard_errors.get(name),
    }
}

fn kind_of_errors(fits: &Fits) -> String {
    match (fits.realisations, fits.has_errors) {
        (0 | 1, false) => "the table has no errors and no realisations; one standard error as the residuals \
                           scatter, too small where the model is not the truth"
            .into(),
        (0 | 1, true) => {
            "no realisations: one standard error from the bins' errors alone, too small where the \
                          model is not the truth"
                .into()
        }
        (count, _) => format!(
            "half of the 95 % interval, {:.2} (Student's t) times the standard error of a jackknife over {count} \
             realisations; behind: distance from the best model in units of the noise (Takeuchi's criterion)",
            stats::student_limit(0.05, count - 1)
        ),
    }
}
