//! `gonio presets`: the instruments that `[preset] name` takes.

use clap::Args;

use crate::campaign::presets;
use crate::cli::text::output::Output;
use crate::cli::text::plan;
use crate::error::Result;

/// List the instruments that a campaign can name, and what of each is emulated
#[derive(Args)]
#[command(after_help = "Example: gonio presets")]
pub struct Arguments {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let mut out = Output::default();
    if arguments.json {
        out.json(&presets::ALL)?;
    } else {
        out.lines(presets::ALL.iter().flat_map(plan::preset))?;
    }
    Ok(0)
}
