//! CSV: one line a bin, with a header. Read back as a table of points in the order of the lines.

use std::io::{self, BufReader, Chain, Cursor, Read, Write};

use super::named_columns::{Columns, names_of};
use super::samples;
use super::samples::MeasuredPair;
use crate::error::wrong;
use crate::files::Input;
use crate::instrument::Region;
use crate::interchange::codec::{BandCodec, Codec, Encoded, FormatTraits, Sides};
use crate::interchange::read_back::{ReadBack, ReadErrors, middles_deg};
use crate::interchange::{Bands, Checked, Imported, Options, needed};
use crate::table::BrdfTable;
use crate::text_decoding::decode_text_or_latin1;

/// How the values are meant.
const CONVENTION: &str = "one line a bin; angles in degrees, absolute azimuths, mirror direction at phi_r = phi_i + 180; \
    theta_r, phi_r the middle of the bin; BRDF in 1/sr, no cosine; projected_solid_angle in sr; stderr -1 = not available";

const ANGLES: [&str; 4] = ["theta_i_deg", "phi_i_deg", "theta_r_deg", "phi_r_deg"];
/// The column, 1 in every line, of a table whose azimuths of the light are all alike.
const ISOTROPIC: &str = "isotropic";
/// The column of the bins' sizes, which follow from the geometry.
const SIZE: &str = "projected_solid_angle";
/// Bytes of a line of a header at most.
const LONGEST_HEADER: usize = 1 << 16;
/// More lines than any table that is worth reading as text.
const MOST_LINES: usize = 1 << 26;

/// The format.
pub struct Csv;

impl Codec for Csv {
    fn traits(&self) -> FormatTraits {
        FormatTraits {
            more_than_totals: true,
            sides: Sides::Both,
            gaps: true,
            wavelengths: true,
            ..FormatTraits::totals("csv")
        }
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

    fn by_bands(&self) -> Option<&dyn BandCodec> {
        Some(self)
    }
}

impl BandCodec for Csv {
    fn convention(&self) -> &'static str {
        CONVENTION
    }

    fn write(&self, bands: &mut dyn Bands, out: &mut dyn Write) -> Checked<()> {
        let mut writer = csv::Writer::from_writer(out);
        let outline = bands.outline();
        let isotropic = outline.grid.is_isotropic();
        write_header(&names_of(outline), isotropic, &mut writer)?;
        bands.each(&mut |band| write_lines(band, isotropic, &mut writer))?;
        Ok(writer.flush()?)
    }

    fn read_back(&self, file: BufReader<Input>, bands: &mut dyn Bands) -> Checked<Option<ReadBack>> {
        let (mut errors, mut lines) = (ReadErrors::default(), SampleLines::open(file)?);
        bands.each(&mut |band| {
            let samples = lines.by_ref().take(band.hits.len() - band.gaps());
            errors.join(samples::listed(band, 0.0, |each| samples.into_iter().try_for_each(|s| each(s?)))?)
        })?;
        Ok(errors.read_back())
    }
}

/// Writes the totals of a table with their errors.
pub fn write(mut table: &BrdfTable, out: &mut dyn Write) -> Checked<()> {
    Csv.write(&mut table, out)
}

/// The first line.
fn write_header(names: &[String], isotropic: bool, writer: &mut csv::Writer<impl Write>) -> Checked<()> {
    let mut header: Vec<String> = ANGLES.iter().map(|name| name.to_string()).collect();
    header.push(SIZE.into());
    header.extend(names.iter().map(|name| name.to_string()));
    header.extend(names.iter().map(|name| format!("stderr.{name}")));
    header.push("hits".into());
    header.extend(isotropic.then(|| ISOTROPIC.into()));
    Ok(writer.write_record(&header).map_err(io::Error::from)?)
}

/// The lines of a table, or of a band of it. A gap has none.
fn write_lines(table: &BrdfTable, isotropic: bool, writer: &mut csv::Writer<impl Write>) -> Checked<()> {
    let bins = table.grid.bins();
    for incidence in 0..table.grid.incidences() {
        let (theta_i, phi_i) = table.grid.incidence_deg(incidence);
        let regions = table.grid.regions(incidence);
        for (bin, (theta_r, phi_r)) in middles_deg(&table.grid, incidence).into_iter().enumerate() {
            let (at, region) = (incidence * bins + bin, &regions[bin]);
            if table.is_gap(at) {
                continue;
            }
            let size = Region::projected_solid_angle(region);
            let angles = [theta_i, phi_i, theta_r, phi_r, size].map(|value| value.to_string());
            let totals = table.colours.iter().map(|colour| colour.total[at].to_string());
            let errors = table.colours.iter().map(|colour| colour.stderr[at].to_string());
            let hits = std::iter::once(table.hits[at].to_string());
            let last = hits.chain(isotropic.then(|| "1".to_string()));
            writer
                .write_record(angles.into_iter().chain(totals).chain(errors).chain(last))
                .map_err(io::Error::from)?;
        }
    }
    Ok(())
}

