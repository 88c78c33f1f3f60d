//! The way out: write a table in a format, read it back, say how far off it is and under which convention.

use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::Path;

use super::format::{Format, Options};
use super::half_difference::{HalfDifference, as_arms};
use super::import::{Imported, decode};
use super::mitsuba::rgl;
use super::numpy::{npy, npz};
use super::radiance::{klems, tensor_tree};
use super::text::{astm, csv, pabopto, ssdd, zemax};
use super::{
    AlbedoCurve, Brdf, Fail, Lookup, ReadBack, Reason, albedo, exr_parts, luminance, merl, not_measured,
    read_back, utia,
};
use crate::error::{Error, Result};
use crate::files;
use crate::instrument::GridKind;
use crate::table::BrdfTable;

/// A file that was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// How its values and angles are meant.
    pub convention: String,
    /// What was lost or chosen on the way, one sentence each.
    pub notes: Vec<String>,
    /// The file's own reader against the table's bins; `None` where the table holds nothing but zeros.
    pub read_back: Option<ReadBack>,
    /// Of a format of other directions than the table's, its albedo beside the table's, between the stops too.
    pub albedo: Option<AlbedoCurve>,
}

/// Writes a format's bytes.
pub type Fill<'a> = Box<dyn FnOnce(&mut dyn Write) -> std::result::Result<(), Fail> + 'a>;

/// A format's bytes, and what is to be said of them.
pub struct Exported<'a> {
    /// Writes them.
    pub fill: Fill<'a>,
    /// As [`Export::convention`].
    pub convention: String,
    /// As [`Export::notes`].
    pub notes: Vec<String>,
}

/// Writes `table` to `path`, whole or not at all, and reads it back.
///
/// Errors: [`Error::Refused`] with the reason where the format cannot hold the table; [`Error::Io`].
pub fn export(table: &BrdfTable, format: Format, options: &Options, path: &Path) -> Result<Export> {
    let refused = |why: String| Error::Refused(format!("{}: {}: {why}", path.display(), format.name()));
    if table.is_spectral() && !format.holds_wavelengths() {
        let count = table.colours.len();
        return Err(refused(format!(
            "holds Y or R G B, the table has {count} wavelengths; npz, npy, csv, exr_parts, astm and ssdd hold them"
        )));
    }
    // Half/difference angles have cells below the horizon, which no format counts.
    if table.gaps() > 0 && table.grid.kind != GridKind::HalfDifference && !format.holds_gaps() {
        return Err(refused(not_measured(table)));
    }
    if !format.holds_half_difference()
        && let Some(arms) = as_arms(table, None).map_err(refused)?
    {
        let mut export = export(&arms, format, options, path)?;
        export.notes.push(format!(
            "half/difference angles as {} stops of {} bins; the read-back is against those",
            arms.grid.stops(),
            arms.grid.bins()
        ));
        return Ok(export);
    }
    if format.has_one_channel() && table.colours.len() > 1 {
        let luminance = luminance(table).map_err(refused)?;
        let mut export = export(&luminance, format, options, path)?;
        export
            .notes
            .push("one channel: the luminance 0.2126 R + 0.7152 G + 0.0722 B; the colours are lost".into());
        return Ok(export);
    }
    if format == Format::Pabopto {
        return export_folder(table, path);
    }
    let image = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let options = &Options { utia_image: image, ..options.clone() };
    let mut exported = prepare(table, format, options).map_err(refused)?;
    let albedo = if format.is_resampled() {
        let (curve, whole) = albedo_of(table, format, options, exported).map_err(refused)?;
        exported = whole;
        curve
    } else {
        None
    };
    let Exported { fill, convention, notes } = exported;
    let mut reason = None;
    let written = files::write_atomically_with(path, |out| {
        fill(out).map_err(|fail| match fail {
            Fail::Io(error) => error,
            Fail::Refused(why) => {
                reason = Some(why);
                io::Error::other("refused")
            }
        })
    });
    if let Some(why) = reason {
        return Err(refused(why));
    }
    written?;
    let read_back = back(table, format, options, path)?;
    Ok(Export { convention, notes, read_back, albedo })
}

