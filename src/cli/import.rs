//! `gonio import`: a table from another program's file.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::export::{check_output, format_of, options_of};
use super::output::{Output, to_json, warn, wrapped};
use crate::error::Result;
use crate::interchange;
use crate::table::store;

/// Make a table of another program's file
#[derive(Args)]
#[command(after_help = "Example: gonio import gold.binary --from merl -o gold.exr")]
pub struct Arguments {
    /// The file
    file: PathBuf,
    /// npz csv merl rgl
    #[arg(long, value_name = "FORMAT")]
    from: String,
    /// The table to write
    #[arg(short, long, value_name = "TABLE.exr")]
    output: PathBuf,
    /// Average over the stops and bins of this table instead of the file's own
    #[arg(long, value_name = "TABLE.exr")]
    like: Option<PathBuf>,
    /// MERL: values at the centres of their cells, not at the nodes
    #[arg(long)]
    merl_centre: bool,
    /// Replace the table if it is there
    #[arg(long)]
    force: bool,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let format = format_of("--from", &arguments.from)?;
    check_output(&arguments.file, &arguments.output, arguments.force)?;
    let options = options_of(arguments.merl_centre, &[]);
    let like = arguments.like.as_ref().map(|path| store::load(path)).transpose()?;
    let grid = like.as_ref().map(|loaded| &loaded.table.grid);
    let (table, notes) = interchange::import(&arguments.file, format, &options, grid)?;
    store::save(&arguments.output, &table)?;
    for note in &notes {
        warn(format_args!("{}: {note}", arguments.file.display()));
    }
    let (stops, bins, colours) = (table.grid.stops(), table.grid.bins(), table.colours.len());
    let kind = to_json(&table.grid.kind)?;
    let mut out = Output::default();
    if arguments.json {
        let table = arguments.output.display().to_string();
        let sizes = json!({ "table": table, "kind": kind, "stops": stops, "bins": bins, "colours": colours, "notes": notes });
        out.json(&sizes)?;
    } else {
        let kind = kind.as_str().unwrap_or_default();
        let text = format!(
            "{} ({kind}): {stops} stops of {bins} bins, {colours} colour{}; no error bars unless the file has them",
            arguments.output.display(),
            if colours == 1 { "" } else { "s" },
        );
        out.lines(wrapped("table  ", &text))?;
    }
    Ok(0)
}
