//! The way out: write a table in a format, read it back, say how far off it is and under which convention.

use std::path::Path;
use std::sync::Arc;

use super::codec::{self, Codec, Encoded, FileContent, Fill, FormatTraits, Sides};
use super::content::bands::RowBands;
use super::content::half_difference::as_arms;
use super::radiance::sample_side::SampleSide;
use super::resample::gaps::not_measured;
use super::{AlbedoCurve, COMES_BACK, Format, GONE_THROUGH, Lookup, Options, ReadBack, albedo, luminance};
use crate::error::{Checked, ContentError, Error, Result, wrong};
use crate::files::{self, Destination, FolderLook, NewFile};
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
    /// The same of the light that it lets through.
    pub transmittance: Option<AlbedoCurve>,
    /// The same three of the table under light from the back, where there is one.
    pub back: Option<BackSide>,
}

/// What a file is to the table under light from the back.
pub type BackSide = (Option<ReadBack>, Option<AlbedoCurve>, Option<AlbedoCurve>);

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
    export_to(table, format, options, &path.into())
}

/// The same to where nothing has come since the caller looked.
pub fn export_to(table: &BrdfTable, format: Format, options: &Options, path: &Destination) -> Result<Export> {
    let (codec, refused) = (format.codec(), refusal(format, path));
    let holds = codec.traits();
    let kept = |table: &BrdfTable| -> Checked<Option<BrdfTable>> {
        Ok(kept_side(&table.grid, codec, options)?.and_then(|below| table.side(below)))
    };
    let alone = kept(table).map_err(&refused)?;
    let table = alone.as_ref().unwrap_or(table);
    let mut options = options.clone();
    if let Some(back) = &options.back {
        if !holds.light_from_back {
            return Err(refused(
                "one table a file; klems and tensor_tree take one under light from the back besides".into(),
            ));
        }
        options.back = kept(back).map_err(&refused)?.map(Arc::new).or(options.back);
    }
    let options = &options;
    if table.is_spectral() && !holds.wavelengths {
        let mut names = names_of_those(|traits| traits.wavelengths);
        let last = names.pop().unwrap_or_default();
        let what = format!("{} wavelengths; {} and {last} hold them", table.colours.len(), names.join(", "));
        return Err(refused(format!("holds Y or R G B, the table has {what}").into()));
    }
    // Half/difference angles have cells below the horizon, which no format counts.
    if table.gaps() > 0 && table.grid.kind != GridKind::HalfDifference && !holds.gaps {
        return Err(refused(not_measured(table).into()));
    }
    if !holds.half_difference
        && let Some(arms) = as_arms(table, None).map_err(&refused)?
    {
        let mut export = export_to(&arms, format, options, path)?;
        let (incidences, bins) = (arms.grid.incidences(), arms.grid.bins());
        export.notes.push(format!(
            "half/difference angles as {incidences} incidences of {bins} bins; the read-back is against those"
        ));
        return Ok(export);
    }
    if !holds.colours && table.colours.len() > 1 {
        let mut export = export_to(&luminance(table).map_err(&refused)?, format, options, path)?;
        export
            .notes
            .push("one channel: the luminance 0.2126 R + 0.7152 G + 0.0722 B; the colours are lost".into());
        return Ok(export);
    }
    let image = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let options = &Options { utia_image: image, ..options.clone() };
    let Encoded { content, convention, mut notes } = codec.encode(table, options).map_err(&refused)?;
    let mut sides =
        vec![(table, Options { side: options.back.as_ref().map(|_| SampleSide::Back), ..options.clone() })];
    if let Some(back) = &options.back {
        sides.push((back.as_ref(), Options { side: Some(SampleSide::Front), ..options.clone() }));
    }
    let mut curves = vec![vec![]; sides.len()];
    if let (false, FileContent::Bytes(bytes)) = (holds.own_directions, &content) {
        for (curves, (table, options)) in curves.iter_mut().zip(&sides) {
            *curves = curves_of(table, codec, options, bytes).map_err(&refused)?;
            notes.extend(curves.iter().filter_map(AlbedoCurve::note));
        }
    }
    write(content, path, &refused)?;
    let check = |((table, options), curves): ((&BrdfTable, Options), Vec<AlbedoCurve>)| {
        let read_back = codec.read_back(path, table, &options).map_err(|why| unread(path, why))?;
        let of = |through| curves.iter().find(|curve| curve.through == through).cloned();
        Ok((read_back, of(false), of(true)))
    };
    let mut checks = sides.into_iter().zip(curves).map(check).collect::<Result<Vec<BackSide>>>()?.into_iter();
    let (read_back, albedo, transmittance) = checks.next().unwrap_or_default();
    Ok(Export { convention, notes, read_back, albedo, transmittance, back: checks.next() })
}

