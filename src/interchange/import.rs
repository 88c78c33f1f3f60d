//! The way in: what the bytes of a foreign file hold, as a table.

use std::path::Path;

use super::format::{Format, Options};
use super::half_difference::HalfDifference;
use super::mitsuba::rgl;
use super::numpy::npz;
use super::radiance::{klems, tensor_tree};
use super::resample::gaps;
use super::resample::{default_grid, resample_spectrum, thirds};
use super::text::samples::one_azimuth;
use super::text::{astm, csv, ssdd, zemax};
use super::{Brdf, Lookup, Reason, exr_parts, merl, needed, utia};
use crate::error::{Error, Result};
use crate::files::{self, memory};
use crate::instrument::{Grid, GridKind};
use crate::table::BrdfTable;

/// The largest file that is read, bytes; the memory that may be used can allow less ([`memory`]).
pub const LARGEST_FILE: u64 = 4 << 30;

/// What a foreign file holds.
pub enum Imported {
    /// Stops and bins of its own.
    Table(BrdfTable),
    /// A function of two directions, and a grid that suits it.
    Function(Box<dyn Brdf>, Grid),
    /// The same with a wavelength for each colour.
    Spectrum {
        /// Three wavelengths each, the last what is left.
        parts: Vec<Box<dyn Brdf>>,
        /// All, nm.
        wavelengths_nm: Vec<f64>,
        /// A grid that suits it.
        grid: Grid,
    },
}

impl Imported {
    /// The function that `part` makes of the values of at most three colours.
    pub(super) fn function(
        values: &[Vec<f32>],
        wavelengths_nm: &[f64],
        grid: Grid,
        part: impl Fn(&[Vec<f32>]) -> Box<dyn Brdf>,
    ) -> Self {
        if wavelengths_nm.is_empty() {
            return Imported::Function(part(values), grid);
        }
        let parts = values.chunks(3).map(part).collect();
        Imported::Spectrum { parts, wavelengths_nm: wavelengths_nm.to_vec(), grid }
    }
}

/// What the bytes of a file hold. Memory goes with their number; [`import`] judges how much it is first.
pub fn decode(format: Format, options: &Options, bytes: &[u8]) -> Reason<Imported> {
    decode_with_notes(format, options, bytes).map(|(imported, _)| imported)
}

/// The same, and one sentence for each thing that the reader has to say of the file.
pub fn decode_with_notes(format: Format, options: &Options, bytes: &[u8]) -> Reason<(Imported, Vec<String>)> {
    let table = |table: BrdfTable| (Imported::Table(table), vec![]);
    Ok(match format {
        Format::Npz => table(npz::read(bytes)?),
        Format::Npy => return Err("an array without axes is no table; save it as npz with axes".into()),
        Format::Csv => table(csv::read(bytes)?),
        Format::Merl => table(merl::read_table(bytes, options.merl_sampling)?),
        Format::Rgl => {
            let rgl = rgl::read(bytes)?;
            let grid = default_grid(rgl.theta_i_deg(), rgl.phi_i_deg());
            (Imported::Function(Box::new(rgl), grid), vec![])
        }
        Format::Utia => table(utia::read(bytes)?),
        Format::ExrParts => table(exr_parts::read(bytes)?),
        Format::Klems => {
            let (table, notes) = klems::read_side(bytes, options.side)?;
            (Imported::Table(table), notes)
        }
        Format::TensorTree => {
            let (tree, notes) = tensor_tree::read_side(bytes, options.side)?;
            let azimuths =
                if tree.is_isotropic() { vec![] } else { (0..24).map(|k| 15.0 * f64::from(k)).collect() };
            let theta_i_deg = (0..6).map(|k| 15.0 * f64::from(k)).collect();
            (Imported::Function(Box::new(tree), default_grid(theta_i_deg, azimuths)), notes)
        }
        Format::Zemax => {
            let (zemax, notes) = zemax::read_with_notes(bytes)?;
            let grid = default_grid(zemax.theta_i_deg(), zemax.phi_i_deg());
            (Imported::Function(Box::new(zemax), grid), notes)
        }
        Format::Astm => table(astm::read(bytes)?),
        Format::Ssdd => ssdd::read_with_notes(bytes)?,
        Format::Pabopto => {
            return Err("a file has one stop; read its folder with pabopto2bsdf, or export as ssdd".into());
        }
    })
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
    memory::check_file(path, needed::needed(format, &bytes).map_err(wrong)?)?;
    let (imported, notes) = decode_with_notes(format, options, &bytes).map_err(wrong)?;
    let imported = match imported {
        Imported::Table(table) if options.isotropic => Imported::Table(one_azimuth(table).map_err(wrong)?),
        Imported::Function(..) | Imported::Spectrum { .. } if options.isotropic => {
            return Err(wrong("says itself whether it is isotropic: leave --isotropic out".into()));
        }
        imported => imported,
    };
    let (table, how) = on_grid(imported, like).map_err(wrong)?;
    Ok((table, notes.into_iter().chain(how).collect()))
}

/// A table of what was read, on the geometry of `like` where that is given, with what is to be said of gaps and of
/// resampling.
fn on_grid(imported: Imported, like: Option<&Grid>) -> Reason<(BrdfTable, Vec<String>)> {
    let (parts, wavelengths_nm, own) = match imported {
        Imported::Table(table) => {
            let Some(grid) = like.filter(|grid| **grid != table.grid) else {
                let note = gaps::note(&table).into_iter().collect();
                return Ok((table, note));
            };
            let (table, filled) = gaps::filled(table)?;
            let how = match table.grid.kind {
                GridKind::HalfDifference => "linear between half/difference angles",
                GridKind::Patches => "constant in each pair of patches, the mean at borders",
                _ => "by cubic interpolation at equal half vector",
            };
            let parts = thirds(&table).into_iter().map(function_of).collect::<Reason<Vec<_>>>()?;
            let table = resample_spectrum(parts.iter().map(Box::as_ref), &table.wavelengths_nm(), grid)?;
            return Ok((table, filled.into_iter().chain([format!("resampled: {how}")]).collect()));
        }
        Imported::Function(brdf, own) => (vec![brdf], vec![], own),
        Imported::Spectrum { parts, wavelengths_nm, grid } => (parts, wavelengths_nm, grid),
    };
    let grid = like.unwrap_or(&own);
    let (stops, bins) = (grid.stops(), grid.bins());
    let how = format!("resampled: means over {stops} stops of {bins} bins, 16 directions a bin");
    Ok((resample_spectrum(parts.iter().map(Box::as_ref), &wavelengths_nm, grid)?, vec![how]))
}

/// A table of at most three colours as a function.
fn function_of(table: BrdfTable) -> Reason<Box<dyn Brdf>> {
    Ok(match table.grid.kind {
        GridKind::HalfDifference => Box::new(HalfDifference::new(&table)?),
        GridKind::Patches => Box::new(klems::Patchwise::new(table)?),
        _ => Box::new(Lookup::new(&table)?),
    })
}
