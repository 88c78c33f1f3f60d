//! BRDF look-up tables of ASAM OpenMATERIAL 3D (`.xompt`): JSON, a row `[wavelength, theta_i, theta_r, phi_r, BRDF]` for each
//! pair of directions and wavelength, in m, rad and 1/sr.
//!
//! The light has azimuth 0 and phi_r counts from it, so the tables are isotropic; rows are sorted by their columns. A null value
//! is none. Source: the JSON schema of OpenMATERIAL 3D 1.1.0. It leaves open on which side phi_r = 0 lies; here, as its examples
//! do at pairs of light and sensor in one plane, it is the light's own azimuth, and pi the mirror direction.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::io::Write;
use std::path::Path;

use serde::Deserialize;
use serde_json::json;
use sha2::{Digest, Sha256};

use super::named_columns::{ColourValues, Columns};
use super::samples::{self, MeasuredPair, key};
use crate::error::wrong;
use crate::files;
use crate::instrument::Region;
use crate::interchange::codec::{Codec, Encoded, FileContent, FormatTraits};
use crate::interchange::options::NANOMETRES;
use crate::interchange::read_back::{ReadBack, middles_deg};
use crate::interchange::{Checked, Imported, Options};
use crate::sphere;
use crate::table::BrdfTable;

/// How the values are meant.
const CONVENTION: &str = "a row [wavelength m, theta_i, theta_r, phi_r rad, BRDF 1/sr] a pair; phi_r from the light's azimuth, pi \
    is the mirror direction; the middle of each bin; no cosine";
/// The version of the specification.
const VERSION: &str = "1.1.0";
/// The largest polar angle that the schema admits, rad.
const MOST_THETA: f64 = 1_570_796.0 / 1e6;
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
        let (pairs, columns) = read(bytes)?;
        Ok((samples::table(&pairs, &columns, true)?.into(), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, options: &Options) -> Checked<Encoded<'a>> {
        let colours = colours(table, options)?;
        if !table.grid.is_isotropic() {
            return Err(
                "OpenMATERIAL's rows have no azimuth of the light: measure with azimuth = \"relative\""
                    .into(),
            );
        }
        if let Some(theta) = beyond(table) {
            return Err(wrong!(
                "a polar angle of {theta} degrees: OpenMATERIAL's end at {MOST_THETA} rad, below 90"
            ));
        }
        Ok(Encoded {
            content: FileContent::Stream(Box::new(move |out| write(table, &colours, out))),
            convention: CONVENTION.into(),
            notes: vec!["license and copyrights say NOASSERTION: fill them in".into()],
        })
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, options: &Options) -> Checked<Option<ReadBack>> {
        let (pairs, _) = read(&files::read(path)?)?;
        let order = colours(table, options)?;
        let places: HashMap<_, &MeasuredPair> =
            pairs.iter().map(|pair| ((key(pair.light), key(pair.sensor)), pair)).collect();
        let each = |visit: &mut dyn FnMut(MeasuredPair) -> Checked<()>| {
            each_bin(table, |_, [light, sensor]| {
                let found = places.get(&(key(light), key(sensor)));
                let found = found
                    .ok_or_else(|| wrong!("no row for light {light:?} and sensor {sensor:?} degrees"))?;
                let mut values: ColourValues = found.values.clone();
                order.iter().zip(&found.values).for_each(|(&(_, colour), value)| values[colour] = *value);
                visit(MeasuredPair { light, sensor, values, ..(*found).clone() })
            })
        };
        // The rows' azimuths count from the light's, and so do those of an isotropic table.
        samples::listed(table, 1e-8, each)?.finish()
    }
}

