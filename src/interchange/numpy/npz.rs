//! NPZ: every array of the table for NumPy, stored in a zip without compression; comes back bit for bit.
//!
//! Arrays: `brdf` [theta_i, phi_i, theta_r, phi_r(, colour)] f4, `single`, `stderr`, `stderr_single` alike, `hits` u4
//! (`schlick`, `unit`, `parts.*` f4) without colours, `order2` ... and `wavelength_nm` where the table has them, axes f8 in degrees, `phi_r_relative` u1, texts as `str` (`<U`): `campaign`, `grid` (JSON, the
//! whole geometry), `version`, `seed`, `patch_digest`; older files have them as u1 (UTF-8), which are read too. Lists of patches or points have [stop, bin(, colour)].

use std::io::{Cursor, Read, Seek, Write};

use npyz::AutoSerialize;
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::files::memory;
use crate::files::npy;
use crate::files::npy::{Array, NpyValues};
use crate::instrument::{Grid, GridKind};
use crate::interchange::read_back::{Listing, ReadBack};
use crate::interchange::text::seam;
use crate::interchange::{Fail, Reason, spectral_table};
use crate::table::{BrdfTable, ColourChannels, SchlickSums, check_grid};

/// How the values are meant.
pub const CONVENTION: &str = "the table as it is: f4, C order, [theta_i, phi_i, theta_r, phi_r(, colour)]; BRDF in 1/sr, no \
    cosine; bin means (array grid: the geometry as JSON); angles in degrees, mirror direction at phi_r = phi_i + 180";

/// Deflate shrinks at most 1032-fold.
const MAX_RATIO: u64 = 1032;
/// More members than any table has.
const MOST_MEMBERS: usize = 128;
/// What each entry of an archive's directory begins with.
const ENTRY: &[u8] = b"PK\x01\x02";
/// Beginnings of entries that chance may put into the data besides.
const MOST_ENTRIES: usize = 1 << 12;
/// Copies of its largest array that a table takes besides all arrays: what the table adds to it, and conversions.
const COPIES: u64 = 8;
/// The array that names the colours of a spectral table.
const WAVELENGTHS: &str = "wavelength_nm";

/// Lengths along the axes of a table's arrays.
pub fn shape(grid: &Grid, colours: usize) -> Vec<usize> {
    let product = |a: &[f64], b: &[f64]| vec![grid.theta_i_deg.len(), grid.phi_i_deg.len(), a.len(), b.len()];
    let mut shape = match (grid.kind, grid.stops_deg.is_empty()) {
        (GridKind::Hemisphere, true) => product(&grid.theta_r_edges_deg[1..], &grid.phi_r_edges_deg[1..]),
        (GridKind::Arm, true) => product(&grid.theta_r_deg, &grid.phi_r_deg),
        _ => vec![grid.stops(), grid.bins()],
    };
    if colours > 1 {
        shape.push(colours);
    }
    shape
}

/// The colours' values side by side.
pub fn interleaved<'a>(colours: &'a [&'a [f32]]) -> impl Iterator<Item = f32> + 'a {
    (0..colours[0].len()).flat_map(move |pixel| colours.iter().map(move |values| values[pixel]))
}

/// The other way round.
pub fn apart(values: &[f32], colours: usize) -> Vec<Vec<f32>> {
    (0..colours).map(|colour| values.iter().skip(colour).step_by(colours).copied().collect()).collect()
}

/// Where a channel is read from, and where it is put.
type ReadChannel = fn(&ColourChannels) -> &Vec<f32>;
type WriteChannel = fn(&mut ColourChannels) -> &mut Vec<f32>;

/// The archive while it is written.
struct Archive<W: Write> {
    zip: ZipWriter<StreamWriter<W>>,
}

impl<W: Write> Archive<W> {
    fn array<T: AutoSerialize>(
        &mut self,
        name: &str,
        shape: &[usize],
        values: impl Iterator<Item = T>,
    ) -> Result<(), Fail> {
        self.begin(name, shape.iter().product::<usize>())?;
        Ok(npy::encode(&mut self.zip, shape, values)?)
    }

    fn text(&mut self, name: &str, text: &str) -> Result<(), Fail> {
        self.begin(name, text.len())?;
        Ok(npy::encode_text(&mut self.zip, text)?)
    }

    /// Begins the member of an array of so many values.
    fn begin(&mut self, name: &str, values: usize) -> Result<(), Fail> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(values as u64 * 8 > u64::from(u32::MAX) / 2);
        self.zip.start_file(format!("{name}.npy"), options).map_err(|e| Fail::Io(e.into()))
    }

    fn axis(&mut self, name: &str, values: &[f64]) -> Result<(), Fail> {
        self.array(name, &[values.len()], values.iter().copied())
    }
}

