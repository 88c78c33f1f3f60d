//! NPY: the totals alone, `[theta_i, phi_i, theta_r, phi_r(, colour)]` as `brdf` of the NPZ. Written only: an array
//! without axes is no table.

use std::io::{BufReader, Write};

use super::arrays::{interleaved, shape};
use crate::files::{Input, npy};
use crate::interchange::codec::{BandCodec, Codec, Encoded, FormatTraits, Sides};
use crate::interchange::read_back::{Listing, ReadBack, ReadErrors};
use crate::interchange::{Bands, Checked, Imported, Options};
use crate::table::BrdfTable;

/// How the values are meant.
const CONVENTION: &str = "f4, C order, [theta_i, phi_i, theta_r, phi_r(, colour)] as the table has them; BRDF in 1/sr, \
    no cosine; bin means; no axes, no error bars";

/// The format.
pub struct Npy;

impl Codec for Npy {
    fn traits(&self) -> FormatTraits {
        FormatTraits {
            half_difference: true,
            sides: Sides::Both,
            wavelengths: true,
            ..FormatTraits::totals("npy")
        }
    }

    fn decode(&self, _bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Err("an array without axes is no table; save it as npz with axes".into())
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &Options) -> Checked<Encoded<'a>> {
        Ok(Encoded::stream(CONVENTION, table, |mut table, out| Npy.write(&mut table, out)))
    }

    fn by_bands(&self) -> Option<&dyn BandCodec> {
        Some(self)
    }
}

impl BandCodec for Npy {
    fn convention(&self) -> &'static str {
        CONVENTION
    }

    fn write(&self, bands: &mut dyn Bands, out: &mut dyn Write) -> Checked<()> {
        let outline = bands.outline();
        let mut array = npy::writer(out, &shape(&outline.grid, outline.colours.len()))?;
        bands.each(&mut |band| {
            let totals: Vec<&[f32]> = band.colours.iter().map(|colour| colour.total.as_slice()).collect();
            Ok(array.extend(interleaved(&totals))?)
        })?;
        Ok(array.finish()?)
    }

    fn read_back(&self, file: BufReader<Input>, bands: &mut dyn Bands) -> Checked<Option<ReadBack>> {
        let outline = bands.outline();
        let colours = outline.colours.len();
        let mut values = npy::values_of(file, &shape(&outline.grid, colours))?;
        let mut errors = ReadErrors::default();
        bands.each(&mut |band| {
            let (mut listing, bins) = (Listing::new(band), band.grid.bins());
            for (at, value) in values.by_ref().take(band.hits.len() * colours).enumerate() {
                let (entry, colour) = (at / colours, at % colours);
                listing.add(entry / bins, entry % bins, colour, value?);
            }
            errors.join(listing)
        })?;
        Ok(errors.read_back())
    }
}
