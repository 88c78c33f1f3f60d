//! CSV: one line a bin, with a heading. Read back as a table of points in the order of the lines.

use std::io::{Read, Write};

use super::read_back::{ReadBack, middles_deg};
use super::samples::{self, Sample};
use super::{Fail, Reason};
use crate::instrument::Region;
use crate::table::BrdfTable;

/// How the values are meant.
pub const CONVENTION: &str = "one line a bin; angles in degrees, absolute azimuths, mirror direction at phi_r = phi_i + 180; \
    theta_r, phi_r the middle of the bin; BRDF in 1/sr, no cosine; projected_solid_angle in sr; stderr -1 = not available";

const ANGLES: [&str; 4] = ["theta_i_deg", "phi_i_deg", "theta_r_deg", "phi_r_deg"];
/// The column, 1 in every line, of a table whose azimuths of the light are all alike.
const ISOTROPIC: &str = "isotropic";
/// More lines than any table that is worth reading as text.
const MOST_LINES: usize = 1 << 26;

/// Writes the totals with their errors.
pub fn write(table: &BrdfTable, out: &mut dyn Write) -> Result<(), Fail> {
    let mut writer = csv::Writer::from_writer(out);
    write_heading(&table.colour_names(), table.grid.is_isotropic(), &mut writer)?;
    write_lines(table, table.grid.is_isotropic(), &mut writer)?;
    Ok(writer.flush()?)
}

/// The first line.
pub fn write_heading(
    names: &[String],
    isotropic: bool,
    writer: &mut csv::Writer<impl Write>,
) -> Result<(), Fail> {
    let mut heading: Vec<String> = ANGLES.iter().map(|name| name.to_string()).collect();
    heading.push("projected_solid_angle".into());
    heading.extend(names.iter().map(|name| name.to_string()));
    heading.extend(names.iter().map(|name| format!("stderr.{name}")));
    heading.push("hits".into());
    heading.extend(isotropic.then(|| ISOTROPIC.into()));
    writer.write_record(&heading).map_err(failed)
}

/// The lines of a table, or of a band of it.
pub fn write_lines(
    table: &BrdfTable,
    isotropic: bool,
    writer: &mut csv::Writer<impl Write>,
) -> Result<(), Fail> {
    let bins = table.grid.bins();
    for stop in 0..table.grid.stops() {
        let (theta_i, phi_i) = table.grid.stop_deg(stop);
        let regions = table.grid.regions(stop);
        for (bin, (theta_r, phi_r)) in middles_deg(&table.grid, stop).into_iter().enumerate() {
            let (at, region) = (stop * bins + bin, &regions[bin]);
            let size = Region::projected_solid_angle(region);
            let angles = [theta_i, phi_i, theta_r, phi_r, size].map(|value| value.to_string());
            let totals = table.colours.iter().map(|colour| colour.total[at].to_string());
            let errors = table.colours.iter().map(|colour| colour.stderr[at].to_string());
            let hits = std::iter::once(table.hits[at].to_string());
            let last = hits.chain(isotropic.then(|| "1".to_string()));
            writer
                .write_record(angles.into_iter().chain(totals).chain(errors).chain(last))
                .map_err(failed)?;
        }
    }
    Ok(())
}

fn failed(error: csv::Error) -> Fail {
    Fail::Io(error.into())
}

/// A table of points from lines with `theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg` and `Y` or `R,G,B`; other columns are
/// left out. A negative polar angle is the far side of its plane.
///
/// Held by: `csv_comes_back`, `damaged_lines_are_refused` (tests/interchange_arrays.rs).
pub fn read(bytes: &[u8]) -> Reason<BrdfTable> {
    let mut found = Vec::new();
    let (colours, isotropic) = each_sample(bytes, |sample| {
        if found.len() == MOST_LINES {
            return Err(format!("more than {MOST_LINES} lines"));
        }
        found.push(sample);
        Ok(())
    })?;
    samples::table(&found, colours, isotropic)
}

/// Holds a file of the table's own bins, in their order, to the table, line by line.
pub fn read_back(file: impl Read, table: &BrdfTable) -> Reason<Option<ReadBack>> {
    samples::held_to(table, 0.0, |each| each_sample(file, each).map(|_| ()))
}

/// Visits the samples of a file; returns the number of colours and whether the file says that it is isotropic.
fn each_sample(file: impl Read, mut visit: impl FnMut(Sample) -> Reason<()>) -> Reason<(usize, bool)> {
    let mut lines = Lines::open(file)?;
    let colours = lines.columns.len() - ANGLES.len();
    lines.try_for_each(|sample| visit(sample?))?;
    Ok((colours, lines.isotropic.is_some()))
}

/// The samples of a file, line by line.
pub struct Lines<R> {
    records: csv::StringRecordsIntoIter<R>,
    columns: Vec<usize>,
    isotropic: Option<usize>,
}

impl<R: Read> Lines<R> {
    /// Reads the heading.
    pub fn open(file: R) -> Reason<Self> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(file);
        let heading = reader.headers().map_err(|e| one_line(&e))?.clone();
        let column = |name: &str| heading.iter().position(|cell| cell == name);
        let need = |name: &str| column(name).ok_or_else(|| format!("no column `{name}`"));
        let mut columns = ANGLES.iter().map(|name| need(name)).collect::<Reason<Vec<usize>>>()?;
        match (column("Y"), column("R")) {
            (Some(y), None) => columns.push(y),
            (None, Some(_)) => {
                columns.extend(["R", "G", "B"].iter().map(|name| need(name)).collect::<Reason<Vec<_>>>()?)
            }
            _ => return Err("a column `Y` or columns `R`, `G`, `B` needed".into()),
        }
        let isotropic = column(ISOTROPIC);
        Ok(Lines { records: reader.into_records(), columns, isotropic })
    }

    fn sample(&self, record: csv::Result<csv::StringRecord>) -> Reason<Sample> {
        let record = record.map_err(|e| one_line(&e))?;
        let line = record.position().map_or(0, |at| at.line());
        let number = |&column: &usize| {
            let cell = record.get(column).unwrap_or_default();
            let value: f64 = cell.parse().map_err(|_| format!("line {line}: `{cell}` is no number"))?;
            if value.is_finite() { Ok(value) } else { Err(format!("line {line}: {value} is not finite")) }
        };
        let numbers = self.columns.iter().map(number).collect::<Reason<Vec<f64>>>()?;
        // Rounded as a table holds it: what f32 cannot hold is infinite there.
        if let Some(value) = numbers[4..].iter().find(|v| !((**v as f32).is_finite() && **v >= 0.0)) {
            return Err(format!("line {line}: {value} is no BRDF value (not negative, at most 3.4e38)"));
        }
        if let Some(cell) = self.isotropic.map(|column| record.get(column).unwrap_or_default())
            && cell != "1"
        {
            return Err(format!(
                "line {line}: `{ISOTROPIC}` is `{cell}`: 1 in every line needed, or no such column"
            ));
        }
        Ok(Sample::of(line as usize, &numbers))
    }
}

impl<R: Read> Iterator for Lines<R> {
    type Item = Reason<Sample>;

    fn next(&mut self) -> Option<Self::Item> {
        let record = self.records.next()?;
        Some(self.sample(record))
    }
}

fn one_line(error: &csv::Error) -> String {
    if let csv::ErrorKind::UnequalLengths { pos: Some(at), expected_len, len } = error.kind() {
        return format!("line {}: {len} cells, the heading has {expected_len}", at.line());
    }
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