/// Writes every channel, array by array.
pub fn write(table: &BrdfTable, out: &mut dyn Write) -> Result<(), Fail> {
    let mut archive = Archive { zip: ZipWriter::new_stream(out) };
    let grid = &table.grid;
    let shape_of = |colours: usize| shape(grid, colours);
    let channels: [(&str, ReadChannel); 5] = [
        ("brdf", |c| &c.total),
        ("single", |c| &c.single),
        ("multiple", |c| &c.multiple),
        ("stderr", |c| &c.stderr),
        ("stderr_single", |c| &c.stderr_single),
    ];
    for (name, channel) in channels {
        let values: Vec<&[f32]> = table.colours.iter().map(|colour| channel(colour).as_slice()).collect();
        archive.array(name, &shape_of(values.len()), interleaved(&values))?;
    }
    archive.array("hits", &shape_of(1), table.hits.iter().copied())?;
    for order in 0..table.colours[0].orders.len() {
        let values: Vec<&[f32]> =
            table.colours.iter().map(|colour| colour.orders[order].as_slice()).collect();
        archive.array(&format!("order{}", order + 2), &shape_of(values.len()), interleaved(&values))?;
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
    archive.text("grid", &serde_json::to_string(grid).map_err(|e| Fail::Refused(e.to_string()))?)?;
    archive.text("campaign", &table.campaign)?;
    archive.text("version", &table.version)?;
    archive.text("seed", &table.seed.to_string())?;
    archive.text("patch_digest", &table.patch_digest)?;
    archive.zip.finish().map_err(|e| Fail::Io(e.into()))?;
    Ok(())
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

/// An archive while it is read.
struct Members<R> {
    zip: ZipArchive<R>,
    /// No member can hold more.
    limit: u64,
}

impl<R: Read + Seek> Members<R> {
    fn open(file: R, length: u64) -> Reason<Self> {
        if length == 0 {
            return Err("the file is empty".into());
        }
        let zip = ZipArchive::new(file).map_err(|e| format!("not an NPZ archive: {e}"))?;
        if zip.len() > MOST_MEMBERS {
            return Err(format!("{} members; a table has at most {MOST_MEMBERS}", zip.len()));
        }
        Ok(Members { zip, limit: MAX_RATIO.saturating_mul(length) })
    }

    fn array(&mut self, name: &str) -> Reason<Option<Array>> {
        let file = format!("{name}.npy");
        if self.zip.index_for_name(&file).is_none() {
            return Ok(None);
        }
        let named = |e: String| format!("array `{name}`: {e}");
        let mut member = self.zip.by_name(&file).map_err(|e| named(e.to_string()))?;
        let size = member.size();
        if size > self.limit {
            return Err(named(format!("claims {size} bytes, more than the file can hold")));
        }
        let unread = |e: std::io::Error| named(e.to_string());
        let mut head = Vec::new();
        member.by_ref().take(npy::LONGEST_HEAD as u64).read_to_end(&mut head).map_err(unread)?;
        npy::check_length(&head, size).map_err(named)?;
        let mut bytes = memory::room(usize::try_from(size).unwrap_or(usize::MAX)).map_err(named)?;
        bytes.append(&mut head);
        // What the archive says is not believed beyond what the data give.
        let rest = (size + 1).saturating_sub(bytes.len() as u64);
        member.by_ref().take(rest).read_to_end(&mut bytes).map_err(unread)?;
        npy::decode(&bytes).map(Some).map_err(named)
    }

    /// Bytes that a table of all arrays takes, by what the archive says of their sizes.
    fn bytes(&mut self) -> Reason<u64> {
        let (mut all, mut largest) = (0u64, 0u64);
        for index in 0..self.zip.len() {
            let size = self.zip.by_index_raw(index).map_err(|e| e.to_string())?.size();
            (all, largest) = (all.saturating_add(size), largest.max(size));
        }
        Ok(all.saturating_add(COPIES.saturating_mul(largest)))
    }

    fn need(&mut self, name: &str) -> Reason<Array> {
        self.array(name)?.ok_or_else(|| format!("no array `{name}`"))
    }

    fn axis(&mut self, name: &str) -> Reason<Vec<f64>> {
        let Some(array) = self.array(name)? else { return Ok(vec![]) };
        match array.values {
            NpyValues::F64(values) => Ok(values),
            NpyValues::F32(values) => Ok(values.into_iter().map(f64::from).collect()),
            _ => Err(format!("array `{name}`: floats needed")),
        }
    }

    fn text(&mut self, name: &str) -> Reason<String> {
        let Some(array) = self.array(name)? else { return Ok(String::new()) };
        match array.values {
            NpyValues::Text(texts) => <[String; 1]>::try_from(texts)
                .map(|[text]| text)
                .map_err(|texts| format!("array `{name}`: {} texts, one needed", texts.len())),
            NpyValues::U8(bytes) => {
                String::from_utf8(bytes).map_err(|_| format!("array `{name}`: bytes that are not UTF-8"))
            }
            _ => Err(format!("array `{name}`: a text (str) needed")),
        }
    }

    fn grid(&mut self) -> Reason<Grid> {
        let text = self.text("grid")?;
        if !text.is_empty() {
            return serde_json::from_str(&text).map_err(|e| format!("array `grid`: {e}"));
        }
        let mut grid = Grid {
            theta_i_deg: self.axis("theta_i_deg")?,
            phi_i_deg: self.axis("phi_i_deg")?,
            theta_r_edges_deg: self.axis("theta_r_edges_deg")?,
            phi_r_edges_deg: self.axis("phi_r_edges_deg")?,
            ..Grid::default()
        };
        grid.phi_r_relative = match self.array("phi_r_relative")?.map(|array| array.values) {
            Some(NpyValues::U8(values)) => values.first() == Some(&1),
            Some(_) => return Err("array `phi_r_relative`: u1 or bool needed".into()),
            // An azimuth that is not there tells nothing apart; a single one is where the light stood.
            None => grid.phi_i_deg.is_empty(),
        };
        if grid.phi_i_deg.is_empty() {
            grid.phi_i_deg = vec![0.0];
        }
        Ok(grid)
    }

    /// The wavelengths of so many colours; none for Y and R, G, B.
    fn wavelengths(&mut self, colours: usize) -> Reason<Vec<f64>> {
        let nm = self.axis(WAVELENGTHS)?;
        let sound =
            nm.iter().all(|nm| *nm > 0.0 && nm.is_finite()) && nm.windows(2).all(|pair| pair[0] < pair[1]);
        if !nm.is_empty() && (!sound || nm.len() != colours) {
            return Err(format!("array `{WAVELENGTHS}`: {colours} increasing positive numbers needed"));
        }
        Ok(nm)
    }

    /// A channel with one value per pixel and colour; of f8 arrays the nearest f4.
    fn channel(&mut self, name: &str, shape: &[usize]) -> Reason<Option<Vec<f32>>> {
        let Some(array) = self.array(name)? else { return Ok(None) };
        if array.shape != shape {
            return Err(format!("array `{name}` has shape {:?}, the axes make {shape:?}", array.shape));
        }
        let values = match array.values {
            NpyValues::F32(values) => values,
            NpyValues::F64(values) => values.into_iter().map(|v| v as f32).collect(),
            _ => return Err(format!("array `{name}`: f4 or f8 needed")),
        };
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(format!("array `{name}`, value {at}: {} is not a finite number", values[at])),
            None => Ok(Some(values)),
        }
    }
}

/// Bytes that the table of an archive takes in memory, by what the archive says; nothing is unpacked.
pub fn needed(bytes: &[u8]) -> Reason<u64> {
    // The directory is in memory as a whole, some hundred bytes an entry.
    let entries = bytes.windows(ENTRY.len()).filter(|here| *here == ENTRY).take(MOST_ENTRIES + 1).count();
    if entries > MOST_ENTRIES {
        return Err(format!("more than {MOST_ENTRIES} entries; a table has at most {MOST_MEMBERS} members"));
    }
    Members::open(Cursor::new(bytes), bytes.len() as u64)?.bytes()
}

/// The table of an archive. Needed are `brdf` and the axes (or `grid`); what is left out is "not available".
///
/// Held by: `npz_comes_back_bit_for_bit`, `damaged_archives_are_refused` (tests/it/interchange/interchange_arrays.rs).
pub fn read(bytes: &[u8]) -> Reason<BrdfTable> {
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
    let channels: [(&str, WriteChannel); 4] = [
        ("single", |c| &mut c.single),
        ("multiple", |c| &mut c.multiple),
        ("stderr", |c| &mut c.stderr),
        ("stderr_single", |c| &mut c.stderr_single),
    ];
    for (name, place) in channels {
        if let Some(values) = members.channel(name, &wanted)? {
            let channels = table.colours.iter_mut().zip(apart(&values, colours));
            channels.for_each(|(colour, values)| *place(colour) = values);
        }
    }
    let plain = shape(&table.grid, 1);
    if let Some(array) = members.array("hits")? {
        match array.values {
            NpyValues::U32(hits) if array.shape == plain => table.hits = hits,
            _ => return Err(format!("array `hits`: u4 of shape {plain:?} needed")),
        }
    }
    table.schlick = SchlickSums::gathered(|name| members.channel(name, &plain))?;
    for order in 2.. {
        let Some(values) = members.channel(&format!("order{order}"), &wanted)? else { break };
        let channels = table.colours.iter_mut().zip(apart(&values, colours));
        channels.for_each(|(colour, values)| colour.orders.push(values));
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

/// Holds the totals of an archive to the table that it was written from.
pub fn read_back(file: impl Read + Seek, length: u64, table: &BrdfTable) -> Reason<Option<ReadBack>> {
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
