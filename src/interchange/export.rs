//! The way out: write a table in a format, read it back, say how far off it is and under which convention.

use std::path::Path;

use super::codec::{self, Codec, Encoded, FileContent, Fill};
use super::content::bands::RowBands;
use super::content::half_difference::as_arms;
use super::resample::gaps::not_measured;
use super::{AlbedoCurve, Format, Lookup, Options, ReadBack, albedo, luminance};
use crate::error::{Checked, ContentError, Error, Result};
use crate::files::{self, NewFile};
use crate::instrument::{Grid, GridKind};
use crate::table::{BrdfTable, TableRows};

/// A file that was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// How its values and angles are meant.
    pub convention: String,
    /// What was lost or chosen on the way, one sentence each.
    pub notes: Vec<String>,
    /// The file's own reader against the table's bins; `None` where the table holds nothing but zeros.
    pub read_back: Option<ReadBack>,
    /// Of a format of other directions than the table's, its albedo next to the table's, between the incidences too.
    pub albedo: Option<AlbedoCurve>,
}

/// Writes `table` to `path`, whole or not at all, and reads it back.
///
/// Errors: [`Error::Refused`] with the reason where the format cannot hold the table; [`Error::Io`].
///
/// ```no_run
/// use gonio::interchange::{Format, Options, export};
///
/// let table = gonio::table::store::load("out/quickstart/quickstart.exr".as_ref())?.table;
/// let written = export(&table, Format::Merl, &Options::default(), "quickstart.binary".as_ref())?;
/// println!("{}", written.convention);
/// # Ok::<(), gonio::error::Error>(())
/// ```
pub fn export(table: &BrdfTable, format: Format, options: &Options, path: &Path) -> Result<Export> {
    let (codec, refused) = (format.codec(), refusal(format, path));
    let holds = codec.traits();
    side_held(&table.grid, codec).map_err(&refused)?;
    if table.is_spectral() && !holds.wavelengths {
        let what =
            format!("{} wavelengths; npz, npy, csv, exr_parts, astm and ssdd hold them", table.colours.len());
        return Err(refused(format!("holds Y or R G B, the table has {what}").into()));
    }
    // Half/difference angles have cells below the horizon, which no format counts.
    if table.gaps() > 0 && table.grid.kind != GridKind::HalfDifference && !holds.gaps {
        return Err(refused(not_measured(table).into()));
    }
    if !holds.half_difference
        && let Some(arms) = as_arms(table, None).map_err(&refused)?
    {
        let mut export = export(&arms, format, options, path)?;
        let (stops, bins) = (arms.grid.stops(), arms.grid.bins());
        export.notes.push(format!(
            "half/difference angles as {stops} incidences of {bins} bins; the read-back is against those"
        ));
        return Ok(export);
    }
    if !holds.colours && table.colours.len() > 1 {
        let mut export = export(&luminance(table).map_err(&refused)?, format, options, path)?;
        export
            .notes
            .push("one channel: the luminance 0.2126 R + 0.7152 G + 0.0722 B; the colours are lost".into());
        return Ok(export);
    }
    let image = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let options = &Options { utia_image: image, ..options.clone() };
    let Encoded { content, convention, mut notes } = codec.encode(table, options).map_err(&refused)?;
    let mut albedo = None;
    if let (false, FileContent::Bytes(bytes)) = (holds.own_directions, &content) {
        albedo = albedo_of(table, codec, options, bytes).map_err(&refused)?;
        notes.extend(albedo.as_ref().and_then(AlbedoCurve::note));
    }
    write(content, path, &refused)?;
    let read_back = codec.read_back(path, table, options).map_err(|why| unread(path, why))?;
    Ok(Export { convention, notes, read_back, albedo })
}

/// The same of an open table of which no more than `bytes` are in memory at a time.
///
/// Errors: [`Error::Refused`] for formats that need the whole table; those of the table's file; [`Error::Io`].
// Tested by `a_table_exported_by_rows_is_the_file_of_the_whole` (tests/it/table/large_tables.rs).
pub fn export_rows(rows: &mut TableRows, format: Format, path: &Path, bytes: u64) -> Result<Export> {
    let (codec, refused) = (format.codec(), refusal(format, path));
    side_held(rows.grid(), codec).map_err(&refused)?;
    let by_bands = codec.by_bands().ok_or_else(|| refused("needs the whole table in memory".into()))?;
    let mut bands = RowBands::new(rows, bytes)?;
    write(FileContent::Stream(Box::new(|out| by_bands.write(&mut bands, out))), path, &refused)?;
    let read_back = codec::open(path).and_then(|file| by_bands.read_back(file, &mut bands));
    let read_back = read_back.map_err(|why| unread(path, why))?;
    Ok(Export { convention: by_bands.convention().into(), notes: vec![], read_back, albedo: None })
}

/// Refuses light that has gone through the surface where a format has no place for it.
fn side_held(grid: &Grid, codec: &dyn Codec) -> Checked<()> {
    if !grid.looks_below() || codec.traits().transmission {
        return Ok(());
    }
    Err("has no place here for light that has gone through the surface; npz, npy and csv hold it, and side = \
         \"reflection\" under [sensor.hemisphere] measures what comes back alone"
        .into())
}

/// What is not written in a format: refused, unless the system or another file is at fault.
fn refusal(format: Format, path: &Path) -> impl Fn(ContentError) -> Error {
    move |why| match why {
        ContentError::Io(_) | ContentError::Elsewhere(_) => Error::format(path, why),
        why => Error::Refused(format!("{}: {}: {why}", path.display(), format.name())),
    }
}

/// A file of this program that its own reader refuses is the program's fault.
fn unread(path: &Path, why: ContentError) -> Error {
    match why {
        ContentError::Wrong(why) => Error::Internal(format!("{} does not read back: {why}", path.display())),
        why => Error::format(path, why),
    }
}

/// Puts a file, or the files of a folder, in place.
fn write(content: FileContent, path: &Path, refused: impl Fn(ContentError) -> Error) -> Result<()> {
    let fill: Fill = match content {
        FileContent::Bytes(bytes) => return files::write_atomically(path, &bytes),
        FileContent::Folder(files) => {
            let _claim = files::create_folder(path)?;
            for (name, text) in files {
                files::write_atomically(&path.join(name), text.as_bytes())?;
            }
            return Ok(());
        }
        FileContent::Stream(fill) => fill,
    };
    let mut file = NewFile::create(path)?;
    fill(&mut file).map_err(refused)?;
    file.commit()
}

/// The albedo of what is about to be written. A file of another albedo is refused: see [`AlbedoCurve::check`].
fn albedo_of(
    table: &BrdfTable,
    codec: &dyn Codec,
    options: &Options,
    bytes: &[u8],
) -> Checked<Option<AlbedoCurve>> {
    // Half/difference cells and patches kept as they are have no incidences to look between.
    let Ok(lookup) = Lookup::new(table) else { return Ok(None) };
    let file = codec.decode(bytes, options)?.0.into_function()?;
    let curve =
        AlbedoCurve::of(&lookup, file.as_ref(), (codec.traits().reach_deg)(lookup.last_theta_i_deg()));
    if let Some(curve) = &curve {
        curve.check(options.albedo_error.unwrap_or(albedo::ALLOWED))?;
    }
    Ok(curve)
}