/// A table of points from lines with `theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg` and values; what another column
/// holds follows from its name. Columns stand between commas, semicolons or tabs; between the last two a comma is a
/// decimal point. Lines that begin with # are left out; a negative polar angle is the far side of its plane.
// Tested by `csv_comes_back`, `damaged_lines_are_refused` (tests/it/interchange/interchange_arrays.rs).
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    let text = decode_text_or_latin1(bytes)?;
    let mut lines = SampleLines::open(text.as_bytes())?;
    let mut found = Vec::new();
    for sample in lines.by_ref() {
        if found.len() == MOST_LINES {
            return Err(wrong!("more than {MOST_LINES} lines"));
        }
        found.push(sample?);
    }
    samples::table(&found, &lines.columns, lines.isotropic.is_some())
}

/// The samples of a file, line by line.
struct SampleLines<R> {
    records: csv::StringRecordsIntoIter<Chain<Cursor<Vec<u8>>, R>>,
    angles: Vec<usize>,
    columns: Columns,
    isotropic: Option<usize>,
    /// Whether a comma inside a number is its point.
    decimal_commas: bool,
}

impl<R: Read> SampleLines<R> {
    /// Reads the header.
    fn open(mut file: R) -> Checked<Self> {
        let head = head(&mut file)?;
        let last = head.trim_ascii_end().rsplit(|&byte| byte == b'\n').next().unwrap_or_default();
        let mark = [b';', b'\t'].into_iter().find(|mark| last.contains(mark)).unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .delimiter(mark)
            .from_reader(Cursor::new(head).chain(file));
        let header = reader.headers().map_err(|e| one_line(&e))?.clone();
        let column = |name: &str| header.iter().position(|cell| cell == name);
        let need = |name: &&str| column(name).ok_or_else(|| format!("no column `{name}`"));
        let angles = ANGLES.iter().map(need).collect::<Result<Vec<usize>, String>>()?;
        let isotropic = column(ISOTROPIC);
        // Numbers of a line are told behind its angles, which are put first; those columns hold nothing else.
        let own = |k: usize| angles.contains(&k) || isotropic == Some(k);
        let names: Vec<&str> =
            header.iter().enumerate().map(|(k, cell)| if own(k) { SIZE } else { cell }).collect();
        let columns = Columns::of(&names, ANGLES.len())?;
        let records = reader.into_records();
        Ok(SampleLines { records, angles, columns, isotropic, decimal_commas: mark != b',' })
    }

    fn sample(&self, record: csv::Result<csv::StringRecord>) -> Checked<MeasuredPair> {
        let record = record.map_err(|e| one_line(&e))?;
        let line = record.position().map_or(0, |at| at.line());
        let number = |cell: &str| {
            let point = if self.decimal_commas { cell.replace(',', ".") } else { cell.to_string() };
            let value: f64 = point.parse().map_err(|_| format!("line {line}: `{cell}` is no number"))?;
            if value.is_finite() { Ok(value) } else { Err(wrong!("line {line}: {value} is not finite")) }
        };
        let numbers = record.iter().map(number).collect::<Checked<Vec<f64>>>()?;
        if self.isotropic.is_some_and(|column| numbers[column] != 1.0) {
            return Err(wrong!("line {line}: `{ISOTROPIC}` is 1 in every line, or there is no such column"));
        }
        let angles = self.angles.iter().map(|&column| numbers[column]);
        let all: Vec<f64> = angles.chain(numbers.iter().copied()).collect();
        if let Some(why) = self.columns.fault(&all) {
            return Err(wrong!("line {line}: {why}"));
        }
        let sample = MeasuredPair::of(line as usize, &all, &self.columns);
        // Rounded as a table holds it: what f32 cannot hold is infinite there.
        if let Some(value) = sample.values.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
            return Err(wrong!("line {line}: {value} is no BRDF value (not negative, at most 3.4e38)"));
        }
        Ok(sample)
    }
}

/// The bytes of a file up to the end of its first line that is no comment.
fn head(file: &mut impl Read) -> Checked<Vec<u8>> {
    let mut head = Vec::new();
    let (mut byte, mut line) = ([0u8], 0);
    loop {
        let read = file.read(&mut byte).map_err(|e| e.to_string())?;
        head.extend_from_slice(&byte[..read]);
        if read == 0 || byte[0] == b'\n' {
            let bare = head[line..].trim_ascii();
            if read == 0 || !(bare.is_empty() || bare.starts_with(b"#")) {
                return Ok(head);
            }
            line = head.len();
        } else if head.len() - line > LONGEST_HEADER {
            return Err(wrong!("line 1 is longer than {LONGEST_HEADER} bytes: no header"));
        }
    }
}

impl<R: Read> Iterator for SampleLines<R> {
    type Item = Checked<MeasuredPair>;

    fn next(&mut self) -> Option<Self::Item> {
        let record = self.records.next()?;
        Some(self.sample(record))
    }
}

fn one_line(error: &csv::Error) -> String {
    if let csv::ErrorKind::UnequalLengths { pos: Some(at), expected_len, len } = error.kind() {
        return format!("line {}: {len} cells, the header has {expected_len}", at.line());
    }
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
