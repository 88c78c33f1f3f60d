//! EXR with one part for each stop of the light: x = phi_r, y = theta_r, an image of the lobe that any viewer opens.
//!
//! Channels and attributes are those of the native table, `gonio.stop`, `gonio.theta_i_deg` and `gonio.phi_i_deg`
//! beside them; the campaign stands in the first part. Comes back bit for bit.

use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::path::Path;

use super::codec::{self, Codec, Encoded, Holds};
use super::numpy::arrays;
use super::read_back::{Listing, ReadBack};
use super::{Checked, Imported, Options, needed};
use crate::files::image::{self, ImagePart, Samples};
use crate::files::image_blocks::BlockReader;
use crate::files::{exr_header, image_rows};
use crate::instrument::Grid;
use crate::table::brdf_table::named_wavelength;
use crate::table::{BrdfTable, ColourChannels, SchlickSums, check_grid};

/// How the values are meant.
const CONVENTION: &str = "one part a stop, named by its angles; column = phi_r, row = theta_r; FLOAT, BRDF in 1/sr, no \
    cosine, bin means; attribute gonio.grid: the geometry as JSON; mirror direction at phi_r = phi_i + 180";

const GRID: &str = "gonio.grid";
const STOP: &str = "gonio.stop";
/// Texts of the table that the first part carries.
const TEXTS: [&str; 4] = ["gonio.campaign", "gonio.version", "gonio.seed", "gonio.patch_digest"];

/// The format.
pub struct ExrParts;

