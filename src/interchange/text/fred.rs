//! FRED's tabulated BSDF text (Photon Engineering): a line for each direction of mirrored light, followed by a line for each
//! direction of scattered light with its value.
//!
//! Two header lines, `type bsdf_data` and `format angles=deg bsdf=value scale=1`; then `theta_spec phi_spec` and lines
//! `theta_scat phi_scat BSDF`, degrees from the normal. The model is isotropic. Where angles are direction cosines
//! (`angles=sin`) or values logarithms (`bsdf=log`) the descriptions say neither their order nor the base: such files are
//! refused. Source: FRED's help on the tabulated BSDF, its script reference, and a published description of the file.

use std::io::{BufRead, Write};
use std::path::Path;

use super::named_columns::{ColourValues, Columns};
use super::samples::{self, MeasuredPair};
use crate::error::wrong;
use crate::interchange::codec::{self, Codec, Encoded, FileContent, FormatTraits};
use crate::interchange::read_back::{ReadBack, digits, middles_deg, upper};
use crate::interchange::{Checked, Imported, Options, needed};
use crate::sphere;
use crate::table::BrdfTable;
use crate::text_decoding::decode_text_or_latin1;

/// How the values are meant.
const CONVENTION: &str = "a line theta phi for each mirror direction of the light, then a line theta phi BSDF for each direction of \
    the sensor; degrees from the normal, the mirror direction at phi 0; 1/sr, no cosine; the middle of each bin";
const TYPE: &str = "type bsdf_data";
/// The word of the second line.
const FORMAT: &str = "format";

/// The format.
pub struct Fred;

impl Codec for Fred {
    fn traits(&self) -> FormatTraits {
        FormatTraits { gaps: true, colours: false, ..FormatTraits::totals("fred") }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        needed::list(bytes)
    }

    fn decode(&self, bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Ok((read(bytes)?.into(), vec![]))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &Options) -> Checked<Encoded<'a>> {
        if !table.grid.is_isotropic() {
            return Err("FRED's tables are isotropic: measure with azimuth = \"relative\"".into());
        }
        let zeros = table.colours[0].total.iter().enumerate();
        let zeros = zeros.filter(|(entry, value)| **value == 0.0 && !table.is_gap(*entry)).count();
        let note = || format!("{zeros} values are 0, and FRED asks for values above: set its smallest BSDF");
        Ok(Encoded {
            content: FileContent::Stream(Box::new(move |out| write(table, out))),
            convention: CONVENTION.into(),
            notes: (zeros > 0).then(note).into_iter().collect(),
        })
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, _options: &Options) -> Checked<Option<ReadBack>> {
        let file = codec::open(path)?;
        // The file's azimuths count from the mirror direction.
        let turn = table.grid.incidence_deg(0).1;
        let turned = |mut pair: MeasuredPair| {
            pair.light[1] += turn;
            pair.sensor[1] += turn;
            pair
        };
        samples::listed(table, 1e-8, |visit| each_pair(file, |pair| visit(turned(pair))))?.finish()
    }
}

/// Writes the totals of a table of one channel; a gap has no line.
fn write(table: &BrdfTable, out: &mut dyn Write) -> Checked<()> {
    writeln!(out, "{TYPE}\n{FORMAT} angles=deg bsdf=value scale=1")?;
    let bins = table.grid.bins();
    for incidence in 0..table.grid.incidences() {
        let (theta_i, phi_i) = table.grid.incidence_deg(incidence);
        writeln!(out, "{theta_i} 0")?;
        for (bin, (theta, phi)) in middles_deg(&table.grid, incidence).into_iter().enumerate() {
            if !table.is_gap(incidence * bins + bin) {
                let phi = digits(sphere::reduced_deg(phi - phi_i - 180.0));
                writeln!(out, "{theta} {phi} {:e}", table.colours[0].total[incidence * bins + bin])?;
            }
        }
    }
    Ok(())
}

/// The table of points of a file.
// Tested by `fred_comes_back`, `damaged_fred_files_are_refused` (tests/it/interchange/interchange_fred.rs).
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    let text = decode_text_or_latin1(bytes)?;
    let mut pairs = Vec::new();
    each_pair(text.as_bytes(), |pair| {
        pairs.push(pair);
        Ok(())
    })?;
    samples::table(&pairs, &Columns::of(&["value"], 4)?, true)
}

