//! `gonio validate`: a stored table against the laws and the models.

use std::path::PathBuf;

use clap::Args;

use super::output::{Output, say, to_json};
use super::table_file;
use crate::error::{Error, Result};
use crate::validate;

/// Hold a table to the laws of energy and reciprocity and to every named model
#[derive(Args)]
#[command(after_help = "Exits with 1 where the table breaks a law or misses its expectation.\n\n\
    Example: gonio validate out/quickstart/quickstart.exr")]
pub struct Arguments {
    /// The table; <stem>.realisations.exr beside it is used where it is there
    table: PathBuf,
    /// Print one JSON document: ok, failures, comparisons
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let path = &arguments.table;
    let table = table_file::load(path)?;
    let parts = table_file::realisations_beside(path, &table)?;
    let verdict = if table.campaign.is_empty() {
        say(format_args!("note: {} holds no campaign: held to the laws alone", path.display()));
        validate::examine_laws(&table, parts.as_ref())
    } else {
        validate::examine(&table, &table_file::campaign_of(path, &table)?, parts.as_ref())
    };
    let mut out = Output::default();
    if arguments.json {
        out.json(&to_json(&verdict)?)?;
    } else {
        out.lines(verdict.lines())?;
    }
    if verdict.ok { Ok(0) } else { Err(Error::Disagreement(verdict.failures.join("\nerror: "))) }
}
