//! BRDF look-up tables of ASAM OpenMATERIAL 3D (`.xompt`): JSON, a row `[wavelength, theta_i, theta_r, phi_r, BRDF]` for each
//! pair of directions and wavelength, in m, rad and 1/sr.
//!
//! The light has azimuth 0 and phi_r counts from it, so the tables are isotropic; rows are sorted by their columns. A null value
//! is none. Source: OpenMATERIAL 3D 1.1.0, its JSON schema and its Annex A. It leaves open on which side phi_r = 0 lies, and so do
//! its examples; here it is the light's own azimuth, and pi the mirror direction.

use std::collections::HashMap;
use std::io::Write;
use std::path::Path;

use serde::Deserialize;
use serde_json::json;

use super::identity;
use super::named_columns::{ColourValues, Columns};
use super::samples::{self, MeasuredPair, key, whole_deg};
use super::spectral_rows::{self, LISTED_NM, SpectralRow, whole_nm};
use crate::error::wrong;
use crate::files;
use crate::interchange::codec::{Codec, Encoded, FileContent, FormatTraits};
use crate::interchange::read_back::ReadBack;
use crate::interchange::{Checked, Imported, Options};
use crate::sphere;
use crate::table::BrdfTable;

/// How the values are meant.
const CONVENTION: &str = "a row [wavelength m, theta_i, theta_r, phi_r rad, BRDF 1/sr] a pair; phi_r from the light's azimuth, pi \
    is the mirror direction; the middle of each bin; no cosine";
/// The version of the specification.
const VERSION: &str = "1.1.0";
/// Where the schema is; Annex A wants it named in the second line.
const SCHEMA: &str = "https://raw.githubusercontent.com/asam-ev/OpenMATERIAL-3D/refs/tags/v1.1.0/schemas/material_brdf_schema.json";
/// The largest polar angle and azimuth that the schema admits, rad.
const MOST_THETA: f64 = 1_570_796.0 / 1e6;
const MOST_PHI: f64 = 6_283_185.0 / 1e6;
/// What the digits of degrees that were read from radians may add to them, rad.
const DIGITS: f64 = 1e-9;
/// Bytes of memory for each of the file's: a row of 15 bytes or more becomes five numbers, a sample and its place, each
/// list half empty at worst.
const MEMORY: u64 = 64;

/// The format.
pub struct OpenMaterial;

