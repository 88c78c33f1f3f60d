//! `gonio materials`: the names that `[optics] material` and `--material` take.

use clap::Args;

use crate::campaign::materials::{self, MaterialEntry};
use crate::cli::text::layout::{columns, wrapped};
use crate::cli::text::output::Output;
use crate::error::Result;

/// List the materials that have a name: F0, and where n and k are known
#[derive(Args)]
#[command(after_help = "Example: gonio materials")]
pub struct Arguments {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let all = materials::all();
    let mut out = Output::default();
    if arguments.json {
        out.json(&all)?;
        return Ok(0);
    }
    let head = ["material", "F0: R", "G", "B", "n, k (nm)", "clear (nm)", "n at 550"];
    out.lines(columns(&head, &all.iter().map(row).collect::<Vec<_>>()))?;
    let meaning = "material = \"NAME\" under [optics]. F0: Schlick's formula, the default. n, k: fresnel = \"exact\", or \
        wavelength_nm. clear: facet = \"dielectric\". Others: f0, eta and k, or file (docs/guide.md, Materials)";
    out.lines(wrapped("", meaning))?;
    Ok(0)
}

fn row(entry: &MaterialEntry) -> Vec<String> {
    let range =
        |range: Option<[f64; 2]>| range.map_or("-".into(), |[low, high]| format!("{low:.0} to {high:.0}"));
    let f0 = |k: usize| entry.f0.map_or("-".into(), |f0| format!("{:.3}", f0[k]));
    let clear = entry.clear_n_550.map_or("-".into(), |n| format!("{n:.4}"));
    vec![entry.name.into(), f0(0), f0(1), f0(2), range(entry.index_nm), range(entry.clear_nm), clear]
}
