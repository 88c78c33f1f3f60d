//! Universal BRDF files of the EURAMET project BiRD (`.brdf`): JSON, a list of numbers for each variable and for the values,
//! with their unit, next to each other; and a section of metadata.
//!
//! theta and phi from the sample's normal and its azimuth 0: absolute azimuths, phi_i + 180 the mirror direction. `uBRDF` is
//! the standard uncertainty. Source: the project's JSON schema 1.0 (BiRD_view) and its example file.

mod metadata;
mod read;
mod read_back;
mod units;

use std::io::Write;
use std::path::Path;

use super::samples;
use super::spectral_rows::{self, NO_WAVELENGTH};
use crate::error::{ContentError, wrong};
use crate::interchange::codec::{self, Codec, Encoded, FileContent, FormatTraits};
use crate::interchange::read_back::ReadBack;
use crate::interchange::{Checked, Imported, Options};
use crate::sphere;
use crate::table::BrdfTable;

/// How the values are meant.
const CONVENTION: &str = "theta and phi in degrees from the sample's normal and azimuth 0, phi_i + 180 is the mirror direction; \
    BRDF in 1/sr, no cosine; the middle of each bin; uBRDF the standard error over realisations (k = 1)";
/// The schema's polar angles end below this, degrees.
const END_OF_THETA: f64 = 90.0;
/// Bytes of memory for each comma of a file: a row has five numbers or more, each in a list that is half empty at worst,
/// and becomes a sample with its place.
const MEMORY: u64 = 256;

/// The format.
pub struct Bird;

impl Codec for Bird {
    fn traits(&self) -> FormatTraits {
        FormatTraits { more_than_totals: true, gaps: true, wavelengths: true, ..FormatTraits::totals("bird") }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        let commas = bytes.iter().filter(|byte| **byte == b',').count() as u64;
        Ok(4 * bytes.len() as u64 + MEMORY * commas)
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        let (table, notes) = read_with_notes(bytes)?;
        Ok((table.into(), notes))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, options: &Options) -> Checked<Encoded<'a>> {
        let colours = colours(table, options)?;
        if let Some(theta) = spectral_rows::polar_angles(table).find(|theta| theta.abs() >= END_OF_THETA) {
            return Err(wrong!("a polar angle of {theta} degrees: the schema's end below {END_OF_THETA}"));
        }
        let mut notes = vec!["provenance says NA, timestamp is that of the export: fill them in".to_string()];
        if table.campaign.is_empty() {
            notes
                .push("the table holds no campaign: method says measurement, the schema's other word".into());
        }
        if !has_errors(table) {
            notes.push(
                "no uBRDF: some values have no standard error, and the schema has no word for that".into(),
            );
        }
        Ok(Encoded {
            content: FileContent::Stream(Box::new(move |out| write(table, &colours, out))),
            convention: CONVENTION.into(),
            notes,
        })
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, options: &Options) -> Checked<Option<ReadBack>> {
        let colours = colours(table, options)?;
        read_back::compared(codec::open(path)?, table, &colours, &names(table, &colours))
    }
}

/// The table of points of a file, and notes on it.
// Tested by tests/it/interchange/interchange_bird.rs.
pub fn read_with_notes(bytes: &[u8]) -> Checked<(BrdfTable, Vec<String>)> {
    let file = read::rows(bytes)?;
    // What was left out may be why rows seem to be twice there.
    let said = |why: ContentError| match file.notes.join("; ") {
        notes if notes.is_empty() => why,
        notes => wrong!("{why} ({notes})"),
    };
    let (pairs, columns) = spectral_rows::pairs(&file.rows).map_err(said)?;
    Ok((samples::table(&pairs, &columns, file.is_isotropic)?, file.notes))
}

/// (wavelength in nm, colour) of what is written; a single channel needs none.
fn colours(table: &BrdfTable, options: &Options) -> Checked<Vec<(f64, usize)>> {
    Ok(spectral_rows::wavelengths(table, options, "BiRD")?.unwrap_or_else(|| vec![(NO_WAVELENGTH, 0)]))
}

/// Whether every value that was measured has a standard error.
fn has_errors(table: &BrdfTable) -> bool {
    let known = |entry: usize| table.colours.iter().all(|colour| colour.stderr[entry] >= 0.0);
    (0..table.hits.len()).all(|entry| table.is_gap(entry) || known(entry))
}

/// The lists of a file, in their order.
fn names(table: &BrdfTable, colours: &[(f64, usize)]) -> Vec<&'static str> {
    let mut names = vec!["wavelength_i", "theta_i", "phi_i", "theta_r", "phi_r", "BRDF", "uBRDF"];
    names.retain(|name| match *name {
        "wavelength_i" => colours.iter().any(|(nm, _)| *nm != NO_WAVELENGTH),
        "uBRDF" => has_errors(table),
        _ => true,
    });
    names
}

fn write(table: &BrdfTable, colours: &[(f64, usize)], out: &mut dyn Write) -> Checked<()> {
    let metadata = serde_json::to_string_pretty(&metadata::metadata(table)).map_err(|e| e.to_string())?;
    write!(out, "{{\"metadata\": {metadata},\n\"data\": {{")?;
    let mut between = "\n";
    for name in names(table, colours) {
        let unit = match name {
            "wavelength_i" => "nm",
            "BRDF" | "uBRDF" => "1/sr",
            _ => "deg",
        };
        write!(out, "{between}\"{name}\": {{\"unit\": \"{unit}\", \"values\": [")?;
        between = ",\n";
        let mut comma = "";
        for &(nm, colour) in colours {
            let channels = &table.colours[colour];
            spectral_rows::each_bin(table, |entry, [light, sensor]| {
                write!(out, "{comma}")?;
                comma = ",";
                match name {
                    "wavelength_i" => write!(out, "{nm}")?,
                    "theta_i" => write!(out, "{}", light[0])?,
                    "phi_i" => write!(out, "{}", sphere::reduced_deg(light[1]))?,
                    "theta_r" => write!(out, "{}", sensor[0])?,
                    "phi_r" => write!(out, "{}", sphere::reduced_deg(sensor[1]))?,
                    // The shortest digits that are the f32 value.
                    "BRDF" => write!(out, "{:e}", channels.total[entry])?,
                    _ => write!(out, "{:e}", channels.stderr[entry])?,
                }
                Ok(())
            })?;
        }
        write!(out, "]}}")?;
    }
    writeln!(out, "\n}}}}")?;
    Ok(())
}
