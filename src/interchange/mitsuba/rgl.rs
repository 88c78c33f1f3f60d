//! RGL/EPFL `.bsdf`: the adaptive tensor file that Mitsuba's `measured`, powitacq and pbrt read; rgb or spectral,
//! isotropic or anisotropic.
//!
//! A reader maps the half vector through the warp of the visible normals of an auxiliary distribution D and looks up
//! `spectra`; value = spectra D(m)/(4 sigma(wi)) = f cos(theta_o). D and sigma are in the file and need not be those of
//! the material: here the GGX whose slopes have the table's medians, so that `spectra` is smooth.
//! Source: Dupuy and Jakob 2018; layout: Mitsuba 3's `measured`.

pub use super::read::{Rgl, read};
pub use super::write::write;
use crate::error::wrong;
use crate::interchange::codec::{Codec, Encoded, FormatTraits, resampling_notes};
use crate::interchange::options::NANOMETRES;
use crate::interchange::resample::default_grid;
use crate::interchange::{Checked, Imported, Lookup, Options};
use crate::table::BrdfTable;

/// How the values are meant.
const CONVENTION: &str = "spectra x D(m)/(4 sigma(wi)) is f cos(theta_o): with the cosine, as Mitsuba's eval returns \
    it; angles in radians, wi towards the light, z the normal, x the tangent; values at directions, no aperture";

/// The format.
pub struct RglFile;

impl Codec for RglFile {
    fn traits(&self) -> FormatTraits {
        FormatTraits::resampled("rgl")
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        Ok(6 * bytes.len() as u64)
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        let rgl = read(bytes)?;
        let grid = default_grid(rgl.theta_i_deg(), rgl.phi_i_deg());
        Ok((Imported::of(rgl, grid), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, options: &Options) -> Checked<Encoded<'a>> {
        let lookup = Lookup::new(table)?;
        let bytes = write(&lookup, wavelengths(table, options)?, &description(table))?;
        Ok(Encoded::bytes(bytes, CONVENTION, resampling_notes(&lookup)))
    }
}

/// The wavelengths of a spectral file, where they are asked for.
fn wavelengths<'a>(table: &BrdfTable, options: &'a Options) -> Checked<Option<&'a [f64]>> {
    let nm = options.wavelengths_nm.as_slice();
    if nm.is_empty() {
        return Ok(None);
    }
    let colours = table.colours.len();
    if colours > 1 && nm.len() != colours {
        return Err(wrong!("{} wavelengths for {colours} colours: one for each needed", nm.len()));
    }
    if nm.len() < 2
        || nm.windows(2).any(|pair| pair[0] >= pair[1])
        || !nm.iter().all(|nm| NANOMETRES.contains(nm))
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
