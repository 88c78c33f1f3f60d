//! The table's own file: one EXR image, row = incidence, column = sensor bin, lossless.
//!
//! Input: a [`BrdfTable`]. Output: the same bytes from every run, and the same table from the bytes.

use std::io::Cursor;
use std::path::Path;

use crate::error::{Checked, ContentError, Error, Result};
use crate::files::image::{self, ImagePart, Samples};
use crate::files::{Destination, NewFile};

use super::channels::{self, ColourName, MUELLER_ELEMENTS};
use super::content_digest::ContentDigest;
use super::header::{TableHeader, header, outline};
use super::{BrdfTable, ColourChannels, TableWriter};

/// A table from a file, and what its reader should know.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The table.
    pub table: BrdfTable,
    /// What is missing or odd, without being wrong.
    pub warnings: Vec<String>,
}

/// The bytes of the table's file.
///
/// NaN and infinite values are refused.
// Tested by `equal_tables_have_equal_bytes_whatever_the_hash_seed`.
pub fn encode(table: &BrdfTable) -> Result<Vec<u8>> {
    let mut writer = TableWriter::new(Cursor::new(Vec::new()), Path::new("memory"), table, &table.grid)?;
    writer.append(table)?;
    Ok(writer.finish()?.0.into_inner())
}

/// Writes the table's file, whole or not at all.
pub fn save(path: impl Into<Destination>, table: &BrdfTable) -> Result<()> {
    staged(path, table)?.commit()
}

/// The table's file, on the disk and not yet in its place.
pub fn staged(path: impl Into<Destination>, table: &BrdfTable) -> Result<NewFile> {
    let mut writer = TableWriter::create(path, table, &table.grid)?;
    writer.append(table)?;
    writer.finish()?.0.on_disk()
}

/// The digest that the table's file carries.
pub fn digest(table: &BrdfTable) -> Result<String> {
    let no = |why: ContentError| Error::Refused(format!("the table has no digest: {why}"));
    let mut content = ContentDigest::default();
    let planes = channels::planes(table, 0).map_err(no)?;
    let bins = table.grid.bins();
    let mut bytes = Vec::new();
    for (name, plane) in &planes {
        for incidence in 0..table.grid.incidences() {
            bytes.clear();
            plane.bytes(incidence * bins..(incidence + 1) * bins, &mut bytes);
            content.add(name, &plane.kind(), &bytes);
        }
    }
    Ok(content.finish(&outline(table, &table.grid, &planes).map_err(no)?))
}

/// Reads a table's file, block by block.
///
/// ```no_run
/// let table = gonio::table::store::load("out/quickstart/quickstart.exr".as_ref())?.table;
/// println!("{} incidences of {} bins", table.grid.incidences(), table.grid.bins());
/// # Ok::<(), gonio::error::Error>(())
/// ```
pub fn load(path: &Path) -> Result<Loaded> {
    from_parts(path, image::load(path)?)
}

/// The table in the bytes of a file; `path` is for messages only.
///
/// A wrong digest is an error, a missing one a warning.
// Tested by `damaged_tables_are_errors_and_never_panic`.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<Loaded> {
    from_parts(path, image::decode(bytes).map_err(|why| Error::format(path, why))?)
}

fn from_parts(path: &Path, parts: Vec<ImagePart>) -> Result<Loaded> {
    let count = parts.len();
    match <[ImagePart; 1]>::try_from(parts) {
        Ok([part]) => from_part(part).map_err(|why| Error::format(path, why)),
        Err(_) => Err(several(path, count)),
    }
}

/// The error of a file with more parts than a table has.
pub(super) fn several(path: &Path, parts: usize) -> Error {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let of_table = name.strip_suffix(".realisations.exr");
    let whose = of_table
        .map_or(String::new(), |stem| format!("; these are the realisations of {stem}.exr: name that"));
    Error::format(path, format!("a table has one part, this file has {parts}{whose}"))
}

fn from_part(mut part: ImagePart) -> Checked<Loaded> {
    let TableHeader { empty, mut warnings, .. } = header(&mut part)?;
    channels::check_digest(&part, &empty.patch_digest, &mut warnings)?;
    Ok(Loaded { table: of_channels(empty, part)?, warnings })
}

/// The table whose channels are those of `part`, a row each incidence; channels that are none of a table's are left
/// out.
pub(crate) fn of_channels(empty: BrdfTable, mut part: ImagePart) -> Checked<BrdfTable> {
    let names = channels::colour_names(&part)?;
    let incidences: Vec<usize> = (0..part.height).collect();
    filled(empty, &mut part, &names, (&incidences, incidences.len()))
}

/// The table with the channels of `part`, whose rows are those of some `incidences`, of so many in the file.
pub(super) fn filled(
    empty: BrdfTable,
    part: &mut ImagePart,
    names: &[ColourName],
    (incidences, of): (&[usize], usize),
) -> Checked<BrdfTable> {
    let first_incidence = incidences.first().copied().unwrap_or(0);
    let errors = channels::albedo_errors(part, names.len(), incidences, of)?;
    let mut colour = |(name, albedo_se)| {
        take_colour(part, name, first_incidence).map(|colour| ColourChannels { albedo_se, ..colour })
    };
    let colours = names.iter().zip(errors).map(&mut colour).collect::<Checked<_>>()?;
    let hits = match part.channels.remove("hits") {
        Some(Samples::U32(hits)) => hits,
        Some(_) => return Err("channel `hits` is not UINT".into()),
        None => return Err("channel `hits` is missing".into()),
    };
    let schlick = channels::take_schlick(part, first_incidence)?;
    Ok(BrdfTable { colours, hits, schlick, ..empty })
}

