//! `gonio formats`: what `gonio export` writes and `gonio import` reads.

use clap::Args;
use serde_json::{Value, json};

use crate::cli::text::layout::columns;
use crate::cli::text::output::Output;
use crate::error::Result;
use crate::interchange::Format;
use crate::interchange::codec::Sides;

/// List the formats of other programs, and what files of each can hold
#[derive(Args)]
#[command(after_help = "Example: gonio formats")]
pub struct Arguments {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let mut out = Output::default();
    if arguments.json {
        out.json(&Format::ALL.map(document))?;
        return Ok(0);
    }
    let head = ["format", "files", "import", "directions", "errors", "colours", "light"];
    out.lines(columns(&head, &Format::ALL.map(row)))?;
    out.line("")?;
    out.lines(Format::ALL.map(|format| format!("{:<12} {}", format.name(), format.about())))?;
    Ok(0)
}

fn row(format: Format) -> Vec<String> {
    let traits = format.codec().traits();
    let word = |is: bool, yes: &str, no: &str| if is { yes.to_string() } else { no.to_string() };
    let colours = if traits.wavelengths { "any" } else { word_of_colours(traits.colours) };
    vec![
        format.name().into(),
        format.endings().join(" "),
        word(format.is_read(), "yes", "-"),
        word(traits.own_directions, "the table's", "its own"),
        word(traits.more_than_totals, "yes", "-"),
        colours.into(),
        sides(traits.sides).into(),
    ]
}

fn word_of_colours(colours: bool) -> &'static str {
    if colours { "Y or RGB" } else { "Y" }
}

/// The light that a file holds, by its side of the surface.
fn sides(sides: Sides) -> &'static str {
    match sides {
        Sides::Reflection => "R",
        Sides::One => "R or T",
        Sides::Both => "R and T",
    }
}

fn document(format: Format) -> Value {
    let traits = format.codec().traits();
    json!({
        "name": format.name(),
        "about": format.about(),
        "endings": format.endings(),
        "import": format.is_read(),
        "own_directions": traits.own_directions,
        "errors": traits.more_than_totals,
        "gaps": traits.gaps,
        "colours": traits.colours,
        "wavelengths": traits.wavelengths,
        "light": sides(traits.sides),
    })
}
