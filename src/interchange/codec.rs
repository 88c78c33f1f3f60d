//! What every format says of itself: what its files hold, and how they are written and read.

use std::borrow::Cow;
use std::io::{BufReader, Write};
use std::path::Path;

use super::content::bands::Bands;
use super::content::half_difference::as_arms;
use super::read_back::{self, ReadBack};
use super::{Imported, Lookup, Options};
use crate::error::Checked;
use crate::files::{self, Input};
use crate::instrument::GridKind;
use crate::table::BrdfTable;

/// What a format's files can hold.
#[derive(Debug, Clone, Copy)]
pub struct FormatTraits {
    /// The format's name on the command line.
    pub name: &'static str,
    /// Error bars and orders besides the totals.
    pub more_than_totals: bool,
    /// Pairs of directions that were not measured.
    pub gaps: bool,
    /// Half/difference angles as they are.
    pub half_difference: bool,
    /// Which light, by its side of the surface.
    pub sides: Sides,
    /// Another table besides, under light from the back.
    pub light_from_back: bool,
    /// More than one colour; else it is the luminance.
    pub colours: bool,
    /// More colours than R, G and B.
    pub wavelengths: bool,
    /// The table's own directions; else the table is interpolated on the format's.
    pub own_directions: bool,
    /// The last polar angles of light and sensor, degrees, of a table with this last incidence.
    pub reach_deg: fn(f64) -> [f64; 2],
}

/// The sides of the surface that a file speaks of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// Light that comes back alone.
    Reflection,
    /// Light that comes back, or light that has gone through: one of them a file.
    One,
    /// Both in one file.
    Both,
}

impl FormatTraits {
    /// Of a format that holds the totals of Y, or of R, G and B, at the table's own directions.
    pub const fn totals(name: &'static str) -> Self {
        FormatTraits {
            name,
            more_than_totals: false,
            gaps: false,
            sides: Sides::Reflection,
            light_from_back: false,
            half_difference: false,
            colours: true,
            wavelengths: false,
            own_directions: true,
            reach_deg: |last_deg| [85.0f64.max(last_deg.min(89.0)), 90.0],
        }
    }

    /// The same at directions of the format's own.
    pub const fn resampled(name: &'static str) -> Self {
        FormatTraits { own_directions: false, ..Self::totals(name) }
    }
}

/// A format of another program.
pub trait Codec: Sync {
    /// What its files can hold.
    fn traits(&self) -> FormatTraits;

    /// The most bytes of memory that [`Codec::decode`] may take, besides the file's.
    // Tested by tests/process/bombs.rs.
    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        Ok(4 * bytes.len() as u64)
    }

    /// What a file holds, and one sentence for each thing that the reader has to say of it.
    fn decode(&self, bytes: &[u8], options: &Options) -> Checked<(Imported, Vec<String>)>;

    /// What is written of a table that the format holds.
    fn encode<'a>(&self, table: &'a BrdfTable, options: &Options) -> Checked<Encoded<'a>>;

    /// Compares what was just written to `path` with its table. Formats that list the table's own bins read the file
    /// line by line: neither the file nor a second table is in memory.
    fn read_back(&self, path: &Path, table: &BrdfTable, options: &Options) -> Checked<Option<ReadBack>> {
        if let Some(by_bands) = self.by_bands() {
            let mut whole = table;
            return by_bands.read_back(open(path)?, &mut whole);
        }
        let (file, _) = self.decode(&files::read(path)?, options)?;
        let mut arms = None;
        if let Imported::Table(found) = &file
            && found.grid.kind == GridKind::HalfDifference
        {
            if found.grid == table.grid {
                let totals: Vec<&[f32]> = found.colours.iter().map(|colour| &colour.total[..]).collect();
                return read_back::listed(table, &totals);
            }
            arms = as_arms(table, None)?;
        }
        Ok(read_back::read_back(arms.as_ref().unwrap_or(table), file.into_function()?.as_ref()))
    }

    /// How a table larger than memory is written, if the format allows that.
    fn by_bands(&self) -> Option<&dyn BandCodec> {
        None
    }
}

/// A format whose files list the incidences one after the other, so that a table is written a band of them at a time.
pub trait BandCodec {
    /// How the values and angles are meant.
    fn convention(&self) -> &'static str;

    /// Writes a file.
    fn write(&self, bands: &mut dyn Bands, out: &mut dyn Write) -> Checked<()>;

    /// Compares a file with its table.
    fn read_back(&self, file: BufReader<Input>, bands: &mut dyn Bands) -> Checked<Option<ReadBack>>;
}

/// What is written of a table, and notes on it.
pub struct Encoded<'a> {
    /// What is written.
    pub content: FileContent<'a>,
    /// How its values and angles are meant.
    pub convention: String,
    /// What was lost or chosen, one sentence each.
    pub notes: Vec<String>,
}

/// Writes a file's bytes.
pub type Fill<'a> = Box<dyn FnOnce(&mut dyn Write) -> Checked<()> + 'a>;

/// What is written.
pub enum FileContent<'a> {
    /// The bytes of a file.
    Bytes(Vec<u8>),
    /// The bytes of a file, as they are made.
    Stream(Fill<'a>),
    /// The files of a folder, by name.
    Folder(Box<dyn Iterator<Item = (String, String)> + 'a>),
}

impl<'a> Encoded<'a> {
    /// A file whose bytes are in memory.
    pub fn bytes(bytes: impl Into<Vec<u8>>, convention: impl Into<String>, notes: Vec<String>) -> Self {
        Encoded { content: FileContent::Bytes(bytes.into()), convention: convention.into(), notes }
    }

    /// A file that `write` makes of the table.
    pub fn stream(
        convention: &str,
        table: &'a BrdfTable,
        write: fn(&BrdfTable, &mut dyn Write) -> Checked<()>,
    ) -> Self {
        let fill: Fill = Box::new(move |out| write(table, out));
        Encoded { content: FileContent::Stream(fill), convention: convention.into(), notes: vec![] }
    }
}

/// The halves of a table that are there, each above the horizon, and whether it is light that has gone through.
pub fn halves(table: &BrdfTable) -> Vec<(bool, Cow<'_, BrdfTable>)> {
    if !table.grid.looks_below() {
        return vec![(false, Cow::Borrowed(table))];
    }
    let half = |below| Some((below, Cow::Owned(table.half(below)?)));
    [false, true].into_iter().filter_map(half).collect()
}

/// The file at `path`, open.
pub fn open(path: &Path) -> Checked<BufReader<Input>> {
    Ok(BufReader::new(files::open(path)?))
}

/// What every format of other directions than the table's loses.
pub fn resampling_notes(lookup: &Lookup) -> Vec<String> {
    let mut notes = vec![
        "resampled: cubic between bins, at equal half vector between incidences, with the table's albedo; error bars are not \
         held"
            .into(),
    ];
    let last = lookup.last_theta_i_deg();
    if last < 80.0 {
        notes.push(format!("the incidences end at {last:.4} degrees: beyond, the last one's ratio to a guiding law at equal half vector"));
    }
    notes
}