fn take_colour(
    part: &mut ImagePart,
    (name, wavelength_nm): &ColourName,
    first: usize,
) -> Checked<ColourChannels> {
    let mut orders = Vec::new();
    for order in 2.. {
        let channel = format!("order{order}.{name}");
        if !part.channels.contains_key(&channel) {
            break;
        }
        orders.push(channels::take(part, &channel, first)?);
    }
    let left_map = format!("left_map.{name}");
    let polarised = part.channels.contains_key(&format!("{}.{name}", MUELLER_ELEMENTS[0]));
    let mut elements = |layer: &str| {
        let channels =
            MUELLER_ELEMENTS.iter().filter(|_| polarised).map(|element| format!("{layer}{element}.{name}"));
        channels.map(|channel| channels::take(part, &channel, first)).collect::<Checked<_>>()
    };
    Ok(ColourChannels {
        mueller: elements("")?,
        stderr_mueller: elements("stderr.")?,
        left_map: match part.channels.contains_key(&left_map) {
            true => channels::take(part, &left_map, first)?,
            false => Vec::new(),
        },
        total: channels::take(part, name, first)?,
        single: channels::take(part, &format!("single.{name}"), first)?,
        multiple: channels::take(part, &format!("multiple.{name}"), first)?,
        stderr: channels::take(part, &format!("stderr.{name}"), first)?,
        stderr_single: channels::take(part, &format!("stderr.single.{name}"), first)?,
        orders,
        wavelength_nm: *wavelength_nm,
        ..ColourChannels::default()
    })
}

#[cfg(test)]
mod tests {
    use super::super::channels::DIGEST;
    use super::super::grid_attribute::{self, GRID};
    use super::super::header::{CAMPAIGN, CONVENTION, SEED, VERSION};
    use super::super::test_tables::{colour, table};
    use super::*;

    fn to_part(table: &BrdfTable) -> Checked<ImagePart> {
        image::decode(&encode(table)?).map(|mut parts| parts.remove(0))
    }

    fn reason(part: ImagePart) -> String {
        from_part(part).expect_err("must be refused").to_string()
    }

    #[test]
    fn nan_and_infinity_are_refused_before_writing() {
        for bad in [f32::NAN, f32::INFINITY] {
            let mut table = table(3);
            table.colours[1].stderr[7] = bad;
            let message = encode(&table).expect_err("must be refused").to_string();
            assert!(message.contains("`stderr.G`, incidence 1, bin 1"), "{message}");
        }
    }

    #[test]
    fn channels_that_do_not_fit_the_grid_are_refused() {
        let mut table = table(1);
        table.hits.pop();
        assert!(encode(&table).expect_err("must be refused").to_string().contains("`hits`"));
        table.hits.push(0);
        table.colours.push(colour(1.0, 12));
        assert!(encode(&table).expect_err("must be refused").to_string().contains("2 colours"));
    }

    #[test]
    fn a_missing_half_or_uint_channel_is_named() {
        let part = || {
            let mut part = to_part(&table(1)).expect("sound");
            part.attributes.remove(DIGEST);
            part
        };
        let mut missing = part();
        missing.channels.remove("single.Y");
        assert_eq!(reason(missing), "channel `single.Y` is missing");
        let mut half = part();
        half.channels.insert("stderr.Y".into(), Samples::F16(vec![Default::default(); 12]));
        assert_eq!(reason(half), "channel `stderr.Y` is HALF, FLOAT needed");
        let mut hits = part();
        hits.channels.insert("hits".into(), Samples::F32(vec![0.0; 12]));
        assert_eq!(reason(hits), "channel `hits` is not UINT");
        let mut nan = part();
        nan.channels.insert("Y".into(), Samples::F32(vec![f32::NAN; 12]));
        assert!(reason(nan).contains("channel `Y`, incidence 0, bin 0"));
        for name in ["Y", "single.Y", "multiple.Y", "stderr.Y", "stderr.single.Y"] {
            let mut negative = part();
            let mut values = vec![0.0; 12];
            values[7] = -0.5;
            negative.channels.insert(name.into(), Samples::F32(values));
            assert_eq!(reason(negative), format!("channel `{name}`, incidence 1, bin 1: -0.5 is below 0"));
        }
    }

    #[test]
    fn a_grid_of_another_size_is_an_error() {
        let mut part = to_part(&table(1)).expect("sound");
        let mut grid = table(1).grid;
        grid.theta_i_deg.push(80.0);
        part.set_text(GRID, &grid_attribute::grid_text(&grid).expect("prints"));
        assert!(reason(part).contains("3 incidences and 6 bins, the image is 6 wide and 2 high"));
    }

    #[test]
    fn what_is_missing_is_said_and_what_is_unknown_is_left_out() {
        let mut part = to_part(&table(1)).expect("sound");
        part.attributes.retain(|name, _| name == GRID);
        part.channels.insert("depth".into(), Samples::F32(vec![0.0; 12]));
        let loaded = from_part(part).expect("readable");
        let all = loaded.warnings.join("\n");
        for word in [DIGEST, SEED, VERSION, CAMPAIGN, CONVENTION, "`depth`"] {
            assert!(all.contains(word), "{word} is not in: {all}");
        }
        assert_eq!(loaded.table.colours, table(1).colours);
    }
}
