//! Zemax tabular BSDF: angles about the mirror direction; isotropic, or a table for each rotation of the sample.
//!
//! For each rotation and incidence a table over (azimuth, radial): radial is the angle from the mirror direction,
//! azimuth 0 points from it towards the normal. Before each, TIS, the directional albedo. A file is of one `ScatterType`: of
//! light that has gone through (BTDF) the angles are those about the direction of direct transmission, straight on. Source:
//! Zemax's pages on the tabular format; libbsdf reads BTDFs so, in the horizon's mirror.

pub(crate) mod energy;
mod tables;
pub(crate) mod text;
pub(crate) mod write;

use crate::interchange::codec::{self, Codec, Encoded, FormatTraits, Sides, resampling_notes};
use crate::interchange::content::light::media_differ;
use crate::interchange::content::sides::put_together;
use crate::interchange::resample::default_grid;
use crate::interchange::{Checked, Imported, Lookup, Options, needed};
use crate::table::BrdfTable;
pub use tables::Zemax;
pub(crate) use tables::rotation_deg;
pub use write::write;

/// How the values are meant.
const CONVENTION: &str = "degrees about the mirror direction (radial the angle from it, azimuth 0 towards the normal, \
    counter-clockwise); BRDF in 1/sr, no cosine; TIS the directional albedo; values at directions, no aperture; \
    isotropic: PlaneSymmetrical; else ASymmetrical4D, SampleRotation the sample's turn counter-clockwise under a lamp at \
    azimuth 0 (light at phi_i is the rotation 360 - phi_i)";
/// The same of light that has gone through, besides.
const THROUGH: &str = "; BTDF: about the direction in which light goes straight on, as a mirror in the horizon shows it; TIS \
    the directional transmittance";
/// Between media that differ.
const REFRACTED: &str = "the media on both sides differ: AngleOfIncidence is the light's angle in its own medium and radial 0 \
    goes straight on, as through a pane; a program that refracts a ray at the surface first turns the lobe a second time";

/// The format.
pub struct ZemaxFile;

impl Codec for ZemaxFile {
    fn traits(&self) -> FormatTraits {
        FormatTraits {
            reach_deg: |last_deg| [last_deg, 90.0],
            colours: false,
            sides: Sides::One,
            ..FormatTraits::resampled("zemax")
        }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        Ok(needed::numbers(bytes))
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        let (zemax, notes) = read_with_notes(bytes)?;
        let grid = default_grid(zemax.light.clone(), zemax.phi_i_deg());
        let through = zemax.through;
        let block = Some(Imported::of(zemax, grid));
        Ok((put_together(if through { [None, block] } else { [block, None] })?, notes))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &Options) -> Checked<Encoded<'a>> {
        let (through, half) = codec::halves(table).pop().ok_or("the sensor has no bins")?;
        let lookup = Lookup::of_side(&half, through)?;
        let (text, mut notes) = write(&half, through, &lookup)?;
        notes.splice(..0, resampling_notes(&lookup));
        let refracted = through && media_differ(table).unwrap_or(false);
        notes.extend(refracted.then(|| REFRACTED.to_string()));
        Ok(Encoded::bytes(text, format!("{CONVENTION}{}", if through { THROUGH } else { "" }), notes))
    }
}

/// The tables of a file; nothing is integrated.
pub fn read(bytes: &[u8]) -> Checked<Zemax> {
    text::parse(bytes).map(|(file, _)| file)
}

/// The tables of a file, and notes on them.
pub fn read_with_notes(bytes: &[u8]) -> Checked<(Zemax, Vec<String>)> {
    let (file, mut notes) = text::parse(bytes)?;
    let last = |list: &[f64]| list[list.len() - 1];
    if last(&file.radials) < 90.0 + last(&file.light) && last(&file.radials) < 180.0 {
        notes.push(format!("ScatterRadial ends at {}: beyond, the last value", last(&file.radials)));
    }
    let luminance = file.values.len() / 2;
    notes.extend(file.disagreement(luminance, &file.integrals(luminance)));
    if file.values.len() == 3 {
        let outside =
            (0..file.values[0].len()).filter(|&at| file.colour_of(|c| f64::from(file.values[c][at])).1);
        notes.extend(Some(outside.count()).filter(|&count| count > 0).map(|count| {
            format!("{count} colours lie outside R, G, B (BT.709): their negative parts are 0")
        }));
    }
    Ok((file, notes))
}
