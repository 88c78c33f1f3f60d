//! `gonio init`: a commented campaign to begin with, of the surface, the instrument and the purpose that are named or
//! answered for.

use std::io::{self, BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::text::output::{Output, inform};
use super::text::quoted;
use crate::campaign;
use crate::error::{Error, Result};
use crate::files;
use crate::job::paths::already_exists;

mod template;

use template::{Instrument, Purpose, Surface};

/// Write a commented campaign to begin with; on a terminal it asks for what is not given
#[derive(Args)]
#[command(after_help = "Example: gonio init brushed_gold --surface brushed --purpose render")]
pub struct Arguments {
    /// Its name; NAME.toml is written, or with - stdout
    #[arg(default_value = "campaign")]
    name: String,
    /// What is measured: ggx, brushed, beckmann, psd, grains, smith, scan
    #[arg(long, value_enum, hide_possible_values = true)]
    surface: Option<Surface>,
    /// The arms: hemisphere, plane, utia, merl, rgl, rosi, klems-full
    #[arg(long, value_enum, hide_possible_values = true)]
    instrument: Option<Instrument>,
    /// What the table is for: look, formula, render, glass
    #[arg(long, value_enum, hide_possible_values = true)]
    purpose: Option<Purpose>,
    /// The heights of --surface scan
    #[arg(long, value_name = "FILE", default_value = "heights.npy")]
    map: PathBuf,
    /// Replace NAME.toml if it is there
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let to_stdout = arguments.name == "-";
    let name = if to_stdout { "campaign" } else { arguments.name.trim_end_matches(".toml") };
    let ask = io::stdin().is_terminal() && io::stderr().is_terminal();
    let text = template::campaign(
        Path::new(name).file_name().and_then(|name| name.to_str()).unwrap_or(name),
        answer(arguments.surface, ask, "What is measured?")?,
        answer(arguments.instrument, ask, "With which arms?")?,
        answer(arguments.purpose, ask, "What is the table for?")?,
        &arguments.map,
    );
    // What does not go together, such as an isotropic layout and a brushed surface, is said by who knows.
    campaign::parse(&text, name, Path::new(""))?;
    let mut out = Output::default();
    if to_stdout {
        out.document(text.trim_end())?;
        return Ok(0);
    }
    let path = PathBuf::from(format!("{name}.toml"));
    if files::is_there(&path) && !arguments.force {
        return Err(already_exists(&path, "is there already"));
    }
    files::write_atomically(&path, text.as_bytes())?;
    let file = quoted(&path);
    out.line(format_args!("{file}: next, gonio check {file}, then gonio measure {file}"))?;
    Ok(0)
}

/// What was given; on a terminal, what is answered; else the first of all.
fn answer<T: ValueEnum + Clone>(given: Option<T>, ask: bool, question: &str) -> Result<T> {
    let all = T::value_variants();
    match given {
        Some(given) => Ok(given),
        None if ask => asked(question, all),
        None => Ok(all[0].clone()),
    }
}

/// Asks until the answer is a number or a name of the list, or nothing, which is the first.
fn asked<T: ValueEnum + Clone>(question: &str, all: &[T]) -> Result<T> {
    let stdin = |e| Error::io(Path::new("stdin"), e);
    inform(question);
    let values: Vec<_> = all.iter().filter_map(T::to_possible_value).collect();
    for (k, value) in values.iter().enumerate() {
        let help = value.get_help().map(ToString::to_string).unwrap_or_default();
        inform(format_args!("  {} {:<11} {help}", k + 1, value.get_name()));
    }
    loop {
        write!(io::stderr(), "1 to {} [1]: ", all.len()).map_err(stdin)?;
        let mut line = String::new();
        let ended = io::stdin().lock().read_line(&mut line).map_err(stdin)? == 0;
        let word = line.trim();
        let named = |value: &clap::builder::PossibleValue| value.get_name() == word;
        let place = match word {
            "" => Some(0),
            _ => word.parse::<usize>().ok().and_then(|k| k.checked_sub(1)).or(values.iter().position(named)),
        };
        match place.and_then(|place| all.get(place)) {
            Some(chosen) => return Ok(chosen.clone()),
            None if ended => return Ok(all[0].clone()),
            None => inform(format_args!("{word:?} is none of them")),
        }
    }
}
