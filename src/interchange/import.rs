//! The way in: what the bytes of a foreign file hold, as a table.

use std::path::Path;

use super::format::{Format, Options};
use super::half_difference::HalfDifference;
use super::resample::default_grid;
use super::{
    Brdf, Lookup, Reason, astm, csv, exr_parts, klems, merl, npz, resample, rgl, ssdd, tensor_tree, utia,
    zemax,
};
use crate::error::{Error, Result};
use crate::files;
use crate::instrument::{Grid, GridKind};
use crate::table::BrdfTable;

/// The largest file that is read, bytes.
pub const LARGEST_FILE: u64 = 4 << 30;

/// What a foreign file holds.
pub enum Imported {
    /// Stops and bins of its own.
    Table(BrdfTable),
    /// A function of two directions, and a grid that suits it.
    Function(Box<dyn Brdf>, Grid),
}

/// What the bytes of a file hold; memory is bounded by their number.
pub fn decode(format: Format, options: &Options, bytes: &[u8]) -> Reason<Imported> {
    match format {
        Format::Npz => npz::read(bytes).map(Imported::Table),
        Format::Npy => Err("an array without axes is no table; save it as npz with axes".into()),
        Format::Csv => csv::read(bytes).map(Imported::Table),
        Format::Merl => merl::read_table(bytes, options.merl_sampling).map(Imported::Table),
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
            let grid = default_grid(zemax.theta_i_deg(), zemax.phi_i_deg());
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
            let grid = like.unwrap_or(&table.grid);
            if table.grid.kind == GridKind::HalfDifference {
                let brdf = HalfDifference::new(&table).map_err(wrong)?;
                let notes = vec!["resampled: linear between half/difference angles".into()];
                return Ok((resample(&brdf, grid).map_err(wrong)?, notes));
            }
            let brdf = Lookup::new(&table).map_err(wrong)?;
            let notes = vec!["resampled by cubic interpolation at equal half vector".into()];
            Ok((resample(&brdf, grid).map_err(wrong)?, notes))
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