/// (wavelength in nm, colour) of what is written, by increasing wavelength.
fn colours(table: &BrdfTable, options: &Options) -> Checked<Vec<(f64, usize)>> {
    let (own, given) = (table.wavelengths_nm(), &options.wavelengths_nm);
    let count = table.colours.len();
    if !own.is_empty() {
        let mut colours: Vec<(f64, usize)> = own.into_iter().zip(0..).collect();
        colours.sort_by(|a, b| a.0.total_cmp(&b.0));
        return Ok(colours);
    }
    if given.len() != count {
        let (has, give) = match count {
            3 => ("R, G, B", "3 with --wavelengths-nm, of B, G and R"),
            _ => ("one channel", "1 with --wavelengths-nm"),
        };
        return Err(wrong!(
            "OpenMATERIAL's rows have a wavelength, the table has {has} without: give {give}"
        ));
    }
    if !given.is_sorted_by(|a, b| a < b) || !given.iter().all(|nm| NANOMETRES.contains(nm)) {
        return Err(wrong!(
            "--wavelengths-nm {given:?}: increasing numbers of {} to {} nm needed",
            NANOMETRES.start(),
            NANOMETRES.end()
        ));
    }
    // Increasing wavelengths are B, G, R.
    Ok(given.iter().copied().zip((0..count).rev()).collect())
}

/// The first polar angle that the schema does not admit, degrees.
fn beyond(table: &BrdfTable) -> Option<f64> {
    let sensors = (0..table.grid.incidences())
        .flat_map(|incidence| middles_deg(&table.grid, incidence))
        .map(|(theta, _)| theta);
    let lights = (0..table.grid.incidences()).map(|incidence| table.grid.incidence_deg(incidence).0);
    lights.chain(sensors).find(|theta| theta.abs().to_radians() > MOST_THETA)
}

/// Visits every bin that was measured: its entry, light and sensor in degrees, theta >= 0.
fn each_bin(table: &BrdfTable, mut visit: impl FnMut(usize, [[f64; 2]; 2]) -> Checked<()>) -> Checked<()> {
    let bins = table.grid.bins();
    for incidence in 0..table.grid.incidences() {
        let light = table.grid.incidence_deg(incidence);
        for (bin, (theta, phi)) in middles_deg(&table.grid, incidence).into_iter().enumerate() {
            if !table.is_gap(incidence * bins + bin) {
                visit(incidence * bins + bin, [[light.0, light.1], [theta, phi]])?;
            }
        }
    }
    Ok(())
}

