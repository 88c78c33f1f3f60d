//! UTIA: 288 x 288 directions, three colours, anisotropic; `.bin`, f64 without a header, or an image.
//!
//! theta 0, 15, .. 75 and phi 0, 7.5, .. 352.5 degrees for light and sensor; index = colour x 288^2 + light x 288 +
//! sensor, of each (theta, phi) with phi fastest. The image form is an EXR of the same order, row = light. Azimuths are
//! absolute. Readers differ in how they take the values: here they are linear BRDF values. Layout: Filip and Vavra's
//! data description; of the image form no file was found, it follows from the order.

use rayon::prelude::*;

use super::codec::{Codec, Encoded, FormatTraits};
use super::foreign_table;
use super::resample::angles::{bin_axes, incidence_axes};
use super::{Brdf, Checked, Imported, Lookup, Options, needed};
use crate::error::wrong;
use crate::files::exr_header;
use crate::files::image::{self, ImagePart, Samples};
use crate::instrument::{Grid, GridKind};
use crate::sphere;
use crate::table::BrdfTable;

/// How the values are meant.
const CONVENTION: &str = "linear BRDF in 1/sr, no cosine (no sRGB curve, no factor: some readers expect one); f64, \
    [R, G, B][light][sensor], theta 0 to 75 by 15, phi 0 to 352.5 by 7.5 degrees, absolute azimuths, phi fastest; \
    values at directions, no aperture";

const DIRECTIONS: usize = 6 * 48;
/// Bytes of a file: 1,990,656.
pub const BYTES: usize = 3 * DIRECTIONS * DIRECTIONS * 8;

/// The format.
pub struct Utia;

impl Codec for Utia {
    fn traits(&self) -> FormatTraits {
        FormatTraits { reach_deg: |_last_deg| [75.0, 75.0], ..FormatTraits::resampled("utia") }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        if exr_header::is_exr(bytes) { needed::image_table(bytes) } else { Ok(4 * bytes.len() as u64) }
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Ok((read(bytes)?.into(), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, options: &Options) -> Checked<Encoded<'a>> {
        let write = if options.utia_image { write_image } else { write };
        let note = "resampled to a direction every 15 x 7.5 degrees: lobes narrower than that are not held";
        Ok(Encoded::bytes(write(table)?, CONVENTION, vec![note.into()]))
    }
}

fn axes() -> (Vec<f64>, Vec<f64>) {
    ((0..6).map(|k| 15.0 * f64::from(k)).collect(), (0..48).map(|k| 7.5 * f64::from(k)).collect())
}

fn directions() -> Vec<[f64; 2]> {
    let (theta, phi) = axes();
    theta.iter().flat_map(|&t| phi.iter().map(move |&p| [t, p])).collect()
}

/// Whether the table has the very directions of the format.
fn is_native(grid: &Grid) -> bool {
    let same = |found: Checked<(Vec<f64>, Vec<f64>)>| found.is_ok_and(|found| found == axes());
    let kinds = [GridKind::Points, GridKind::Arm];
    kinds.contains(&grid.kind) && !grid.phi_r_relative && same(incidence_axes(grid)) && same(bin_axes(grid))
}

/// The planes R, G, B of a file; a table of one colour has it in all three. Values of a table with the format's own
/// directions are kept exactly.
fn planes(table: &BrdfTable) -> Checked<[Vec<f64>; 3]> {
    let colours = table.colours.len();
    let planes: Vec<Vec<f64>> = if is_native(&table.grid) {
        table.colours.iter().map(|colour| colour.total.iter().map(|&v| f64::from(v)).collect()).collect()
    } else {
        let lookup = Lookup::new(table)?;
        let list: Vec<_> = directions().iter().map(|&[t, p]| sphere::direction_deg(t, p)).collect();
        let pair = |k: usize| lookup.brdf(list[k / DIRECTIONS], list[k % DIRECTIONS]);
        let values: Vec<_> = (0..DIRECTIONS * DIRECTIONS).into_par_iter().map(pair).collect();
        (0..colours).map(|c| values.iter().map(|value| value[c]).collect()).collect()
    };
    Ok(std::array::from_fn(|c| planes[c.min(colours - 1)].clone()))
}

/// The bytes of a `.bin` file.
pub fn write(table: &BrdfTable) -> Checked<Vec<u8>> {
    Ok(planes(table)?.iter().flatten().flat_map(|value| value.to_le_bytes()).collect())
}

/// The bytes of the image form: an EXR of 288 x 288 pixels, row = light, column = sensor, channels R, G, B.
pub fn write_image(table: &BrdfTable) -> Checked<Vec<u8>> {
    let mut part = ImagePart { width: DIRECTIONS, height: DIRECTIONS, ..ImagePart::default() };
    for (name, plane) in NAMES.iter().zip(planes(table)?) {
        part.channels.insert(name.to_string(), Samples::F32(plane.iter().map(|&v| v as f32).collect()));
    }
    part.set_text("gonio.convention", CONVENTION);
    Ok(image::encode(vec![part])?)
}

const NAMES: [&str; 3] = ["R", "G", "B"];

/// The table of points of a file, `.bin` or image. Negative values, which the database has where the light was too
/// weak, become 0.
// Tested by `utia_comes_back_exactly`, `the_image_form_of_utia_comes_back`, `damaged_utia_files_are_refused`.
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    if exr_header::is_exr(bytes) {
        return read_image(bytes);
    }
    if bytes.len() != BYTES {
        return Err(wrong!(
            "{} bytes, a UTIA file of 288 x 288 directions has {BYTES}; its image form is an EXR",
            bytes.len()
        ));
    }
    let values = bytes.as_chunks::<8>().0.iter().map(|chunk| f64::from_le_bytes(*chunk) as f32);
    let values: Vec<f32> = values.collect();
    of_planes(values.chunks(DIRECTIONS * DIRECTIONS).map(<[f32]>::to_vec).collect())
}

/// The image form, floats or halves.
fn read_image(bytes: &[u8]) -> Checked<BrdfTable> {
    let mut part = image::decode_one(bytes)?;
    if (part.width, part.height) != (DIRECTIONS, DIRECTIONS) {
        return Err(wrong!(
            "{} x {} pixels, 288 x 288 needed (row = light, column = sensor)",
            part.width,
            part.height
        ));
    }
    let plane = |name| part.take_floats(name).ok_or_else(|| format!("no channel `{name}` of floats"));
    of_planes(NAMES.map(plane).into_iter().collect::<Result<_, String>>()?)
}

fn of_planes(mut planes: Vec<Vec<f32>>) -> Checked<BrdfTable> {
    // NaN stays, to be refused with its place.
    planes.iter_mut().flatten().filter(|value| **value < 0.0).for_each(|value| *value = 0.0);
    let (theta_i_deg, phi_i_deg) = axes();
    let grid =
        Grid { kind: GridKind::Points, theta_i_deg, phi_i_deg, points_deg: directions(), ..Grid::default() };
    foreign_table(grid, planes)
}
