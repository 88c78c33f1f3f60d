//! SSDD 0.2: an open text form of a 3-D or 4-D table over four lists of angles in degrees.
//!
//! `KEY value` lines, `PARAM0_LIST` .. `PARAM3_LIST`, `DATA ascii` or `binary`, then one colour a line, the first
//! angle fastest, the last slowest. Written are spherical coordinates (theta_i, phi_i, theta_o, phi_o); read are
//! these, angles about the mirror direction and half/difference angles. A block `btdf` is light that has gone through, as a
//! mirror in the horizon shows it. Source: the SSDD 0.2 specification, and `Btdf` (libbsdf's repository).

mod azimuths;
mod half_difference;
mod header;
mod lines;
mod specular;
mod spherical;
mod values;

use std::io::{BufRead, Write};
use std::path::Path;

use super::seam;
use crate::error::wrong;
use crate::interchange::codec::{self, Codec, Encoded, FormatTraits, Sides};
use crate::interchange::content::sides::put_together;
use crate::interchange::radiance::colour;
use crate::interchange::read_back::{Listing, ReadBack};
use crate::interchange::resample::angles::{bin_axes, incidence_axes};
use crate::interchange::{Checked, Imported, Options, needed};
use crate::sphere;
use crate::table::BrdfTable;
use crate::text_decoding::without_mark;
use header::{AngleKind, SsddHeader};
use lines::NumberLines;

/// How the values are meant.
const CONVENTION: &str = "spherical coordinates in degrees (theta_i, phi_i, theta_o, phi_o), phi_o = phi_i + 180 is the \
    mirror direction; BRDF in 1/sr, no cosine; the middle of each bin; light that has gone through as DATA_TYPE btdf, \
    theta_o from the normal on that side, azimuths those of the brdf";

/// The data types of light that comes back and that has gone through.
const KINDS: [&str; 2] = ["brdf", "btdf"];

/// The format.
pub struct Ssdd;

impl Codec for Ssdd {
    fn traits(&self) -> FormatTraits {
        FormatTraits { sides: Sides::Both, wavelengths: true, ..FormatTraits::totals("ssdd") }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        if is_binary(bytes) { Ok(12 * bytes.len() as u64) } else { needed::list(bytes) }
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        read_with_notes(bytes)
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &Options) -> Checked<Encoded<'a>> {
        Ok(Encoded::stream(CONVENTION, table, write))
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, _options: &Options) -> Checked<Option<ReadBack>> {
        read_back(codec::open(path)?, table)
    }
}

/// Whether a file goes on in binary: no line of a text has anything else behind this.
fn is_binary(bytes: &[u8]) -> bool {
    let begins = |line: &[u8]| {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.next() == Some(b"DATA") && words.next() == Some(b"binary")
    };
    bytes.split(|&byte| byte == b'\n').any(begins)
}

/// Writes the totals of a table whose incidences and bins are products of angles, a block for each of its sides. Azimuths
/// are put into [0, 360) in increasing order, as the format wants them; of an isotropic table the light has none.
pub fn write(table: &BrdfTable, out: &mut dyn Write) -> Checked<()> {
    writeln!(out, "VERSION 0.2")?;
    codec::halves(table).into_iter().try_for_each(|(through, half)| block(&half, through, out))
}

fn block(table: &BrdfTable, through: bool, out: &mut dyn Write) -> Checked<()> {
    let (grid, kind) = (&table.grid, KINDS[usize::from(through)]);
    if grid.phi_r_relative && !grid.is_isotropic() {
        return Err("phi_r counts from the light at several azimuths; SSDD has absolute ones".into());
    }
    let ((theta_i, phi_i), (theta_r, phi_r)) = (incidence_axes(grid)?, bin_axes(grid)?);
    if theta_r.iter().any(|&theta| theta < 0.0) {
        return Err("an arm with negative polar angles has no list of spherical angles".into());
    }
    let lists = [
        increasing(&theta_i, false),
        increasing(&phi_i, true),
        increasing(&theta_r, false),
        increasing(&phi_r, true),
    ];
    let nm: Vec<String> = table.wavelengths_nm().iter().map(f64::to_string).collect();
    let model = match table.colours.len() {
        _ if !nm.is_empty() => format!("spectrum\nWAVELENGTH_LIST {}", nm.join(" ")),
        1 => "monochrome".into(),
        _ => "rgb".into(),
    };
    writeln!(out, "DATA_TYPE {kind}\nCOLOR_MODEL {model}\nPARAM_TYPE spherical_coordinate_system")?;
    for (k, list) in lists.iter().enumerate().filter(|(k, _)| *k != 1 || !grid.is_isotropic()) {
        let list: Vec<String> = list.iter().map(|(angle, _)| angle.to_string()).collect();
        writeln!(out, "PARAM{k}_LIST {}", list.join(" "))?;
    }
    writeln!(out, "SOURCE_TYPE generated\nDATA ascii")?;
    let (bins, [theta_i, phi_i, theta_r, phi_r]) = (theta_r.len() * phi_r.len(), &lists);
    for (_, pr) in phi_r {
        for (_, tr) in theta_r {
            for (_, pi) in phi_i {
                for (_, ti) in theta_i {
                    let at = (ti * phi_i.len() + pi) * bins + tr * phi_r.len() + pr;
                    let values: Vec<String> = table.colours.iter().map(|c| c.total[at].to_string()).collect();
                    writeln!(out, "{}", values.join(" "))?;
                }
            }
        }
    }
    Ok(())
}

