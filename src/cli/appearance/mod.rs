//! `gonio appearance`: gloss, haze, scatter, reflectance and colour of a stored table.

mod rows;
mod text;

use std::path::PathBuf;

use clap::Args;

use super::export::check_output;
use super::streams::Place;
use super::table_file;
use super::text::output::{Output, to_json};
use super::text::progress::Stage;
use crate::appearance;
use crate::error::{Error, Result};
use crate::files;

/// Say what standards ask of a table: gloss, haze, image, scatter, reflectance factors, L*a*b*
#[derive(Args)]
#[command(
    after_help = "Gloss (ISO 2813) at 20, 60, 85 degrees, reflection haze (ISO 13803), haze and DOI (ASTM E430),\n\
    total integrated scatter, reflectance, 45:0, 0:45, 8:d, multi-angle colours. An angle between two\n\
    incidences up to 30 degrees apart is interpolated; what the bins do not resolve is n/a.\n\n\
    Example: gonio appearance out/quickstart/quickstart.exr"
)]
pub struct Arguments {
    /// The table; <stem>.realisations.exr next to it gives standard errors
    table: PathBuf,
    /// All figures as CSV, with angle-resolved scatter in the plane of incidence
    #[arg(short, long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long)]
    force: bool,
    /// Print one JSON document: azimuths
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let path = &arguments.table;
    let place = arguments.output.as_ref().map(|output| Place::of(output, arguments.json)).transpose()?;
    if let Some(place) = &place {
        check_output(path, place.path(), arguments.force)?;
    }
    let table = table_file::load(path)?;
    let parts = table_file::realisations_beside(path, &table)?;
    let stage = Stage::begin("reading the instruments");
    let found = appearance::appearance(&table, parts.as_ref()).map_err(|why| Error::format(path, why))?;
    drop(stage);
    if let Some(place) = &place {
        files::write_atomically(place.path(), &rows::csv(&found)?)?;
    }
    let mut out = Output::default();
    if arguments.json {
        out.json(&to_json(&found)?)?;
    } else {
        out.lines(text::lines(&found))?;
    }
    place.map_or(Ok(()), Place::done).map(|()| 0)
}
