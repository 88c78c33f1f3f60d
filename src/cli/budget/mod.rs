//! `gonio budget`: the uncertainty of measured values, component by component.

mod rows;
mod text;

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use clap::Args;

use super::streams::folder;
use super::text::output::{Output, json_text, to_json, warn};
use super::text::progress::Stage;
use crate::budget::{self, Budget};
use crate::campaign;
use crate::error::Result;
use crate::files::{self, Destination};
use crate::job::paths;
use crate::report::budget_page;

/// Say how uncertain values are and why: a budget by JCGM 100 and, beside it, by Monte Carlo (JCGM 101)
#[derive(Args)]
#[command(
    after_help = "Of every position of [sensor.arm], or of uncertainty.at: value, u, nu_eff, k, U at 95 %, and\n\
    what inputs of [uncertainty], patches, rays, apertures, cells and a map's preparation add to it.\n\
    -o writes <name>.budget.json, .csv and .html.\n\n\
    Example: gonio budget configs/budget.toml -o out/budget"
)]
pub struct Arguments {
    /// The campaign, a TOML file with [uncertainty]
    campaign: PathBuf,
    /// Folder of the files; without it none is written
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    output: Option<PathBuf>,
    /// Replace files that are there
    #[arg(long)]
    force: bool,
    /// Print one JSON document, covariances included: values, covariance, check, left_out
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let path = &arguments.campaign;
    let parsed = campaign::read(path)?;
    parsed.notes.iter().for_each(warn);
    let uncertainty = parsed.required_uncertainty(&path.display().to_string())?;
    let campaign = &parsed.campaign;
    if campaign.stop.seconds.is_some() || campaign.stop.relative_error.is_some() {
        warn(format_args!(
            "{}: stop.samples decides how long a budget measures; seconds and relative_error do not",
            path.display()
        ));
    }
    let places = arguments.output.as_deref().map(|folder| places(folder, &campaign.name));
    if let Some(taken) = places.iter().flatten().find(|place| files::is_there(place) && !arguments.force) {
        return Err(paths::already_exists(taken, "is there already"));
    }
    if let Some(places) = &places {
        paths::spare_inputs(&places.each_ref().map(|place| &**place), path, campaign)?;
    }
    let line = RefCell::new(None);
    let stage = |text: &str| {
        // The one before is cleared first: two at a time would share the terminal's line.
        line.replace(None);
        line.replace(Some(Stage::begin(text)));
    };
    let found = budget::budget(campaign, uncertainty, &stage)?;
    line.replace(None);
    found.notes.iter().for_each(warn);
    let document = to_json(&found)?;
    if let (Some(folder), Some(places)) = (&arguments.output, &places) {
        let _claim = files::create_folder(folder)?;
        write(&found, &json_text(&document)?, places)?;
    }
    let mut out = Output::default();
    if arguments.json {
        out.json(&document)?;
    } else {
        out.lines(text::lines(&found))?;
        if let Some([_, _, page]) = &places {
            out.line(format_args!("page   {}", page.display()))?;
        }
    }
    Ok(0)
}

/// The files: JSON, CSV and page.
fn places(folder: &Path, name: &str) -> [Destination; 3] {
    ["json", "csv", "html"].map(|end| Destination::at(folder.join(format!("{name}.budget.{end}"))))
}

fn write(found: &Budget, json: &str, [json_file, csv, page]: &[Destination; 3]) -> Result<()> {
    files::write_atomically(json_file, format!("{json}\n").as_bytes())?;
    files::write_atomically(csv, &rows::csv(found)?)?;
    files::write_atomically(page, budget_page::page(found).as_bytes())
}
