//! Which formats there are, and the one way out and in: write, read back, say how far off and under which convention.

use std::io::{self, Write};
use std::path::Path;
use std::str::FromStr;

use super::merl::{self, Sampling};
use super::resample::default_grid;
use super::{
    Brdf, Fail, Lookup, ReadBack, Reason, astm, csv, exr_parts, klems, luminance, npy, npz, pabopto,
    read_back, resample, rgl, ssdd, tensor_tree, utia, zemax,
};
use crate::error::{Error, Result};
use crate::files;
use crate::instrument::Grid;
use crate::table::BrdfTable;

/// The largest file that is read, bytes.
pub const LARGEST_FILE: u64 = 4 << 30;

/// The formats that other programs read or write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Every array for NumPy.
    Npz,
    /// The totals for NumPy.
    Npy,
    /// One line a bin.
    Csv,
    /// Half/difference cells, isotropic.
    Merl,
    /// Mitsuba's `measured`.
    Rgl,
    /// 288 x 288 directions.
    Utia,
    /// One EXR part a stop.
    ExrParts,
    /// Radiance's matrix.
    Klems,
    /// Radiance's tensor tree.
    TensorTree,
    /// Zemax's table about the mirror direction.
    Zemax,
    /// ASTM E1392/E2387 text.
    Astm,
    /// SSDD text.
    Ssdd,
    /// pab-opto text, a folder of files.
    Pabopto,
}

/// What a user may choose about a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Where in a MERL cell its value lies.
    pub merl_sampling: Sampling,
    /// RGL files with wavelengths instead of rgb: one for each colour of the table, nm. Empty for rgb.
    pub wavelengths_nm: Vec<f64>,
}

/// A file that was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// How its values and angles are meant.
    pub convention: String,
    /// What was lost or chosen on the way, one sentence each.
    pub notes: Vec<String>,
    /// The file's own reader against the table's bins; `None` where the table holds nothing but zeros.
    pub read_back: Option<ReadBack>,
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

/// What a foreign file holds.
pub enum Imported {
    /// Stops and bins of its own.
    Table(BrdfTable),
    /// A function of two directions, and a grid that suits it.
    Function(Box<dyn Brdf>, Grid),
}

impl Format {
    /// All, by name.
    pub const ALL: [(&'static str, Format); 13] = [
        ("npz", Format::Npz),
        ("npy", Format::Npy),
        ("csv", Format::Csv),
        ("merl", Format::Merl),
        ("rgl", Format::Rgl),
        ("utia", Format::Utia),
        ("exr_parts", Format::ExrParts),
        ("klems", Format::Klems),
        ("tensor_tree", Format::TensorTree),
        ("zemax", Format::Zemax),
        ("astm", Format::Astm),
        ("ssdd", Format::Ssdd),
        ("pabopto", Format::Pabopto),
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, format)| *format == self).map_or("", |(name, _)| name)
    }

    /// Whether the file has one channel: the luminance of a table of three colours.
    fn has_one_channel(self) -> bool {
        matches!(self, Format::Klems | Format::TensorTree | Format::Zemax | Format::Pabopto)
    }

    /// Whether the file can hold more colours than R, G and B.
    fn holds_wavelengths(self) -> bool {
        matches!(self, Format::Npz | Format::Npy)
    }

    /// Whether the file lists the table's own bins in their order.
    fn lists_bins(self) -> bool {
        matches!(
            self,
            Format::Npz | Format::Npy | Format::Csv | Format::ExrParts | Format::Astm | Format::Pabopto
        )
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(name: &str) -> Reason<Self> {
        let known = Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, format)| *format);
        known.ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.iter().map(|(name, _)| *name).collect();
            format!("known formats are {}", names.join(", "))
        })
    }
}