/// Angles in increasing order, azimuths in [0, 360), each with its place in the table.
fn increasing(angles: &[f64], azimuths: bool) -> Vec<(f64, usize)> {
    let written = |&angle: &f64| if azimuths { sphere::reduced_deg(angle) } else { angle };
    let mut list: Vec<(f64, usize)> = angles.iter().map(written).zip(0..).collect();
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    list
}

/// The table of a file that has incidences and directions, or half vectors and differences, of its own.
// Tested by `ssdd_comes_back`, `damaged_texts_are_refused`, tests/it/interchange/interchange_angles.rs.
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    match read_with_notes(bytes)?.0 {
        Imported::Table(table) => Ok(table),
        Imported::Function { .. } => {
            Err("the file's directions are no list of incidences and bins; give a grid with --like".into())
        }
    }
}

/// What a file holds, and notes on it; negative values become 0, X, Y, Z linear R, G, B.
///
/// In spherical coordinates it is a table of points: without `PARAM1_LIST` isotropic, azimuths a turn apart one where
/// their values agree. About the mirror direction it is a function. Half/difference angles are a table of them where
/// the values are reciprocal, and else a function.
// Tested by tests/it/interchange/interchange_ssdd.rs.
pub fn read_with_notes(bytes: &[u8]) -> Checked<(Imported, Vec<String>)> {
    let bytes = without_mark(bytes)?;
    let mut lines = NumberLines::of(&*bytes);
    let mut header = SsddHeader::read(&mut lines)?;
    let (mut blocks, mut notes) = ([None, None], vec![]);
    loop {
        let (values, more) = values::all(&mut lines, &header, bytes.len())?;
        let values = if header.xyz { to_rgb(values) } else { values };
        let (imported, said) = match header.parameters {
            AngleKind::Spherical => (seam::dropped(spherical::table(&header, values)?)?.into(), vec![]),
            AngleKind::Specular => specular::function(&header, &values)?,
            AngleKind::HalfDifference => half_difference::imported(&header, &values)?,
        };
        notes.extend(said);
        let through = usize::from(header.through);
        if blocks[through].replace(imported).is_some() {
            return Err(wrong!("two data blocks `{}`: one needed", KINDS[through]));
        }
        let Some(kind) = more else { break };
        let Some(through) = KINDS.iter().position(|known| *known == kind) else {
            notes.push(format!("a data block `{kind}` follows: it is not read, nor what follows it"));
            break;
        };
        header = SsddHeader::next(&mut lines, through == 1)?;
    }
    Ok((put_together(blocks)?, notes))
}

/// X, Y, Z as linear R, G, B.
fn to_rgb(mut total: Vec<Vec<f32>>) -> Vec<Vec<f32>> {
    if let [x, y, z] = &mut total[..] {
        for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
            [*x, *y, *z] = colour::rgb([*x, *y, *z].map(f64::from)).map(|value| value as f32);
        }
    }
    total
}

/// Compares a file of the table's own angles with the table, line by line, each value at its angles.
fn read_back(file: impl BufRead, table: &BrdfTable) -> Checked<Option<ReadBack>> {
    let mut lines = NumberLines::of(file);
    let mut header = SsddHeader::read(&mut lines)?;
    let mut listing = Listing::new(table);
    for below in [false, true] {
        let Some(half) = table.grid.half(below) else { continue };
        let grid = spherical::grid(&header)?;
        let sizes = (grid.incidences(), grid.bins(), header.colours);
        if header.through != below || sizes != (half.grid.incidences(), half.grid.bins(), table.colours.len())
        {
            return Err(wrong!("{} incidences of {} directions, {} colours", sizes.0, sizes.1, sizes.2));
        }
        let (incidences, bins) = seam::places(&grid, &half.grid)?;
        let more = values::each(&mut lines, &header, |incidence, bin, colour, value| {
            listing.add(incidences[incidence], half.bins[bins[bin]], colour, value)
        })?;
        if let Some(kind) = more {
            header = SsddHeader::next(&mut lines, kind == KINDS[1])?;
        }
    }
    listing.finish()
}
