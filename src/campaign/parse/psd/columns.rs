//! A power spectral density as CSV: frequency and density on each line, under a heading that says which density.

use std::path::Path;

use crate::campaign::parse::short_text;
use crate::psd::{PsdKind, PsdTable};

/// What the heading must be.
const HEADING: &str = "frequency_per_um,psd_um4 (areal) or frequency_per_um,psd_um3 (profile, one-sided)";

/// Headings of the second column.
const KINDS: [(&str, PsdKind); 2] = [("psd_um4", PsdKind::Areal), ("psd_um3", PsdKind::Profile)];

/// What the file at `path` says.
pub fn read(path: &Path) -> Result<PsdTable, String> {
    parse(&short_text::read(path, "list of a PSD")?)
}

/// Lines that are empty or begin with # are left out.
fn parse(text: &str) -> Result<PsdTable, String> {
    let lines = (1..).zip(text.lines().map(str::trim));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let heading: Vec<&str> = lines.next().map_or(vec![], |(_, line)| fields(line).collect());
    let known = |name: &str| KINDS.iter().find(|(known, _)| *known == name).map(|(_, kind)| *kind);
    let kind = match heading[..] {
        ["frequency_per_um", density] => known(density),
        _ => None,
    };
    let kind = kind.ok_or_else(|| format!("must begin with the heading {HEADING}"))?;
    let (mut frequency, mut density) = (Vec::new(), Vec::new());
    for (number, line) in lines {
        let numbers: Vec<Option<f64>> = fields(line).map(|field| field.parse().ok()).collect();
        let &[Some(f), Some(value)] = &numbers[..] else {
            return Err(format!("line {number}: `{line:.60}` is not a frequency and a density"));
        };
        frequency.push(f);
        density.push(value);
    }
    PsdTable::new(kind, frequency, density)
}

fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(str::trim)
}