impl Codec for ExrParts {
    fn name(&self) -> &'static str {
        "exr_parts"
    }

    fn holds(&self) -> Holds {
        Holds { more_than_totals: true, gaps: true, wavelengths: true, ..Holds::TOTALS }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        if exr_header::is_exr(bytes) { needed::image_table(bytes) } else { Ok(4 * bytes.len() as u64) }
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Ok((Imported::Table(read(bytes)?), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &'a Options) -> Checked<Encoded<'a>> {
        Ok(Encoded::bytes(write(table)?, CONVENTION, vec![]))
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, _options: &Options) -> Checked<Option<ReadBack>> {
        read_back(BlockReader::open(codec::open(path)?)?, table)
    }
}

type NamedChannel =
    (&'static str, fn(&ColourChannels) -> &Vec<f32>, fn(&mut ColourChannels) -> &mut Vec<f32>);
const CHANNELS: [NamedChannel; 5] = [
    ("", |c| &c.total, |c| &mut c.total),
    ("single.", |c| &c.single, |c| &mut c.single),
    ("multiple.", |c| &c.multiple, |c| &mut c.multiple),
    ("stderr.", |c| &c.stderr, |c| &mut c.stderr),
    ("stderr.single.", |c| &c.stderr_single, |c| &mut c.stderr_single),
];

/// Width and height of a part: columns and rows of bins, or all bins in a row.
fn size(grid: &Grid) -> (usize, usize) {
    match arrays::shape(grid, 1)[..] {
        [_, _, rows, columns] => (columns, rows),
        _ => (grid.bins(), 1),
    }
}

/// The bytes of a file; the table's values go into it row by row.
pub fn write(table: &BrdfTable) -> Checked<Vec<u8>> {
    let grid = serde_json::to_string(&table.grid).map_err(|e| e.to_string())?;
    let parts: Vec<ImagePart> = (0..table.grid.stops()).map(|stop| part(table, stop, &grid)).collect();
    let (width, height) = size(&table.grid);
    let planes: BTreeMap<String, &[f32]> = planes(table).into_iter().collect();
    Ok(image_rows::encode(&parts, |(stop, name, row), out| {
        let first = (stop * height + row) * width;
        let places = out.as_chunks_mut::<4>().0.iter_mut();
        match planes.get(name) {
            Some(values) => places.zip(&values[first..]).for_each(|(out, value)| *out = value.to_ne_bytes()),
            None => places.zip(&table.hits[first..]).for_each(|(out, hits)| *out = hits.to_ne_bytes()),
        }
    })?)
}

/// Every FLOAT channel of the table, by its name in the file.
fn planes(table: &BrdfTable) -> Vec<(String, &[f32])> {
    let mut planes: Vec<(String, &[f32])> = Vec::new();
    for (name, colour) in table.colour_names().iter().zip(&table.colours) {
        planes
            .extend(CHANNELS.iter().map(|(layer, of, _)| (format!("{layer}{name}"), of(colour).as_slice())));
        let orders = (2..).zip(&colour.orders);
        planes.extend(orders.map(|(order, values)| (format!("order{order}.{name}"), values.as_slice())));
    }
    let sums = table.schlick.iter().flat_map(|sums| sums.channels(table.is_by_order()));
    planes.extend(sums.map(|(name, sums)| (name, sums.as_slice())));
    planes
}

/// The heading of a part: its channels have types only.
fn part(table: &BrdfTable, stop: usize, grid: &str) -> ImagePart {
    let (width, height) = size(&table.grid);
    let (theta_i, phi_i) = table.grid.stop_deg(stop);
    let mut part = ImagePart { width, height, ..ImagePart::default() };
    part.name = Some(format!("stop{stop:04}_thetaI{theta_i:05.1}_phiI{phi_i:05.1}"));
    for (name, _) in planes(table) {
        part.channels.insert(name, Samples::F32(vec![]));
    }
    part.channels.insert("hits".into(), Samples::U32(vec![]));
    for (name, value) in [(STOP, stop as f64), ("gonio.theta_i_deg", theta_i), ("gonio.phi_i_deg", phi_i)] {
        part.attributes.insert(name.into(), image::Attribute::Number(value));
    }
    if stop == 0 {
        part.set_text(GRID, grid);
        let seed = table.seed.to_string();
        let texts = [&table.campaign, &table.version, &seed, &table.patch_digest];
        TEXTS.iter().zip(texts).for_each(|(name, text)| part.set_text(name, text));
    }
    part
}

/// Compares the totals of a file with the table that it was written from, row by row.
fn read_back(mut file: BlockReader<impl Read + Seek>, table: &BrdfTable) -> Checked<Option<ReadBack>> {
    let (width, names, mut listing) = (size(&table.grid).0, table.colour_names(), Listing::new(table));
    for part in 0..file.outlines().len() {
        let stop = file.outlines()[part].number(STOP).unwrap_or(-1.0);
        if !(0.0..table.grid.stops() as f64).contains(&stop) || file.outlines()[part].width != width {
            return Err(format!("{STOP} = {stop}, {} columns", file.outlines()[part].width).into());
        }
        for number in 0..file.count(part) {
            for (name, row, values) in file.read(part, number)?.lines() {
                let Some(colour) = names.iter().position(|colour| *colour == name) else { continue };
                for (column, value) in values.as_chunks::<4>().0.iter().enumerate() {
                    listing.add(stop as usize, row * width + column, colour, f32::from_ne_bytes(*value));
                }
            }
        }
    }
    listing.finish()
}

/// The table in the bytes of a file.
///
/// Held by: `exr_parts_come_back_bit_for_bit`, `damaged_parts_are_refused`.
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    let mut parts = image::decode(bytes)?;
    let number = |part: &ImagePart| part.number(STOP).filter(|&stop| stop >= 0.0 && stop.fract() == 0.0);
    if let Some(part) = parts.iter().find(|part| number(part).is_none()) {
        return Err(format!(
            "part `{}` has no {STOP}: not written by this program",
            part.name.as_deref().unwrap_or("")
        )
        .into());
    }
    parts.sort_by(|a, b| number(a).unwrap_or(0.0).total_cmp(&number(b).unwrap_or(0.0)));
    let text = parts[0].text(GRID).ok_or_else(|| format!("the first part has no {GRID}"))?;
    let grid: Grid = serde_json::from_str(text).map_err(|e| format!("{GRID}: {e}"))?;
    let (stops, _) = check_grid(&grid)?;
    let (width, height) = size(&grid);
    let fits = |(stop, part): (usize, &ImagePart)| {
        number(part) == Some(stop as f64) && (part.width, part.height) == (width, height)
    };
    if parts.len() != stops || !parts.iter().enumerate().all(fits) {
        return Err(
            format!("{} parts do not make {stops} stops of {width} x {height} bins", parts.len()).into()
        );
    }
    let names = colour_names(&parts[0]);
    let mut colours: Vec<ColourChannels> = names
        .iter()
        .map(|name| ColourChannels { wavelength_nm: named_wavelength(name), ..ColourChannels::default() })
        .collect();
    for (name, colour) in names.iter().zip(&mut colours) {
        for (layer, _, place) in CHANNELS {
            *place(colour) = floats(&mut parts, &format!("{layer}{name}"))?;
        }
        while let Some(order) = optional(&mut parts, &format!("order{}.{name}", colour.orders.len() + 2))? {
            colour.orders.push(order);
        }
    }
    let mut hits = Vec::with_capacity(stops * width * height);
    for part in &mut parts {
        match part.channels.remove("hits") {
            Some(Samples::U32(values)) => hits.extend(values),
            _ => return Err("channel `hits` (UINT) is missing".into()),
        }
    }
    let schlick = SchlickSums::gathered(|name| optional(&mut parts, name))?;
    let [campaign, version, seed, patch_digest] =
        TEXTS.map(|name| parts[0].text(name).unwrap_or_default().to_string());
    let seed = seed.parse().map_err(|_| format!("gonio.seed = `{seed}` is no seed"))?;
    Ok(BrdfTable { grid, campaign, version, seed, patch_digest, colours, hits, schlick })
}

/// Y, wavelengths in increasing order, or R, G, B.
fn colour_names(part: &ImagePart) -> Vec<String> {
    let wavelength = |name: &String| named_wavelength(name).map(|nm| (nm, name.clone()));
    let mut spectral: Vec<(f64, String)> = part.channels.keys().filter_map(wavelength).collect();
    spectral.sort_by(|a, b| a.0.total_cmp(&b.0));
    match spectral.is_empty() {
        false => spectral.into_iter().map(|(_, name)| name).collect(),
        true if part.channels.contains_key("Y") => vec!["Y".into()],
        true => ["R", "G", "B"].map(String::from).to_vec(),
    }
}

/// A FLOAT channel of all parts, where the first one has it.
fn optional(parts: &mut [ImagePart], name: &str) -> Checked<Option<Vec<f32>>> {
    let there = parts.first().is_some_and(|part| part.channels.contains_key(name));
    there.then(|| floats(parts, name)).transpose()
}

/// A FLOAT channel of all parts, one after the other.
fn floats(parts: &mut [ImagePart], name: &str) -> Checked<Vec<f32>> {
    let mut all = Vec::new();
    for (stop, part) in parts.iter_mut().enumerate() {
        let Some(Samples::F32(values)) = part.channels.remove(name) else {
            return Err(format!("stop {stop}: channel `{name}` (FLOAT) is missing").into());
        };
        if let Some(bin) = values.iter().position(|value| !value.is_finite()) {
            return Err(format!(
                "stop {stop}, channel `{name}`, bin {bin}: {} is not a finite number",
                values[bin]
            )
            .into());
        }
        all.extend(values);
    }
    Ok(all)
}
