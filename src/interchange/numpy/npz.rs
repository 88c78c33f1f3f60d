//! NPZ: every array of the table for NumPy, stored in a zip without compression; comes back bit for bit.
//!
//! Arrays: `brdf` [theta_i, phi_i, theta_r, phi_r(, colour)] f4, `single`, `stderr`, `stderr_single` alike, `hits` u4
//! (`schlick`, `unit`, `parts.*` f4) without colours, `order2` ..., `m00` ... `m33` with `stderr.m00` ... and `wavelength_nm` where the table has them, axes
//! f8 in degrees, `phi_r_relative` u1, texts as `str` (`<U`): `campaign`, `grid` (JSON, the whole geometry),
//! `version`, `seed`, `patch_digest`; older files have them as u1 (UTF-8), which are read too. Lists of patches or
//! points have [incidence, bin(, colour)].

use std::io::{self, Cursor, Read, Seek, Write};
use std::path::Path;

use npyz::AutoSerialize;
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipWriter};

use super::arrays::{apart, interleaved, shape};
use super::members::{Members, WAVELENGTHS, needed};
use crate::error::wrong;
use crate::files::memory;
use crate::files::npy::{self, NpyValues};
use crate::instrument::Grid;
use crate::interchange::codec::{self, Codec, Encoded, FormatTraits, Sides};
use crate::interchange::read_back::{Listing, ReadBack};
use crate::interchange::text::seam;
use crate::interchange::{Checked, Imported, Options, spectral_table};
use crate::table::{BrdfTable, ColourChannels, MUELLER_ELEMENTS, SchlickSums, check_grid};

/// How the values are meant.
const CONVENTION: &str = "the table as it is: f4, C order, [theta_i, phi_i, theta_r, phi_r(, colour)]; BRDF in 1/sr, no \
    cosine; bin means (array grid: the geometry as JSON); angles in degrees, mirror direction at phi_r = phi_i + 180";

/// The format.
pub struct Npz;