/// The albedo of what is about to be written, and the same bytes. A file of another albedo is refused: see [`AlbedoCurve::check`].
fn albedo_of<'a>(
    table: &BrdfTable,
    format: Format,
    options: &Options,
    Exported { fill, convention, mut notes }: Exported<'a>,
) -> Reason<(Option<AlbedoCurve>, Exported<'a>)> {
    let mut bytes = Vec::new();
    fill(&mut bytes).map_err(|fail| match fail {
        Fail::Refused(why) => why,
        Fail::Io(error) => error.to_string(),
    })?;
    // Half/difference cells and patches kept as they are have no incidences to look between.
    let curve = match Lookup::new(table) {
        Ok(lookup) => {
            let file = function(format, decode(format, options, &bytes)?)?;
            AlbedoCurve::of(&lookup, file.as_ref(), format)
        }
        Err(_) => None,
    };
    if let Some(curve) = &curve {
        curve.check(options.albedo_error.unwrap_or(albedo::ALLOWED))?;
        notes.extend(curve.note());
    }
    Ok((curve, held(bytes, &convention, notes)))
}

/// A file as its own reader sees it.
fn function(format: Format, file: Imported) -> Reason<Box<dyn Brdf>> {
    Ok(match file {
        Imported::Function(brdf, _) => brdf,
        Imported::Spectrum { .. } => return Err("the file has wavelengths".into()),
        Imported::Table(found) if format == Format::Klems => Box::new(klems::Patchwise::new(found)?),
        Imported::Table(found) if found.grid.kind == GridKind::HalfDifference => {
            Box::new(HalfDifference::new(&found)?)
        }
        Imported::Table(found) => Box::new(Lookup::new(&found)?),
    })
}

fn prepare<'a>(table: &'a BrdfTable, format: Format, options: &'a Options) -> Reason<Exported<'a>> {
    let listed =
        |convention: &str, write: fn(&BrdfTable, &mut dyn Write) -> std::result::Result<(), Fail>| Exported {
            fill: Box::new(move |out: &mut dyn Write| write(table, out)),
            convention: convention.into(),
            notes: vec![],
        };
    Ok(match format {
        Format::Npz => listed(npz::CONVENTION, npz::write),
        Format::Npy => listed(npy::CONVENTION, npy::write),
        Format::Csv => listed(csv::CONVENTION, csv::write),
        Format::Merl => merl_file(table, options)?,
        Format::Rgl => {
            let lookup = Lookup::new(table)?;
            let nm = wavelengths(table, options)?;
            let bytes = rgl::write(&lookup, nm, &description(table))?;
            held(bytes, rgl::CONVENTION, resampling_notes(&lookup))
        }
        Format::Utia => {
            let write = if options.utia_image { utia::write_image } else { utia::write };
            held(write(table)?, utia::CONVENTION, coarse("a direction every 15 x 7.5 degrees"))
        }
        Format::ExrParts => held(exr_parts::write(table)?, exr_parts::CONVENTION, vec![]),
        Format::Klems => {
            let (text, notes) = klems::write(table, options.klems)?;
            held(text.into_bytes(), klems::CONVENTION, notes)
        }
        Format::TensorTree => {
            let lookup = Lookup::new(table)?;
            let text = tensor_tree::write(&lookup);
            held(text.into_bytes(), tensor_tree::CONVENTION, resampling_notes(&lookup))
        }
        Format::Zemax => {
            let lookup = Lookup::new(table)?;
            let (text, notes) = zemax::write(table, &lookup)?;
            held(text.into_bytes(), zemax::CONVENTION, [resampling_notes(&lookup), notes].concat())
        }
        Format::Astm => listed(astm::CONVENTION, astm::write),
        Format::Ssdd => listed(ssdd::CONVENTION, ssdd::write),
        Format::Pabopto => return Err("a folder, not a file".into()),
    })
}

fn merl_file<'a>(table: &BrdfTable, options: &Options) -> Reason<Exported<'a>> {
    let sampling = options.merl_sampling;
    let note = "the arms of a pair are one cell: a cell is the mean of f(wi, wo) and f(wo, wi)".to_string();
    if table.grid == merl::grid(sampling) {
        let notes = vec!["the table's own cells, as they are".into()];
        return Ok(held(merl::write_cells(table), &sampling.convention(), notes));
    }
    if table.grid.kind == GridKind::HalfDifference {
        if table.grid.phi_h_deg.len() > 1 {
            return Err("the table is anisotropic, and MERL files have no azimuth of the half vector".into());
        }
        let bytes = merl::write(&HalfDifference::new(table)?, sampling);
        let notes = vec![note, "resampled: linear between the table's half/difference angles".into()];
        return Ok(held(bytes, &sampling.convention(), notes));
    }
    merl::check(&table.grid)?;
    let lookup = Lookup::new(table)?;
    let bytes = merl::write(&lookup, sampling);
    Ok(held(bytes, &sampling.convention(), [vec![note], resampling_notes(&lookup)].concat()))
}

