//! `gonio validate`: a stored table against the laws and the models.

use std::path::{Path, PathBuf};

use clap::Args;

use super::output::{Output, say, to_json, warn};
use crate::campaign::{self, Campaign};
use crate::error::{Error, Result};
use crate::table::{BrdfTable, Realisations, realisations, store};
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
    let loaded = store::load(path)?;
    for warning in &loaded.warnings {
        warn(format_args!("{}: {warning}", path.display()));
    }
    let parts = realisations_beside(path, &loaded.table)?;
    let verdict = if loaded.table.campaign.is_empty() {
        say(format_args!("note: {} holds no campaign: held to the laws alone", path.display()));
        validate::examine_laws(&loaded.table, parts.as_ref())
    } else {
        validate::examine(&loaded.table, &campaign_of(path, &loaded.table)?, parts.as_ref())
    };
    let mut out = Output::default();
    if arguments.json {
        out.json(&to_json(&verdict)?)?;
    } else {
        out.lines(verdict.lines())?;
    }
    if verdict.ok { Ok(0) } else { Err(Error::Disagreement(verdict.failures.join("\nerror: "))) }
}

/// The campaign that the table was measured by. Its faults are faults of the table's file.
fn campaign_of(path: &Path, table: &BrdfTable) -> Result<Campaign> {
    let folder = path.parent().unwrap_or(Path::new(""));
    match campaign::parse(&table.campaign, "campaign", folder) {
        Ok(parsed) => Ok(parsed.campaign),
        Err(error @ Error::Campaign(_)) => Err(Error::format(path, error.to_string())),
        Err(error) => Err(error),
    }
}

/// The table's realisations, where they lie beside it.
fn realisations_beside(path: &Path, table: &BrdfTable) -> Result<Option<Realisations>> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let beside = path.with_file_name(format!("{stem}.realisations.exr"));
    if !beside.is_file() {
        say(format_args!("note: {} is absent: no pairing over realisations", beside.display()));
        return Ok(None);
    }
    let file = realisations::load(&beside)?;
    for warning in &file.warnings {
        warn(format_args!("{}: {warning}", beside.display()));
    }
    if !file.belongs_to(table)? {
        warn(format_args!("{} belongs to another table and is not used", beside.display()));
        return Ok(None);
    }
    Ok(Some(file.realisations))
}