impl Codec for OpenMaterial {
    fn traits(&self) -> FormatTraits {
        FormatTraits { gaps: true, wavelengths: true, ..FormatTraits::totals("openmaterial") }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        Ok(MEMORY * bytes.len() as u64)
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Ok((read(bytes)?.into(), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, options: &Options) -> Checked<Encoded<'a>> {
        let colours = colours(table, options)?;
        if !table.grid.is_isotropic() {
            return Err(
                "OpenMATERIAL's rows have no azimuth of the light: measure with azimuth = \"relative\""
                    .into(),
            );
        }
        let beyond = |theta: &f64| theta.abs().to_radians() > MOST_THETA + DIGITS;
        if let Some(theta) = spectral_rows::polar_angles(table).find(beyond) {
            return Err(wrong!(
                "a polar angle of {theta} degrees: OpenMATERIAL's end at {MOST_THETA} rad, below 90"
            ));
        }
        spectral_rows::each_bin(table, |_, directions| {
            let [_, [_, phi]] = from_light(directions);
            if phi.to_radians() <= MOST_PHI + DIGITS {
                return Ok(());
            }
            Err(wrong!(
                "a sensor {phi} degrees from the light's azimuth: OpenMATERIAL's azimuths end at {MOST_PHI} rad, below 360"
            ))
        })?;
        Ok(Encoded {
            content: FileContent::Stream(Box::new(move |out| write(table, &colours, out))),
            convention: CONVENTION.into(),
            notes: vec![
                "license and copyrights say NOASSERTION: fill them in; the names of such files end in _brdf.xompt".into(),
            ],
        })
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, options: &Options) -> Checked<Option<ReadBack>> {
        compared(table, &colours(table, options)?, &pairs(&files::read(path)?)?.0)
    }
}

/// (wavelength in nm, colour) of what is written, by increasing wavelength.
fn colours(table: &BrdfTable, options: &Options) -> Checked<Vec<(f64, usize)>> {
    spectral_rows::wavelengths(table, options, "OpenMATERIAL")?.ok_or_else(|| {
        "OpenMATERIAL's rows have a wavelength, the table has one channel without: give 1 with --wavelengths-nm".into()
    })
}

fn write(table: &BrdfTable, colours: &[(f64, usize)], out: &mut dyn Write) -> Checked<()> {
    // 450/1e9 is the number next to 450 nm; 450e-9 may be its neighbour.
    let metres: Vec<f64> = colours.iter().map(|(nm, _)| nm / 1e9).collect();
    let mut rows: Vec<([f64; 3], usize)> = Vec::new();
    spectral_rows::each_bin(table, |entry, directions| {
        let [light, sensor] = from_light(directions);
        let theta = [light[0], sensor[0]].map(|theta| theta.to_radians().min(MOST_THETA));
        rows.push(([theta[0], theta[1], sensor[1].to_radians().min(MOST_PHI)], entry));
        Ok(())
    })?;
    rows.sort_by(|(a, _), (b, _)| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    let mut brdf = json!({ "wavelengths": metres });
    if let Some(angle) = identity::receiver(table) {
        let each = metres.iter().map(|metres| json!({ "wavelength": metres, "solidAngle": angle }));
        brdf["receiverSolidAngles"] = each.collect();
    }
    let text = |value: &serde_json::Value| value.to_string();
    let head = text(&brdf);
    write!(
        out,
        "{{\n\"$schema\":\"{SCHEMA}\",\n\"metadata\":{},\n\"brdf\":{},\"lookupTable\":[",
        text(&metadata(table)),
        head.trim_end_matches('}')
    )?;
    let mut between = "\n";
    for ((_, colour), metres) in colours.iter().zip(&metres) {
        for ([theta_i, theta_r, phi], entry) in &rows {
            // The shortest digits that are the f32 value.
            let value = table.colours[*colour].total[*entry];
            write!(out, "{between}[{metres:e},{theta_i:.12},{theta_r:.12},{phi:.12},{value:e}]")?;
            between = ",\n";
        }
    }
    writeln!(out, "\n]}}}}")?;
    Ok(())
}

/// Light and sensor with the sensor's azimuth counted from the light's, degrees.
fn from_light([light, sensor]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [[light[0], 0.0], [sensor[0], sphere::reduced_deg(sensor[1] - light[1])]]
}

/// What is known of the table; the same table has the same UUID.
fn metadata(table: &BrdfTable) -> serde_json::Value {
    json!({
        "name": identity::name(table),
        "uuid": identity::uuid(table),
        "materialVersion": "1.0.0",
        "openMaterial3dVersion": VERSION,
        "copyrights": ["NOASSERTION"],
        "license": "NOASSERTION",
        "authors": [format!("gonio {}", table.version)],
        "sources": if table.campaign.is_empty() { "unknown" } else { "simulated" },
    })
}

/// What is read of a file.
#[derive(Deserialize)]
struct LookupFile {
    brdf: LookupTable,
}

#[derive(Deserialize)]
struct LookupTable {
    #[serde(rename = "lookupTable")]
    rows: Vec<[Option<f64>; 5]>,
}

/// The table of points of a file.
// Tested by `tables_come_back_from_openmaterial` (tests/it/interchange/interchange_openmaterial.rs).
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    let (pairs, columns) = pairs(bytes)?;
    samples::table(&pairs, &columns, true)
}

/// The pairs of a file with a value for each wavelength.
fn pairs(bytes: &[u8]) -> Checked<(Vec<MeasuredPair>, Columns)> {
    let file: LookupFile =
        serde_json::from_slice(bytes).map_err(|e| wrong!("no look-up table of OpenMATERIAL: {e}"))?;
    let listed =
        file.brdf.rows.iter().enumerate().filter_map(|(k, row)| row[4].map(|value| (k + 1, row, value)));
    let mut rows: Vec<SpectralRow> = Vec::new();
    for (number, row, value) in listed {
        let &[Some(metres), Some(theta_i), Some(theta_r), Some(phi), _] = row else {
            return Err(wrong!("row {number}: a value without its wavelength or angles"));
        };
        let nm = whole_nm(metres * 1e9);
        if !LISTED_NM.contains(&nm) || value < 0.0 {
            return Err(wrong!(
                "row {number}: wavelength {metres} m, BRDF {value} 1/sr: 1e-9 to 0.02, and 0 or more needed"
            ));
        }
        let [theta_i, theta_r, phi] = [theta_i, theta_r, phi].map(whole_deg);
        let (light, sensor) = ([theta_i, 0.0], [theta_r, phi]);
        rows.push(SpectralRow { number, nm, light, sensor, value, error: None });
    }
    spectral_rows::pairs(&rows)
}

/// Compares the pairs of a file, in any order, with the table that it was made of; `colours` as from [`colours`].
fn compared(
    table: &BrdfTable,
    colours: &[(f64, usize)],
    pairs: &[MeasuredPair],
) -> Checked<Option<ReadBack>> {
    let places: HashMap<_, &MeasuredPair> =
        pairs.iter().map(|pair| ((key(pair.light), key(pair.sensor)), pair)).collect();
    let each = |visit: &mut dyn FnMut(MeasuredPair) -> Checked<()>| {
        spectral_rows::each_bin(table, |_, [light, sensor]| {
            // As `pairs` has them.
            let [of_light, [theta, phi]] = from_light([light, sensor]);
            let of_sensor = [theta, whole_deg(phi.to_radians().min(MOST_PHI))];
            let found = places.get(&(key(of_light), key(of_sensor)));
            let found =
                found.ok_or_else(|| wrong!("no row for light {light:?} and sensor {sensor:?} degrees"))?;
            let mut values: ColourValues = found.values.clone();
            colours.iter().zip(&found.values).for_each(|(&(_, colour), value)| values[colour] = *value);
            visit(MeasuredPair { light, sensor, values, ..(*found).clone() })
        })
    };
    samples::listed(table, 1e-8, each)?.finish()
}
