//! Lists with a row for each wavelength and pair of directions, as JSON formats have them: how they become measured pairs,
//! and which rows a table makes.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use super::named_columns::{ColourValues, Columns};
use super::samples::{self, MeasuredPair, key};
use crate::error::wrong;
use crate::interchange::options::NANOMETRES;
use crate::interchange::read_back::middles_deg;
use crate::interchange::{Checked, Options};
use crate::table::BrdfTable;

/// Wavelengths that a list may have, nm: from X-rays to radar.
pub const LISTED_NM: RangeInclusive<f64> = 1.0..=2e7;
/// The wavelength of rows that have none.
pub const NO_WAVELENGTH: f64 = 0.0;

/// A value of a file.
#[derive(Debug, Clone, Copy)]
pub struct SpectralRow {
    /// Where it stands, from 1.
    pub number: usize,
    /// Its wavelength; [`NO_WAVELENGTH`] in all rows of a file without.
    pub nm: f64,
    /// Polar angle and azimuth in degrees.
    pub light: [f64; 2],
    /// The same of the sensor.
    pub sensor: [f64; 2],
    /// In 1/sr, 0 or more.
    pub value: f64,
    /// Its standard error, where it is known.
    pub error: Option<f64>,
}

/// Nanometres to a millionth, what the decimals of metres and micrometres are worth.
pub fn whole_nm(nm: f64) -> f64 {
    (nm * 1e6).round() / 1e6
}

/// The pairs of a file's rows with a value for each wavelength. Errors are kept where every row has one.
pub fn pairs(rows: &[SpectralRow]) -> Checked<(Vec<MeasuredPair>, Columns)> {
    if rows.is_empty() {
        return Err("no samples: every row is without a value, or there is none".into());
    }
    let mut wavelengths: Vec<f64> = rows.iter().map(|row| row.nm).collect();
    wavelengths.sort_by(f64::total_cmp);
    wavelengths.dedup();
    let name = |nm: &f64| if *nm == NO_WAVELENGTH { "value".to_string() } else { format!("{nm}nm") };
    let names: Vec<String> = wavelengths.iter().map(name).collect();
    let columns = Columns::of(&names.iter().map(String::as_str).collect::<Vec<_>>(), 4)?;
    let unknown = || -> ColourValues { wavelengths.iter().map(|_| f32::NAN).collect() };
    let has_errors = rows.iter().all(|row| row.error.is_some());
    let (mut pairs, mut places) = (Vec::<MeasuredPair>::new(), HashMap::new());
    for row in rows {
        let place = *places.entry((key(row.light), key(row.sensor))).or_insert_with(|| {
            pairs.push(MeasuredPair {
                light: row.light,
                sensor: row.sensor,
                values: unknown(),
                errors: if has_errors { unknown() } else { ColourValues::new() },
                hits: None,
                line: row.number,
            });
            pairs.len() - 1
        });
        let at = wavelengths.binary_search_by(|known| known.total_cmp(&row.nm)).unwrap_or_default();
        let slot = &mut pairs[place].values[at];
        if !slot.is_nan() && !samples::alike(f64::from(*slot), row.value) {
            return Err(wrong!(
                "row {}: its directions have {slot} already, and {} here",
                row.number,
                row.value
            ));
        }
        *slot = row.value as f32;
        if let (true, Some(error)) = (has_errors, row.error) {
            pairs[place].errors[at] = error as f32;
        }
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

/// (wavelength in nm, colour) of the rows of a table, by increasing wavelength; `None`: wavelengths are missing.
/// `format` is the format's name in messages.
pub fn wavelengths(table: &BrdfTable, options: &Options, format: &str) -> Checked<Option<Vec<(f64, usize)>>> {
    let (own, given) = (table.wavelengths_nm(), &options.wavelengths_nm);
    let count = table.colours.len();
    if !own.is_empty() {
        let mut colours: Vec<(f64, usize)> = own.into_iter().zip(0..).collect();
        colours.sort_by(|a, b| a.0.total_cmp(&b.0));
        return Ok(Some(colours));
    }
    if given.len() != count {
        let (has, give) = match count {
            3 => ("R, G, B", "3 with --wavelengths-nm, of B, G and R"),
            _ if given.is_empty() => return Ok(None),
            _ => ("one channel", "1 with --wavelengths-nm"),
        };
        return Err(wrong!("{format}'s rows have a wavelength, the table has {has} without: give {give}"));
    }
    if !given.is_sorted_by(|a, b| a < b) || !given.iter().all(|nm| NANOMETRES.contains(nm)) {
        return Err(wrong!(
            "--wavelengths-nm {given:?}: increasing numbers of {} to {} nm needed",
            NANOMETRES.start(),
            NANOMETRES.end()
        ));
    }
    // Increasing wavelengths are B, G, R.
    Ok(Some(given.iter().copied().zip((0..count).rev()).collect()))
}

/// The polar angles of a table's lights and sensors, degrees.
pub fn polar_angles(table: &BrdfTable) -> impl Iterator<Item = f64> {
    let incidences = 0..table.grid.incidences();
    let sensors =
        incidences.clone().flat_map(|incidence| middles_deg(&table.grid, incidence)).map(|(theta, _)| theta);
    incidences.map(|incidence| table.grid.incidence_deg(incidence).0).chain(sensors)
}

/// Visits every bin that was measured: its entry, light and sensor in degrees.
pub fn each_bin(
    table: &BrdfTable,
    mut visit: impl FnMut(usize, [[f64; 2]; 2]) -> Checked<()>,
) -> Checked<()> {
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