/// One file a stop in the folder at `path`.
fn export_folder(table: &BrdfTable, path: &Path) -> Result<Export> {
    let _claim = files::create_folder(path)?;
    let mut totals = Vec::with_capacity(table.colours[0].total.len());
    for stop in 0..table.grid.stops() {
        let file = path.join(format!("stop_{stop:04}.txt"));
        let text = pabopto::write(table, stop).map_err(Error::Internal)?;
        files::write_atomically(&file, text.as_bytes())?;
        let (_, values) = pabopto::read(&files::read(&file)?).map_err(|why| Error::format(&file, why))?;
        let (bins, mut values) = (table.grid.bins(), values.into_iter());
        let measured = |bin: usize| !table.is_gap(stop * bins + bin);
        totals.extend((0..bins).filter_map(|bin| if measured(bin) { values.next() } else { Some(0.0) }));
    }
    let read_back = read_back::listed(table, &[totals]).map_err(Error::Internal)?;
    Ok(Export { convention: pabopto::CONVENTION.into(), notes: vec![], read_back, albedo: None })
}

fn coarse(what: &str) -> Vec<String> {
    vec![format!("resampled to {what}: lobes narrower than that are not held")]
}

/// A file whose bytes are there already.
fn held<'a>(bytes: Vec<u8>, convention: &str, notes: Vec<String>) -> Exported<'a> {
    let fill = Box::new(move |out: &mut dyn Write| Ok(out.write_all(&bytes)?));
    Exported { fill, convention: convention.into(), notes }
}

/// What every format of other directions than the table's loses.
fn resampling_notes(lookup: &Lookup) -> Vec<String> {
    let last = lookup.theta_i()[lookup.theta_i().len() - 1].to_degrees();
    let mut notes = vec![
        "resampled: cubic between bins, at equal half vector between stops, with the table's albedo; error bars are not \
         held"
            .into(),
    ];
    if last < 80.0 {
        notes.push(format!("the stops end at {last:.4} degrees: beyond, the last stop's ratio to a guiding law at equal half vector"));
    }
    notes
}

fn wavelengths<'a>(table: &BrdfTable, options: &'a Options) -> Reason<Option<&'a [f64]>> {
    let nm = options.wavelengths_nm.as_slice();
    if nm.is_empty() {
        return Ok(None);
    }
    let colours = table.colours.len();
    if colours > 1 && nm.len() != colours {
        return Err(format!("{} wavelengths for {colours} colours: one for each needed", nm.len()));
    }
    if nm.len() < 2
        || nm.windows(2).any(|pair| pair[0] >= pair[1])
        || !nm.iter().all(|nm| (100.0..=1e6).contains(nm))
    {
        return Err(
            "at least two increasing wavelengths in nm needed; of R, G, B they are those of B, G, R".into()
        );
    }
    Ok(Some(nm))
}

/// Program, campaign and digest, for formats with room for a text.
fn description(table: &BrdfTable) -> String {
    format!(
        "gonio {}, seed {}, patches {}\n{}",
        table.version, table.seed, table.patch_digest, table.campaign
    )
}

/// Reads what was just written, and holds it to the table. Formats that list the table's own bins are read line by
/// line: neither the file nor a second table is held.
fn back(table: &BrdfTable, format: Format, options: &Options, path: &Path) -> Result<Option<ReadBack>> {
    let internal = |why: String| Error::Internal(format!("{} does not read back: {why}", path.display()));
    let open = || File::open(path).map(BufReader::new).map_err(|e| Error::io(path, e));
    let listed = match format {
        Format::Npz => {
            let length = std::fs::metadata(path).map_err(|e| Error::io(path, e))?.len();
            Some(npz::read_back(open()?, length, table))
        }
        Format::Npy => {
            let totals = npy::read_back(&files::read(path)?, table);
            Some(totals.and_then(|totals| read_back::listed(table, &totals)))
        }
        Format::Csv => Some(csv::read_back(open()?, table)),
        Format::Astm => Some(astm::read_back(open()?, table)),
        Format::Ssdd => Some(ssdd::read_back(open()?, table)),
        Format::ExrParts => Some(exr_parts::read_back(open()?, table)),
        _ => None,
    };
    if let Some(listed) = listed {
        return listed.map_err(internal);
    }
    let file = decode(format, options, &files::read(path)?).map_err(internal)?;
    let mut arms = None;
    if let Imported::Table(found) = &file
        && found.grid.kind == GridKind::HalfDifference
    {
        if found.grid == table.grid {
            let totals: Vec<Vec<f32>> = found.colours.iter().map(|colour| colour.total.clone()).collect();
            return read_back::listed(table, &totals).map_err(internal);
        }
        arms = as_arms(table, None).map_err(internal)?;
    }
    let brdf = function(format, file).map_err(internal)?;
    Ok(read_back::read_back(arms.as_ref().unwrap_or(table), brdf.as_ref()))
}