/// Writes `table` to `path`, whole or not at all, and reads it back.
///
/// Errors: [`Error::Refused`] with the reason where the format cannot hold the table; [`Error::Io`].
pub fn export(table: &BrdfTable, format: Format, options: &Options, path: &Path) -> Result<Export> {
    let refused = |why: String| Error::Refused(format!("{}: {}: {why}", path.display(), format.name()));
    if table.is_spectral() && !format.holds_wavelengths() {
        let count = table.colours.len();
        return Err(refused(format!(
            "holds Y or R G B, the table has {count} wavelengths; npz and npy hold them"
        )));
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
    let Exported { fill, convention, notes } = prepare(table, format, options).map_err(refused)?;
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
    Ok(Export { convention, notes, read_back })
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
        Format::Merl => {
            merl::check(&table.grid)?;
            let lookup = Lookup::new(table)?;
            let bytes = merl::write(&lookup, options.merl_sampling);
            let note = "the arms of a pair are one cell: a cell is the mean of f(wi, wo) and f(wo, wi)";
            let notes = [vec![note.into()], resampling_notes(&lookup)].concat();
            held(bytes, &options.merl_sampling.convention(), notes)
        }
        Format::Rgl => {
            let lookup = Lookup::new(table)?;
            let nm = wavelengths(table, options)?;
            let bytes = rgl::write(&lookup, nm, &description(table))?;
            held(bytes, rgl::CONVENTION, resampling_notes(&lookup))
        }
        Format::Utia => {
            held(utia::write(table)?, utia::CONVENTION, coarse("a direction every 15 x 7.5 degrees"))
        }
        Format::ExrParts => held(exr_parts::write(table)?, exr_parts::CONVENTION, vec![]),
        Format::Klems => held(
            klems::write(table)?.into_bytes(),
            klems::CONVENTION,
            coarse("145 patches of 10 to 20 degrees"),
        ),
        Format::TensorTree => {
            let lookup = Lookup::new(table)?;
            let text = tensor_tree::write(&lookup);
            held(text.into_bytes(), tensor_tree::CONVENTION, resampling_notes(&lookup))
        }
        Format::Zemax => {
            let lookup = Lookup::new(table)?;
            let text = zemax::write(&lookup)?;
            held(text.into_bytes(), zemax::CONVENTION, resampling_notes(&lookup))
        }
        Format::Astm => listed(astm::CONVENTION, astm::write),
        Format::Ssdd => listed(ssdd::CONVENTION, ssdd::write),
        Format::Pabopto => return Err("a folder, not a file".into()),
    })
}

