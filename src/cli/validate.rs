//! `gonio validate`: a stored table against the laws and the models.

use std::path::{Path, PathBuf};

use clap::Args;

use super::table_file::{self, Opened};
use super::text;
use super::text::output::{Output, note, to_json};
use super::text::progress::Stage;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::table::BrdfTable;
use crate::validate::{self, verdict};

/// Test a table against the laws of energy and reciprocity and against every named model
#[derive(Args)]
#[command(after_help = "Exits with 1 where the table breaks a law or misses its expectation.\n\n\
    Example: gonio validate out/quickstart/quickstart.exr")]
pub struct Arguments {
    /// The table; <stem>.realisations.exr next to it is used where it is there
    table: PathBuf,
    /// Print one JSON document: ok, failures, comparisons
    #[arg(long)]
    json: bool,
}

const COMPARING: &str = "comparing the table with the formula";

pub fn run(arguments: &Arguments) -> Result<u8> {
    let path = &arguments.table;
    let verdict = match table_file::open(path, verdict::row_bytes)? {
        Opened::Whole(table) => {
            let parts = table_file::realisations_beside(path, &table)?;
            let campaign = campaign_of(path, &table)?;
            let _shown = Stage::begin(COMPARING);
            validate::examine(&table, campaign.as_ref(), parts.as_ref())
        }
        Opened::Rows(mut rows) => {
            let parts = table_file::realisations_beside_rows(&rows)?;
            let campaign = campaign_of(path, rows.header())?;
            let _shown = Stage::begin(COMPARING);
            validate::examine_rows(&mut rows, campaign.as_ref(), parts.as_ref(), table_file::band_bytes())?
        }
    };
    let mut out = Output::default();
    if arguments.json {
        out.json(&to_json(&verdict)?)?;
    } else {
        out.lines(text::verdict::lines(&verdict))?;
    }
    if verdict.ok { Ok(0) } else { Err(Error::Disagreement(verdict.failures.join("\nerror: "))) }
}

/// What a table was measured by, if it says so.
fn campaign_of(path: &Path, header: &BrdfTable) -> Result<Option<Campaign>> {
    if header.campaign.is_empty() {
        note(format_args!("{} holds no campaign: tested against the laws alone", path.display()));
    }
    table_file::campaign_if_any(path, header)
}
