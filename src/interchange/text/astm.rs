//! ASTM E1392/E2387 text: one line a pair of directions, angles in radians.
//!
//! `KEY value` lines, the last `VARS theta_i,phi_i,theta_s,phi_s,<channels>`, then the samples. The standard's text is
//! not free; this is the form that its readers share (libbsdf).

use std::io::{BufRead, ErrorKind, Write};
use std::path::Path;

use super::named_columns::{Columns, names_of};
use super::samples::{self, MeasuredPair, whole_deg};
use crate::error::wrong;
use crate::interchange::codec::{self, Codec, Encoded, FormatTraits, Sides};
use crate::interchange::read_back::{ReadBack, middles_deg};
use crate::interchange::{Checked, Imported, Options, needed};
use crate::table::BrdfTable;
use crate::text_decoding::decode_text_or_latin1;

/// How the values are meant.
const CONVENTION: &str = "one line a pair of directions, angles in radians, absolute azimuths, phi_s = phi_i + pi is the \
    mirror direction, theta_s beyond pi/2 light that has gone through; BSDF in 1/sr, no cosine; the middle of each bin";

const ANGLES: [&str; 4] = ["theta_i", "phi_i", "theta_s", "phi_s"];
/// The header line of a table whose azimuths of the light are all alike; other readers pass over keys that they don't
/// know.
const ISOTROPIC: &str = "ISOTROPIC";
/// More lines than are worth reading as text.
const MOST_LINES: usize = 1 << 26;

/// The format.
pub struct Astm;

impl Codec for Astm {
    fn traits(&self) -> FormatTraits {
        FormatTraits { gaps: true, sides: Sides::Both, wavelengths: true, ..FormatTraits::totals("astm") }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        needed::list(bytes)
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Ok((read(bytes)?.into(), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &Options) -> Checked<Encoded<'a>> {
        Ok(Encoded::stream(CONVENTION, table, write))
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, _options: &Options) -> Checked<Option<ReadBack>> {
        let file = codec::open(path)?;
        // Twelve digits of radians.
        samples::listed(table, 1e-8, |each| each_sample(file, each).map(|_| ()))?.finish()
    }
}

/// Writes the totals; a gap has no line.
pub fn write(table: &BrdfTable, out: &mut dyn Write) -> Checked<()> {
    let (incidences, bins) = (table.grid.incidences(), table.grid.bins());
    let name = match (table.grid.looks_above(), table.grid.looks_below()) {
        (true, true) => "BSDF",
        (false, true) => "BTDF",
        _ => "BRDF",
    };
    writeln!(out, "LAB_NAME gonio\nSYSTEM_NAME gonio {}\nMEAS_NAME {name}", table.version)?;
    writeln!(out, "NUM_POINTS {}", incidences * bins - table.gaps())?;
    if table.grid.is_isotropic() {
        writeln!(out, "{ISOTROPIC} yes")?;
    }
    writeln!(out, "VARS {},{}", ANGLES.join(","), names_of(table).join(","))?;
    for incidence in 0..incidences {
        let (theta_i, phi_i) = table.grid.incidence_deg(incidence);
        for (bin, (theta_s, phi_s)) in middles_deg(&table.grid, incidence).into_iter().enumerate() {
            if table.is_gap(incidence * bins + bin) {
                continue;
            }
            let angles = [theta_i, phi_i, theta_s, phi_s].map(|deg| format!("{:.12}", deg.to_radians()));
            let values = table.colours.iter().map(|colour| colour.total[incidence * bins + bin].to_string());
            let line: Vec<String> = angles.into_iter().chain(values).collect();
            writeln!(out, "{}", line.join(","))?;
        }
    }
    Ok(())
}

/// The table of points of a file. What a channel holds follows from its name; a negative polar angle is the far side
/// of its plane; negative values become 0.
// Tested by `astm_comes_back`, `damaged_texts_are_refused` (tests/it/interchange/interchange_text.rs).
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    let text = decode_text_or_latin1(bytes)?;
    let mut found = Vec::new();
    let (columns, isotropic) = each_sample(text.as_bytes(), |sample| {
        if found.len() == MOST_LINES {
            return Err(wrong!("more than {MOST_LINES} lines"));
        }
        found.push(sample);
        Ok(())
    })?;
    samples::table(&found, &columns, isotropic)
}

/// Visits the samples of a file; returns what its channels are and whether the file says that it is isotropic.
fn each_sample(
    file: impl BufRead,
    mut visit: impl FnMut(MeasuredPair) -> Checked<()>,
) -> Checked<(Columns, bool)> {
    let unread = |e: std::io::Error| match e.kind() {
        ErrorKind::InvalidData => "not a text in UTF-8".to_string(),
        _ => e.to_string(),
    };
    let mut lines = file.lines().enumerate().map(|(k, line)| (k + 1, line.map_err(unread)));
    let (mut isotropic, mut points) = (false, None);
    let names = loop {
        let Some((_, line)) = lines.next() else { return Err("no VARS line: not an ASTM file".into()) };
        let line = line?;
        isotropic |= line.split_whitespace().eq([ISOTROPIC, "yes"]);
        if let Some(count) = line.trim().strip_prefix("NUM_POINTS ") {
            let count = count.trim();
            points =
                Some(count.parse::<usize>().map_err(|_| format!("NUM_POINTS {count}: a number needed"))?);
        }
        if let Some(names) = line.trim().strip_prefix("VARS ") {
            break cells(names).map(str::to_string).collect::<Vec<_>>();
        }
    };
    if names.iter().take(ANGLES.len()).ne(&ANGLES) {
        return Err("VARS theta_i,phi_i,theta_s,phi_s and channels needed".into());
    }
    let channels: Vec<&str> = names[ANGLES.len()..].iter().map(String::as_str).collect();
    let columns = Columns::of(&channels, ANGLES.len()).map_err(|why| format!("VARS: {why}"))?;
    let mut found = 0;
    for (number, line) in lines {
        let line = line?;
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let mut numbers = Vec::with_capacity(names.len());
        for cell in cells(line) {
            let value: f64 = cell.parse().map_err(|_| format!("line {number}: `{cell}` is no number"))?;
            numbers.push(value);
        }
        if numbers.len() != names.len() || numbers.iter().any(|value| !value.is_finite()) {
            return Err(wrong!(
                "line {number}: {} finite numbers needed, one for each name of VARS",
                names.len()
            ));
        }
        for angle in &mut numbers[..4] {
            *angle = whole_deg(*angle);
        }
        if let Some(why) = columns.fault(&numbers) {
            return Err(wrong!("line {number}: {why}"));
        }
        let mut sample = MeasuredPair::of(number, &numbers, &columns);
        sample.values.iter_mut().for_each(|value| *value = value.max(0.0));
        visit(sample)?;
        found += 1;
    }
    if let Some(points) = points.filter(|&points| points > found) {
        return Err(wrong!("NUM_POINTS is {points}, the file has {found} samples: it was cut short"));
    }
    Ok((columns, isotropic))
}

/// The cells of a line: between commas or, where it has none, between blanks.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    let commas = line.contains(',');
    let mark = move |c: char| if commas { c == ',' } else { c.is_whitespace() };
    line.split(mark).map(str::trim).filter(move |cell| commas || !cell.is_empty())
}