/// One file a stop in the folder at `path`.
fn export_folder(table: &BrdfTable, path: &Path) -> Result<Export> {
    files::create_folder(path)?;
    let mut totals = Vec::with_capacity(table.colours[0].total.len());
    for stop in 0..table.grid.stops() {
        let file = path.join(format!("stop_{stop:04}.txt"));
        let text = pabopto::write(table, stop).map_err(Error::Internal)?;
        files::write_atomically(&file, text.as_bytes())?;
        let (_, values) = pabopto::read(&files::read(&file)?).map_err(|why| Error::format(&file, why))?;
        totals.extend(values);
    }
    let read_back = read_back::listed(table, &[totals]);
    Ok(Export { convention: pabopto::CONVENTION.into(), notes: vec![], read_back })
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
        "resampled: cubic between bins, at equal half vector between stops; error bars are not held".into(),
    ];
    if last < 80.0 {
        notes.push(format!("the stops end at {last:.4} degrees: beyond, the last stop at equal half vector"));
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

/// Reads what was just written, and holds it to the table.
fn back(table: &BrdfTable, format: Format, options: &Options, path: &Path) -> Result<Option<ReadBack>> {
    let internal = |why: String| Error::Internal(format!("{} does not read back: {why}", path.display()));
    let bytes = files::read(path)?;
    if format == Format::Npy {
        return Ok(read_back::listed(table, &npy::read_back(&bytes, table).map_err(internal)?));
    }
    match decode(format, options, &bytes).map_err(internal)? {
        Imported::Table(found) if format == Format::Klems => {
            let brdf = klems::Patchwise::new(found).map_err(internal)?;
            Ok(read_back::read_back(table, &brdf))
        }
        Imported::Table(found) if format.lists_bins() => {
            let totals: Vec<Vec<f32>> = found.colours.into_iter().map(|colour| colour.total).collect();
            Ok(read_back::listed(table, &totals))
        }
        Imported::Table(found) => {
            let brdf = super::Lookup::new(&found).map_err(internal)?;
            Ok(read_back::read_back(table, &brdf))
        }
        Imported::Function(brdf, _) => Ok(read_back::read_back(table, brdf.as_ref())),
    }
}

/// What the bytes of a file hold; memory is bounded by their number.
pub fn decode(format: Format, options: &Options, bytes: &[u8]) -> Reason<Imported> {
    match format {
        Format::Npz => npz::read(bytes).map(Imported::Table),
        Format::Npy => Err("an array without axes is no table; save it as npz with axes".into()),
        Format::Csv => csv::read(bytes).map(Imported::Table),
        Format::Merl => {
            let merl = merl::read(bytes, options.merl_sampling)?;
            let theta_i_deg = (0..18).map(|k| 5.0 * f64::from(k)).collect();
            Ok(Imported::Function(Box::new(merl), default_grid(theta_i_deg, vec![])))
        }
        Format::Rgl => {
            let rgl = rgl::read(bytes)?;
            let grid = default_grid(rgl.theta_i_deg(), rgl.phi_i_deg());
            Ok(Imported::Function(Box::new(rgl), grid))
        }
        Format::Utia => utia::read(bytes).map(Imported::Table),
        Format::ExrParts => exr_parts::read(bytes).map(Imported::Table),
        Format::Klems => klems::read(bytes).map(Imported::Table),
        Format::TensorTree => {
            let tree = tensor_tree::read(bytes)?;
            let azimuths =
                if tree.is_isotropic() { vec![] } else { (0..24).map(|k| 15.0 * f64::from(k)).collect() };
            let theta_i_deg = (0..6).map(|k| 15.0 * f64::from(k)).collect();
            Ok(Imported::Function(Box::new(tree), default_grid(theta_i_deg, azimuths)))
        }
        Format::Zemax => {
            let zemax = zemax::read(bytes)?;
            let grid = default_grid(zemax.theta_i_deg(), vec![]);
            Ok(Imported::Function(Box::new(zemax), grid))
        }
        Format::Astm => astm::read(bytes).map(Imported::Table),
        Format::Ssdd => ssdd::read(bytes).map(Imported::Table),
        Format::Pabopto => {
            Err("a file has one stop; read its folder with pabopto2bsdf, or export as ssdd".into())
        }
    }
}

/// The table in a foreign file, on the geometry of `like` where that is given and the file is a function.
///
/// Returns it with one sentence for each thing that was chosen. Errors: [`Error::Format`], [`Error::Io`].
pub fn import(
    path: &Path,
    format: Format,
    options: &Options,
    like: Option<&Grid>,
) -> Result<(BrdfTable, Vec<String>)> {
    let wrong = |why: String| Error::format(path, format!("{}: {why}", format.name()));
    let length = std::fs::metadata(path).map_err(|e| Error::io(path, e))?.len();
    if length > LARGEST_FILE {
        return Err(wrong(format!("{length} bytes; at most {LARGEST_FILE} are read")));
    }
    let bytes = files::read(path)?;
    match decode(format, options, &bytes).map_err(wrong)? {
        Imported::Table(table) if like.is_none() => Ok((table, vec![])),
        Imported::Table(table) => {
            let brdf = super::Lookup::new(&table).map_err(wrong)?;
            let notes = vec!["resampled by cubic interpolation at equal half vector".into()];
            Ok((resample(&brdf, like.unwrap_or(&table.grid)).map_err(wrong)?, notes))
        }
        Imported::Function(brdf, grid) => {
            let grid = like.unwrap_or(&grid);
            let table = resample(brdf.as_ref(), grid).map_err(wrong)?;
            let notes = vec![format!(
                "resampled: means over {} stops of {} bins, 16 directions a bin",
                grid.stops(),
                grid.bins()
            )];
            Ok((table, notes))
        }
    }
}
