//! `gonio fit`: analytic models fitted to a stored table, best first.

use std::path::PathBuf;

use clap::Args;

use super::output::{Output, columns, or_na, to_json};
use super::table_file;
use crate::error::{Error, Result};
use crate::fit::{self, Data, Fits, Law, NAMES};

/// Fit analytic models to a table by least squares, weighted by its errors
#[derive(Args)]
#[command(
    after_help = "Errors come from leaving out one realisation at a time, and from least squares alone.\n\n\
    Example: gonio fit out/quickstart/quickstart.exr --model ggx"
)]
pub struct Arguments {
    /// The table; <stem>.realisations.exr beside it gives the jackknife's errors
    table: PathBuf,
    /// One model, as ggx or cook_torrance; a wrong name lists them all
    #[arg(long, value_name = "NAME")]
    model: Option<String>,
    /// Print one JSON document: fits
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    if let Some(name) = arguments.model.as_deref().filter(|name| !NAMES.contains(name)) {
        return Err(Error::Usage(format!("--model {name}: one of {}", NAMES.join(", "))));
    }
    let path = &arguments.table;
    let table = table_file::load(path)?;
    let campaign = table_file::campaign_if_any(path, &table)?;
    let parts = table_file::realisations_beside(path, &table)?;
    let data = Data::new(&table, campaign.as_ref(), parts.as_ref());
    if data.value.iter().flatten().all(|&value| value == 0.0) {
        return Err(Error::format(path, "channel `single` is 0 everywhere: nothing can be fitted"));
    }
    let own = campaign.as_ref().map_or(Vec::new(), |c| Law::of_surface(&c.surface.kind, &data));
    let laws = Law::all(&data).into_iter().chain(own);
    let laws: Vec<Law> =
        laws.filter(|law| arguments.model.as_ref().is_none_or(|name| name == law.name())).collect();
    if laws.is_empty() {
        return Err(Error::format(
            path,
            "holds no [surface.student_t], whose gamma the model student_t needs",
        ));
    }
    let fits = fit::fit(&data, &laws);
    let mut out = Output::default();
    if arguments.json {
        out.json(&to_json(&fits)?)?;
    } else {
        out.lines(lines(&fits))?;
    }
    Ok(0)
}

fn lines(fits: &Fits) -> Vec<String> {
    let mut lines = vec![format!("order 1, {} values, best first:", fits.values)];
    let mut rows = Vec::new();
    for fit in &fits.fits {
        let (least, spread) = (&fit.standard_errors_least_squares, fit.standard_errors_jackknife.as_ref());
        for (k, (name, value)) in fit.parameters.0.iter().enumerate() {
            let head = |text: String| if k == 0 { text } else { String::new() };
            let number = |value: Option<f64>| value.map_or("n/a".into(), |value| format!("{value:.6}"));
            rows.push(vec![
                head(fit.model.into()),
                head(fit.masking.unwrap_or("").into()),
                name.clone(),
                number(*value),
                number(spread.and_then(|errors| errors.get(name))),
                number(least.get(name)),
                head(or_na(fit.chi2_per_dof, 2)),
                head(or_na(fit.l1, 4)),
                head(format!("{:.0}", fit.aic)),
            ]);
        }
    }
    let headings = ["model", "masking", "parameter", "value", "jackknife", "lsq", "chi2/dof", "l1", "aic"];
    lines.extend(columns(&headings, &rows));
    lines.push(match fits.realisations {
        0 | 1 => {
            "no realisations: only the errors of least squares, too small where the model is not the truth"
                .into()
        }
        count => format!(
            "jackknife: standard errors from leaving out each of {count} realisations; lsq: least squares"
        ),
    });
    let lost = fits.fits.iter().filter(|fit| !fit.converged).map(|fit| fit.model);
    lines.extend(lost.map(|model| format!("{model}: the iteration did not converge")));
    lines
}
