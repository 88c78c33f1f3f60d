//! EXR with one part for each incidence: x = phi_r, y = theta_r, an image of the lobe that any viewer opens.
//!
//! Channels and attributes are those of the native table, `gonio.stop`, `gonio.theta_i_deg` and `gonio.phi_i_deg`
//! next to them; the campaign stands in the first part. Comes back bit for bit.

use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::path::Path;

use super::codec::{self, Codec, Encoded, FormatTraits, Sides};
use super::numpy::arrays;
use super::read_back::{Listing, ReadBack};
use super::{Checked, Imported, Options, needed};
use crate::error::wrong;
use crate::files::image::{self, ImagePart, Samples};
use crate::files::image_blocks::BlockReader;
use crate::files::{exr_header, image_rows};
use crate::instrument::Grid;
use crate::table::{BrdfTable, Plane, check_grid, planes, store};

/// How the values are meant.
const CONVENTION: &str = "one part for each incidence, named by its angles; column = phi_r, row = theta_r; FLOAT, BRDF in 1/sr, no \
    cosine, bin means; attribute gonio.grid: the geometry as JSON; mirror direction at phi_r = phi_i + 180";

const GRID: &str = "gonio.grid";
const STOP: &str = "gonio.stop";
/// Texts of the table that the first part carries.
const TEXTS: [&str; 4] = ["gonio.campaign", "gonio.version", "gonio.seed", "gonio.patch_digest"];

/// The format.
pub struct ExrParts;

impl Codec for ExrParts {
    fn traits(&self) -> FormatTraits {
        FormatTraits {
            more_than_totals: true,
            sides: Sides::Both,
            gaps: true,
            wavelengths: true,
            ..FormatTraits::totals("exr_parts")
        }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        if exr_header::is_exr(bytes) { needed::image_table(bytes) } else { Ok(4 * bytes.len() as u64) }
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Ok((read(bytes)?.into(), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &Options) -> Checked<Encoded<'a>> {
        Ok(Encoded::bytes(write(table)?, CONVENTION, vec![]))
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, _options: &Options) -> Checked<Option<ReadBack>> {
        read_back(BlockReader::open(codec::open(path)?)?, table)
    }
}

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
    let mut planes = planes(table, 0)?;
    planes.retain(|name, _| !name.starts_with("left_map."));
    let parts: Vec<ImagePart> =
        (0..table.grid.incidences()).map(|incidence| part(table, incidence, &planes, &grid)).collect();
    let (width, height) = size(&table.grid);
    Ok(image_rows::encode(&parts, |(incidence, name, row), out| {
        let first = (incidence * height + row) * width;
        let mut bytes = Vec::with_capacity(out.len());
        planes[name].bytes(first..first + width, &mut bytes);
        out.copy_from_slice(&bytes);
    })?)
}

/// The header of a part: its channels have types only.
fn part(table: &BrdfTable, incidence: usize, planes: &BTreeMap<String, Plane>, grid: &str) -> ImagePart {
    let (width, height) = size(&table.grid);
    let (theta_i, phi_i) = table.grid.incidence_deg(incidence);
    let mut part = ImagePart { width, height, ..ImagePart::default() };
    part.name = Some(format!("stop{incidence:04}_thetaI{theta_i:05.1}_phiI{phi_i:05.1}"));
    part.channels = planes.iter().map(|(name, plane)| (name.clone(), plane.kind())).collect();
    for (name, value) in
        [(STOP, incidence as f64), ("gonio.theta_i_deg", theta_i), ("gonio.phi_i_deg", phi_i)]
    {
        part.attributes.insert(name.into(), image::Attribute::Number(value));
    }
    if incidence == 0 {
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
        let incidence = file.outlines()[part].number(STOP).unwrap_or(-1.0);
        if !(0.0..table.grid.incidences() as f64).contains(&incidence) || file.outlines()[part].width != width
        {
            return Err(wrong!("{STOP} = {incidence}, {} columns", file.outlines()[part].width));
        }
        for number in 0..file.count(part) {
            for (name, row, values) in file.read(part, number)?.lines() {
                let Some(colour) = names.iter().position(|colour| *colour == name) else { continue };
                for (column, value) in values.as_chunks::<4>().0.iter().enumerate() {
                    listing.add(incidence as usize, row * width + column, colour, f32::from_ne_bytes(*value));
                }
            }
        }
    }
    listing.finish()
}

/// The table in the bytes of a file.
// Tested by `exr_parts_come_back_bit_for_bit`, `damaged_parts_are_refused`.
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    let mut parts = image::decode(bytes)?;
    let number = |part: &ImagePart| {
        part.number(STOP).filter(|&incidence| incidence >= 0.0 && incidence.fract() == 0.0)
    };
    if let Some(part) = parts.iter().find(|part| number(part).is_none()) {
        return Err(wrong!(
            "part `{}` has no {STOP}: not written by this program",
            part.name.as_deref().unwrap_or("")
        ));
    }
    parts.sort_by(|a, b| number(a).unwrap_or(0.0).total_cmp(&number(b).unwrap_or(0.0)));
    let text = parts[0].text(GRID).ok_or_else(|| format!("the first part has no {GRID}"))?;
    let grid: Grid = serde_json::from_str(text).map_err(|e| format!("{GRID}: {e}"))?;
    let (incidences, _) = check_grid(&grid)?;
    let (width, height) = size(&grid);
    let fits = |(incidence, part): (usize, &ImagePart)| {
        number(part) == Some(incidence as f64) && (part.width, part.height) == (width, height)
    };
    if parts.len() != incidences || !parts.iter().enumerate().all(fits) {
        return Err(wrong!(
            "{} parts do not make {incidences} incidences of {width} x {height} bins",
            parts.len()
        ));
    }
    let [campaign, version, seed, patch_digest] =
        TEXTS.map(|name| parts[0].text(name).unwrap_or_default().to_string());
    let seed = seed.parse().map_err(|_| format!("gonio.seed = `{seed}` is no seed"))?;
    let (colours, hits, schlick) = (vec![], vec![], None);
    let empty = BrdfTable { grid, campaign, version, seed, patch_digest, colours, hits, schlick };
    store::of_channels(empty, joined(parts)?)
}

/// The parts, one after the other, as the rows of one.
fn joined(parts: Vec<ImagePart>) -> Checked<ImagePart> {
    let (width, height) = (parts[0].width * parts[0].height, parts.len());
    let mut parts = parts.into_iter().enumerate();
    let first = parts.next().map(|(_, part)| part.channels).unwrap_or_default();
    let mut whole = ImagePart { width, height, channels: first, ..ImagePart::default() };
    for (incidence, mut part) in parts {
        for (name, samples) in &mut whole.channels {
            match (samples, part.channels.remove(name)) {
                (Samples::F32(all), Some(Samples::F32(values))) => all.extend(values),
                (Samples::U32(all), Some(Samples::U32(values))) => all.extend(values),
                _ => return Err(wrong!("incidence {incidence}: channel `{name}` (FLOAT) is missing")),
            }
        }
    }
    Ok(whole)
}