impl Codec for Npz {
    fn traits(&self) -> FormatTraits {
        FormatTraits {
            more_than_totals: true,
            gaps: true,
            sides: Sides::Both,
            half_difference: true,
            wavelengths: true,
            ..FormatTraits::totals("npz")
        }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        needed(bytes)
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Ok((read(bytes)?.into(), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &Options) -> Checked<Encoded<'a>> {
        Ok(Encoded::stream(CONVENTION, table, write))
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, _options: &Options) -> Checked<Option<ReadBack>> {
        let file = codec::open(path)?;
        let length = file.get_ref().length()?;
        read_back(file, length, table)
    }
}

/// An array of a channel: its name, where its values are read from, and where they are put.
type ChannelArray =
    (&'static str, fn(&ColourChannels) -> &Vec<f32>, fn(&mut ColourChannels) -> &mut Vec<f32>);
const CHANNELS: [ChannelArray; 5] = [
    ("brdf", |c| &c.total, |c| &mut c.total),
    ("single", |c| &c.single, |c| &mut c.single),
    ("multiple", |c| &c.multiple, |c| &mut c.multiple),
    ("stderr", |c| &c.stderr, |c| &mut c.stderr),
    ("stderr_single", |c| &c.stderr_single, |c| &mut c.stderr_single),
];

/// The elements of Mueller matrices likewise.
type MuellerArrays =
    (&'static str, fn(&ColourChannels) -> &Vec<Vec<f32>>, fn(&mut ColourChannels) -> &mut Vec<Vec<f32>>);
const MUELLER: [MuellerArrays; 2] =
    [("", |c| &c.mueller, |c| &mut c.mueller), ("stderr.", |c| &c.stderr_mueller, |c| &mut c.stderr_mueller)];

/// An archive while it is written.
pub(crate) struct Archive<W: Write> {
    zip: ZipWriter<StreamWriter<W>>,
}

impl<W: Write> Archive<W> {
    pub fn new(out: W) -> Self {
        Archive { zip: ZipWriter::new_stream(out) }
    }

    pub fn finish(self) -> Checked<()> {
        self.zip.finish().map_err(io::Error::from)?;
        Ok(())
    }

    pub fn array<T: AutoSerialize>(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl Iterator<Item = T>,
    ) -> Checked<()> {
        self.begin(name, shape.iter().product::<usize>())?;
        Ok(npy::encode(&mut self.zip, shape, values)?)
    }

    pub fn text(&mut self, name: &str, text: &str) -> Checked<()> {
        self.begin(name, text.len())?;
        Ok(npy::encode_text(&mut self.zip, text)?)
    }

    /// Begins the member of an array of so many values.
    fn begin(&mut self, name: &str, values: usize) -> Checked<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(values as u64 * 8 > u64::from(u32::MAX) / 2);
        Ok(self.zip.start_file(format!("{name}.npy"), options).map_err(io::Error::from)?)
    }

    pub fn axis(&mut self, name: &str, values: &[f64]) -> Checked<()> {
        self.array(name, &[values.len()], values.iter().copied())
    }
}

/// Writes every channel, array by array.
pub fn write(table: &BrdfTable, out: &mut dyn Write) -> Checked<()> {
    let mut archive = Archive::new(out);
    let grid = &table.grid;
    let shape_of = |colours: usize| shape(grid, colours);
    for (name, channel, _) in CHANNELS {
        let values: Vec<&[f32]> = table.colours.iter().map(|colour| channel(colour).as_slice()).collect();
        archive.array(name, &shape_of(values.len()), interleaved(&values))?;
    }
    archive.array("hits", &shape_of(1), table.hits.iter().copied())?;
    for order in 0..table.colours[0].orders.len() {
        let values: Vec<&[f32]> =
            table.colours.iter().map(|colour| colour.orders[order].as_slice()).collect();
        archive.array(&format!("order{}", order + 2), &shape_of(values.len()), interleaved(&values))?;
    }
    for (layer, planes, _) in MUELLER {
        for (k, element) in MUELLER_ELEMENTS.iter().enumerate().take(planes(&table.colours[0]).len()) {
            let values: Vec<&[f32]> =
                table.colours.iter().map(|colour| planes(colour)[k].as_slice()).collect();
            archive.array(&format!("{layer}{element}"), &shape_of(values.len()), interleaved(&values))?;
        }
    }
    for (name, sums) in table.schlick.iter().flat_map(|sums| sums.channels(table.is_by_order())) {
        archive.array(&name, &shape_of(1), sums.iter().copied())?;
    }
    let wavelengths = table.wavelengths_nm();
    if !wavelengths.is_empty() {
        archive.axis(WAVELENGTHS, &wavelengths)?;
    }
    for (name, axis) in axes(grid).into_iter().filter(|(_, axis)| !axis.is_empty()) {
        archive.axis(name, axis)?;
    }
    archive.array("phi_r_relative", &[1], [u8::from(grid.phi_r_relative)].into_iter())?;
    archive.text("grid", &serde_json::to_string(grid).map_err(|e| e.to_string())?)?;
    archive.text("campaign", &table.campaign)?;
    archive.text("version", &table.version)?;
    archive.text("seed", &table.seed.to_string())?;
    archive.text("patch_digest", &table.patch_digest)?;
    archive.finish()
}

fn axes(grid: &Grid) -> [(&'static str, &[f64]); 6] {
    [
        ("theta_i_deg", &grid.theta_i_deg),
        ("phi_i_deg", &grid.phi_i_deg),
        ("theta_r_edges_deg", &grid.theta_r_edges_deg),
        ("phi_r_edges_deg", &grid.phi_r_edges_deg),
        ("theta_r_deg", &grid.theta_r_deg),
        ("phi_r_deg", &grid.phi_r_deg),
    ]
}

/// The table of an archive. Needed are `brdf` and the axes (or `grid`); what is left out is "not available".
// Tested by `npz_comes_back_bit_for_bit`, `damaged_archives_are_refused`
// (tests/it/interchange/interchange_arrays.rs).
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    memory::check(needed(bytes)?)?;
    let mut members = Members::open(Cursor::new(bytes), bytes.len() as u64)?;
    // A table of this program has its own geometry; other files may list one azimuth twice.
    let own = !members.text("grid")?.is_empty();
    let grid = members.grid()?;
    check_grid(&grid)?;
    let colours = match members.need("brdf")?.shape.len() as isize - shape(&grid, 1).len() as isize {
        0 => 1,
        1 => members.need("brdf")?.shape.last().copied().unwrap_or(0),
        _ => return Err("array `brdf` has neither the table's axes nor one more for the colour".into()),
    };
    let wavelengths = members.wavelengths(colours)?;
    let wanted = shape(&grid, colours);
    let total = members.channel("brdf", &wanted)?.ok_or("no array `brdf`")?;
    let mut table = spectral_table(grid, apart(&total, colours), &wavelengths)?;
    for (name, _, place) in &CHANNELS[1..] {
        if let Some(values) = members.channel(name, &wanted)? {
            let channels = table.colours.iter_mut().zip(apart(&values, colours));
            channels.for_each(|(colour, values)| *place(colour) = values);
        }
    }
    let plain = shape(&table.grid, 1);
    if let Some(array) = members.array("hits")? {
        match array.values {
            NpyValues::U32(hits) if array.shape == plain => table.hits = hits,
            _ => return Err(wrong!("array `hits`: u4 of shape {plain:?} needed")),
        }
    }
    table.schlick = SchlickSums::gathered(|name| members.channel(name, &plain))?;
    for order in 2.. {
        let Some(values) = members.channel(&format!("order{order}"), &wanted)? else { break };
        let channels = table.colours.iter_mut().zip(apart(&values, colours));
        channels.for_each(|(colour, values)| colour.orders.push(values));
    }
    for (layer, _, place) in MUELLER {
        for element in MUELLER_ELEMENTS {
            let Some(values) = members.channel(&format!("{layer}{element}"), &wanted)? else { break };
            let channels = table.colours.iter_mut().zip(apart(&values, colours));
            channels.for_each(|(colour, values)| place(colour).push(values));
        }
    }
    if table
        .colours
        .iter()
        .any(|colour| !matches!((colour.mueller.len(), colour.stderr_mueller.len()), (0, 0) | (16, 16)))
    {
        return Err("arrays `m00` to `m33` and `stderr.m00` to `stderr.m33`: all of them, or none".into());
    }
    table.campaign = members.text("campaign")?;
    table.patch_digest = members.text("patch_digest")?;
    let version = members.text("version")?;
    table.version = if version.is_empty() { table.version } else { version };
    let seed = members.text("seed")?;
    if !seed.is_empty() {
        table.seed = seed.parse().map_err(|_| format!("array `seed`: `{seed}` is no seed"))?;
    }
    if own { Ok(table) } else { seam::dropped(table) }
}

/// Compares the totals of an archive with the table that it was written from.
fn read_back(file: impl Read + Seek, length: u64, table: &BrdfTable) -> Checked<Option<ReadBack>> {
    let (colours, bins) = (table.colours.len(), table.grid.bins());
    let mut members = Members::open(file, length)?;
    if members.grid()? != table.grid {
        return Err("the geometry is not the table's".into());
    }
    let total = members.channel("brdf", &shape(&table.grid, colours))?;
    let (total, mut listing) = (total.ok_or("no array `brdf`")?, Listing::new(table));
    for (k, &value) in total.iter().enumerate() {
        listing.add(k / colours / bins, k / colours % bins, k % colours, value);
    }
    listing.finish()
}