fn write(table: &BrdfTable, colours: &[(f64, usize)], out: &mut dyn Write) -> Checked<()> {
    // 450/1e9 is the number next to 450 nm; 450e-9 may be its neighbour.
    let metres: Vec<f64> = colours.iter().map(|(nm, _)| nm / 1e9).collect();
    let mut rows: Vec<([f64; 3], usize)> = Vec::new();
    each_bin(table, |entry, [light, sensor]| {
        let phi = sphere::reduced_deg(sensor[1] - light[1]).to_radians().rem_euclid(TAU);
        rows.push(([light[0].to_radians(), sensor[0].to_radians(), phi], entry));
        Ok(())
    })?;
    rows.sort_by(|(a, _), (b, _)| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    let mut brdf = json!({ "wavelengths": metres });
    if let Some(angle) = receiver(table) {
        let each = metres.iter().map(|metres| json!({ "wavelength": metres, "solidAngle": angle }));
        brdf["receiverSolidAngles"] = each.collect();
    }
    let text = |value: &serde_json::Value| value.to_string();
    let head = text(&brdf);
    write!(
        out,
        "{{\"metadata\":{},\n\"brdf\":{},\"lookupTable\":[",
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

/// The solid angle of the sensor's aperture where all bins are of one.
fn receiver(table: &BrdfTable) -> Option<f64> {
    let half = |region: &Region| match region {
        Region::Cap { half_angle, .. } if *half_angle > 0.0 => Some(*half_angle),
        _ => None,
    };
    let regions = table.grid.regions(0);
    let first = half(regions.first()?)?;
    // 2 pi (1 - cos h), without cancellation.
    regions.iter().all(|region| half(region) == Some(first)).then(|| 2.0 * TAU * (0.5 * first).sin().powi(2))
}

/// What is known of the table; the same table has the same UUID.
fn metadata(table: &BrdfTable) -> serde_json::Value {
    let mut hash = Sha256::new();
    hash.update(table.campaign.as_bytes());
    for value in table.colours.iter().flat_map(|colour| &colour.total) {
        hash.update(value.to_le_bytes());
    }
    let mut bytes = [0; 16];
    bytes.copy_from_slice(&hash.finalize()[..16]);
    // Version 8 of RFC 9562: bits of the writer's own.
    (bytes[6], bytes[8]) = (0x80 | bytes[6] & 0x0f, 0x80 | bytes[8] & 0x3f);
    let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    let uuid = [&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]].join("-");
    let campaign: Option<toml::Table> = table.campaign.parse().ok();
    let name = campaign.as_ref().and_then(|campaign| campaign.get("name")?.as_str().map(String::from));
    json!({
        "name": name.unwrap_or_else(|| "imported table".into()),
        "uuid": uuid,
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

/// The pairs of a file with a value for each wavelength.
fn read(bytes: &[u8]) -> Checked<(Vec<MeasuredPair>, Columns)> {
    let file: LookupFile =
        serde_json::from_slice(bytes).map_err(|e| wrong!("no look-up table of OpenMATERIAL: {e}"))?;
    let rows =
        file.brdf.rows.iter().enumerate().filter_map(|(k, row)| row[4].map(|value| (k + 1, row, value)));
    let mut known: Vec<(usize, f64, [f64; 3], f64)> = Vec::new();
    for (number, row, value) in rows {
        let &[Some(metres), Some(theta_i), Some(theta_r), Some(phi), _] = row else {
            return Err(wrong!("row {number}: a value without its wavelength or angles"));
        };
        if !(1e-9..=0.02).contains(&metres) || value < 0.0 {
            return Err(wrong!(
                "row {number}: wavelength {metres} m, BRDF {value} 1/sr: 1e-9 to 0.02, and 0 or more needed"
            ));
        }
        // Nanometres to a millionth, degrees to eight digits: what the decimals of such files are worth.
        let nm = (metres * 1e15).round() / 1e6;
        let degrees = [theta_i, theta_r, phi].map(|angle| (angle.to_degrees() * 1e8).round() / 1e8);
        known.push((number, nm, degrees, value));
    }
    if known.is_empty() {
        return Err("no samples: every row is without a value, or there is none".into());
    }
    let mut wavelengths: Vec<f64> = known.iter().map(|(_, nm, ..)| *nm).collect();
    wavelengths.sort_by(f64::total_cmp);
    wavelengths.dedup();
    let names: Vec<String> = wavelengths.iter().map(|nm| format!("{nm}nm")).collect();
    let columns = Columns::of(&names.iter().map(String::as_str).collect::<Vec<_>>(), 4)?;
    let (mut pairs, mut places) = (Vec::<MeasuredPair>::new(), HashMap::new());
    for (number, nm, [theta_i, theta_r, phi], value) in known {
        let (light, sensor) = ([theta_i, 0.0], [theta_r, phi]);
        let place = *places.entry((key(light), key(sensor))).or_insert_with(|| {
            let values: ColourValues = wavelengths.iter().map(|_| f32::NAN).collect();
            pairs.push(MeasuredPair {
                light,
                sensor,
                values,
                errors: ColourValues::new(),
                hits: None,
                line: number,
            });
            pairs.len() - 1
        });
        let at = wavelengths.binary_search_by(|known| known.total_cmp(&nm)).unwrap_or_default();
        let slot = &mut pairs[place].values[at];
        if !slot.is_nan() && !samples::alike(f64::from(*slot), value) {
            return Err(wrong!("row {number}: its directions have {slot} already, and {value} here"));
        }
        *slot = value as f32;
    }
    let holed =
        pairs.iter().find_map(|pair| Some((pair, pair.values.iter().position(|value| value.is_nan())?)));
    if let Some((pair, at)) = holed {
        return Err(wrong!(
            "row {}: its directions have no value at {} nm; every pair needs all wavelengths",
            pair.line,
            wavelengths[at]
        ));
    }
    Ok((pairs, columns))
}
