//! `gonio cite`: how to cite a table, as text and as BibTeX.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::text::layout::wrapped;
use super::text::output::Output;
use crate::campaign;
use crate::error::{Result, on_one_line};
use crate::table::TableRows;

/// Say how to cite a table: program, version, campaign, seed and digest, as text and as BibTeX
#[derive(Args)]
#[command(after_help = "Example: gonio cite out/quickstart/quickstart.exr")]
pub struct Arguments {
    /// The table
    table: PathBuf,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let rows = TableRows::open(&arguments.table)?;
    let source = Source::of(&rows);
    let mut out = Output::default();
    if arguments.json {
        out.json(&json!({
            "text": source.text(), "bibtex": source.bibtex(), "version": source.version, "seed": source.seed,
            "digest": source.digest,
        }))?;
    } else {
        out.lines(wrapped("", &source.text()))?;
        out.line("")?;
        out.document(source.bibtex())?;
    }
    Ok(0)
}

/// Where a table comes from.
struct Source {
    /// The campaign's name; of an imported table the file's.
    name: String,
    version: String,
    /// None of a table that was not measured by the program.
    seed: Option<u64>,
    digest: Option<String>,
}

impl Source {
    fn of(rows: &TableRows) -> Self {
        let header = rows.header();
        let folder = rows.path().parent().unwrap_or(rows.path());
        let parsed = campaign::parse(&header.campaign, "campaign", folder).ok();
        let stem = rows.path().file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Source {
            seed: parsed.as_ref().map(|_| header.seed),
            name: on_one_line(&parsed.map_or(stem, |parsed| parsed.campaign.name)),
            version: on_one_line(&header.version),
            digest: rows.digest().map(str::to_string),
        }
    }

    /// What makes the table again, or tells it from others.
    fn facts(&self) -> String {
        let seed = self.seed.map(|seed| format!("seed {seed}"));
        let digest = self.digest.as_ref().map(|digest| format!("content digest {digest}"));
        seed.into_iter().chain(digest).collect::<Vec<_>>().join(", ")
    }

    fn text(&self) -> String {
        let how = if self.seed.is_some() { "BRDF table measured with" } else { "BRDF table imported with" };
        format!(
            "{}: {how} gonio {}, a virtual gonioreflectometer; {}.",
            self.name,
            self.version,
            self.facts()
        )
    }

    fn bibtex(&self) -> String {
        let key: String =
            self.name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        format!(
            "@misc{{gonio_{key},\n  author       = {{{{the gonio authors}}}},\n  title        = {{{{gonio}}, a virtual \
             gonioreflectometer: table {}}},\n  howpublished = {{Software, version {}}},\n  note         = {{{}}}\n}}",
            escaped(&self.name),
            escaped(&self.version),
            escaped(&self.facts())
        )
    }
}

/// A text as TeX shows it.
fn escaped(text: &str) -> String {
    let mut tex = String::new();
    for c in text.chars() {
        match c {
            '_' | '&' | '%' | '$' | '#' | '{' | '}' => tex.extend(['\\', c]),
            '\\' => tex.push_str("\\textbackslash{}"),
            '~' => tex.push_str("\\textasciitilde{}"),
            '^' => tex.push_str("\\textasciicircum{}"),
            _ => tex.push(c),
        }
    }
    tex
}