/// The same of an open table of which no more than `bytes` are in memory at a time.
///
/// Errors: [`Error::Refused`] for formats that need the whole table; those of the table's file; [`Error::Io`].
// Tested by `a_table_exported_by_rows_is_the_file_of_the_whole` (tests/it/table/large_tables.rs).
pub fn export_rows(rows: &mut TableRows, format: Format, path: &Destination, bytes: u64) -> Result<Export> {
    let (codec, refused) = (format.codec(), refusal(format, path));
    kept_side(rows.grid(), codec, &Options::default()).map_err(&refused)?;
    let by_bands = codec.by_bands().ok_or_else(|| refused("needs the whole table in memory".into()))?;
    let mut bands = RowBands::new(rows, bytes)?;
    write(FileContent::Stream(Box::new(|out| by_bands.write(&mut bands, out))), path, &refused)?;
    let read_back = codec::open(path).and_then(|file| by_bands.read_back(file, &mut bands));
    let read_back = read_back.map_err(|why| unread(path, why))?;
    let (convention, notes) = (by_bands.convention().into(), vec![]);
    Ok(Export { convention, notes, read_back, albedo: None, transmittance: None, back: None })
}

/// The side of a sensor that is written alone: light that has gone through (true), or that comes back; `None`: the whole
/// table. The one rule for all formats: what a file has no place for is left out where the user says so, and nowhere else.
// Tested by `what_a_format_cannot_hold_is_left_out_where_the_user_says_so` (tests/it/interchange/through.rs).
fn kept_side(grid: &Grid, codec: &dyn Codec, options: &Options) -> Checked<Option<bool>> {
    let (holds, both) = (codec.traits().sides, grid.looks_above() && grid.looks_below());
    match options.through {
        Some(through) => {
            let (looks, what) =
                if through { (grid.looks_below(), GONE_THROUGH) } else { (grid.looks_above(), COMES_BACK) };
            if !looks {
                return Err(wrong!("--side: the table holds no light that {what}"));
            }
            if through && holds == Sides::Reflection {
                return Err(no_place());
            }
            Ok(both.then_some(through))
        }
        None if both && holds == Sides::Reflection => {
            Err(wrong!("{}; --side reflection writes what comes back alone", no_place()))
        }
        None if both && holds == Sides::One => {
            Err("a file holds light that comes back or light that has gone through, the \
            table has both: --side reflection or --side transmission says which"
                .into())
        }
        None if grid.looks_below() && holds == Sides::Reflection => Err(no_place()),
        None => Ok(None),
    }
}

fn no_place() -> ContentError {
    let names = names_of_those(|traits| traits.sides != Sides::Reflection);
    wrong!("has no place for light that {GONE_THROUGH}; {} hold it", names.join(", "))
}

/// The formats that have what is looked for.
fn names_of_those(have: impl Fn(&FormatTraits) -> bool) -> Vec<&'static str> {
    Format::ALL.iter().filter(|format| have(&format.codec().traits())).map(|format| format.name()).collect()
}

/// What is not written in a format: refused, unless the system or another file is at fault.
fn refusal(format: Format, path: &Path) -> impl Fn(ContentError) -> Error {
    move |why| match why {
        ContentError::Io(_) | ContentError::Elsewhere(_) => Error::format(path, why),
        why => Error::Refused(format!("{}: {}: {why}", path.display(), format.name())),
    }
}

/// A file of this program that its own reader refuses is the program's fault, and does not stay.
fn unread(path: &Path, why: ContentError) -> Error {
    match why {
        ContentError::Wrong(why) => {
            files::remove(path).ok();
            Error::Internal(format!("{} does not read back: {why}", path.display()))
        }
        why => Error::format(path, why),
    }
}

/// Puts a file, or the files of a folder, in place.
fn write(content: FileContent, path: &Destination, refused: impl Fn(ContentError) -> Error) -> Result<()> {
    let fill: Fill = match content {
        FileContent::Bytes(bytes) => return files::write_atomically(path, &bytes),
        FileContent::Folder(files) => {
            let look = FolderLook::at(path, |_| true);
            let _claim = files::create_folder(path)?;
            for (name, text) in files {
                files::write_atomically(look.destination(&path.join(name)), text.as_bytes())?;
            }
            return Ok(());
        }
        FileContent::Stream(fill) => fill,
    };
    let mut file = NewFile::create(path)?;
    fill(&mut file).map_err(refused)?;
    file.commit()
}

/// The albedo of what is about to be written, and its transmittance. A file with others is refused: see
/// [`AlbedoCurve::check`].
fn curves_of(
    table: &BrdfTable,
    codec: &dyn Codec,
    options: &Options,
    bytes: &[u8],
) -> Checked<Vec<AlbedoCurve>> {
    let mut file = None;
    let mut curves = vec![];
    for (through, half) in codec::halves(table) {
        // Half/difference cells and patches kept as they are have no incidences to look between.
        let Ok(lookup) = Lookup::of_side(&half, through) else { continue };
        let file = match &mut file {
            Some(file) => file,
            empty => empty.insert(codec.decode(bytes, options)?.0.into_function()?),
        };
        let reach = (codec.traits().reach_deg)(lookup.last_theta_i_deg());
        curves.extend(AlbedoCurve::of(&lookup, file.as_ref(), through, reach));
    }
    AlbedoCurve::sum(&curves).map_or(Ok(()), |whole| whole.check_no_gain())?;
    let allowed = options.albedo_error.unwrap_or(albedo::ALLOWED);
    curves.iter().try_for_each(|curve| curve.check(allowed))?;
    Ok(curves)
}