/// Visits the pairs of a file, the light at azimuth 0.
fn each_pair(file: impl BufRead, mut visit: impl FnMut(MeasuredPair) -> Checked<()>) -> Checked<()> {
    let mut lines = file.lines().enumerate().map(|(k, line)| (k + 1, line));
    let mut next = || -> Checked<Option<(usize, String)>> {
        for (number, line) in lines.by_ref() {
            let line = line.map_err(|e| e.to_string())?;
            if !line.trim().is_empty() {
                return Ok(Some((number, line)));
            }
        }
        Ok(None)
    };
    let words = |line: Option<(usize, String)>| {
        line.map(|(_, line)| line.split_whitespace().map(str::to_string).collect()).unwrap_or_default()
    };
    let head: Vec<String> = words(next()?);
    if head.iter().ne(TYPE.split(' ')) {
        return Err(wrong!("`{TYPE}` needed at the beginning: not a BSDF file of FRED"));
    }
    let scale = scale(&words(next()?))?;
    let mut specular: Option<[f64; 2]> = None;
    while let Some((number, line)) = next()? {
        let numbers = numbers(number, &line)?;
        match (&numbers[..], specular) {
            (&[theta, phi], _) => specular = Some(direction(number, [theta, phi])?),
            (&[theta, phi, value], Some([theta_i, phi_spec])) => {
                let [theta, phi] = direction(number, [theta, phi])?;
                let value = value * scale;
                if !(value >= 0.0 && value <= f64::from(f32::MAX)) {
                    return Err(wrong!("line {number}: BSDF {value} 1/sr: 0 or more needed"));
                }
                let values: ColourValues = [value as f32].into_iter().collect();
                visit(MeasuredPair {
                    light: [theta_i, 0.0],
                    sensor: [theta, digits(sphere::reduced_deg(phi - phi_spec + 180.0))],
                    values,
                    errors: ColourValues::new(),
                    hits: None,
                    line: number,
                })?;
            }
            (&[_, _, _], None) => {
                return Err(wrong!("line {number}: a value before `theta phi` of a mirror direction"));
            }
            (found, _) => {
                return Err(wrong!(
                    "line {number}: {} numbers: theta phi of a mirror direction, or theta phi BSDF, needed",
                    found.len()
                ));
            }
        }
    }
    Ok(())
}

/// The finite numbers of a line.
fn numbers(number: usize, line: &str) -> Checked<Vec<f64>> {
    let one = |word: &str| word.parse().ok().filter(|value: &f64| value.is_finite());
    let words = line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    words.map(|word| one(word).ok_or_else(|| wrong!("line {number}: `{word:.40}` is no number"))).collect()
}

/// A polar angle of 0 or more, and an azimuth; a negative polar angle is the far side of its plane.
fn direction(number: usize, angles: [f64; 2]) -> Checked<[f64; 2]> {
    let [theta, phi] = upper(angles);
    if theta > 90.0 || phi.abs() > 360.0 {
        return Err(wrong!(
            "line {number}: theta {}, phi {}: within 90 degrees of the normal needed",
            angles[0],
            angles[1]
        ));
    }
    Ok([theta, phi])
}

/// The factor of all values that the second line names.
fn scale(words: &[String]) -> Checked<f64> {
    let needed = || wrong!("`{FORMAT} angles=deg bsdf=value scale=1` needed as the second line");
    let [head, rest @ ..] = words else { return Err(needed()) };
    let (mut angles, mut values, mut scale) = (None, None, 1.0);
    for word in rest {
        match word.split_once('=') {
            Some(("angles", kind)) => angles = Some(kind),
            Some(("bsdf", kind)) => values = Some(kind),
            Some(("scale", factor)) => {
                let one = factor.parse().ok().filter(|factor: &f64| *factor > 0.0 && factor.is_finite());
                scale = one.ok_or_else(|| wrong!("scale={factor:.40}: a number above 0 needed"))?;
            }
            _ => return Err(needed()),
        }
    }
    match (head.as_str(), angles, values) {
        (FORMAT, Some("deg"), Some("value")) => Ok(scale),
        (FORMAT, Some("sin"), _) => {
            Err("angles=sin: degrees needed, the order of direction cosines is not described".into())
        }
        (FORMAT, _, Some("log")) => {
            Err("bsdf=log: values needed, the base of the logarithm is not described".into())
        }
        _ => Err(needed()),
    }
}
