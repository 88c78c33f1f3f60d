//! What the table's files have in common: checks of values, channels in and out, the digest.

use std::collections::BTreeMap;

use crate::error::{Checked, wrong};
use crate::files::image::{ImagePart, Samples};

use super::brdf_table::named_wavelength;
use super::content_digest::ContentDigest;
pub(super) use super::content_digest::DIGEST;
use super::gaps::{NOT_KNOWN, NOT_MEASURED};
use super::grid_attribute::{GRID, check_grid};
use super::{BrdfTable, SchlickSums};

/// Layers of the Mueller matrix, row by row: the light that leaves by the light that comes.
pub const MUELLER_ELEMENTS: [&str; 16] = [
    "m00", "m01", "m02", "m03", "m10", "m11", "m12", "m13", "m20", "m21", "m22", "m23", "m30", "m31", "m32",
    "m33",
];

/// Name of the attribute of the albedos' errors: a number for each incidence and colour, incidence major.
const ALBEDO_SE: &str = "gonio.albedo_se";

/// A table's channel where it lies.
#[derive(Clone, Copy)]
pub(crate) enum Plane<'a> {
    /// FLOAT.
    F32(&'a [f32]),
    /// UINT.
    U32(&'a [u32]),
}

impl Plane<'_> {
    fn len(&self) -> usize {
        match self {
            Plane::F32(values) => values.len(),
            Plane::U32(values) => values.len(),
        }
    }

    /// Without values: the type alone.
    pub fn kind(&self) -> Samples {
        match self {
            Plane::F32(_) => Samples::F32(vec![]),
            Plane::U32(_) => Samples::U32(vec![]),
        }
    }

    /// Adds the bytes of some values, in the machine's order.
    pub fn bytes(&self, range: std::ops::Range<usize>, out: &mut Vec<u8>) {
        match self {
            Plane::F32(values) => out.extend(values[range].iter().flat_map(|value| value.to_ne_bytes())),
            Plane::U32(values) => out.extend(values[range].iter().flat_map(|value| value.to_ne_bytes())),
        }
    }
}

/// A table's channels by name, the first row being that of `first_incidence`; each must fit the grid and have values that a
/// measurement gives.
pub(crate) fn planes(table: &BrdfTable, first_incidence: usize) -> Checked<BTreeMap<String, Plane<'_>>> {
    let (incidences, bins) = check_grid(&table.grid)?;
    let mut planes = BTreeMap::new();
    for (name, colour) in distinct_names(table)?.iter().zip(&table.colours) {
        planes.insert(name.clone(), Plane::F32(&colour.total));
        planes.insert(format!("single.{name}"), Plane::F32(&colour.single));
        planes.insert(format!("multiple.{name}"), Plane::F32(&colour.multiple));
        planes.insert(format!("stderr.{name}"), Plane::F32(&colour.stderr));
        planes.insert(format!("stderr.single.{name}"), Plane::F32(&colour.stderr_single));
        if !colour.left_map.is_empty() {
            planes.insert(format!("left_map.{name}"), Plane::F32(&colour.left_map));
        }
        for (order, values) in (2..).zip(&colour.orders) {
            planes.insert(format!("order{order}.{name}"), Plane::F32(values));
        }
        for (element, (values, errors)) in
            MUELLER_ELEMENTS.iter().zip(colour.mueller.iter().zip(&colour.stderr_mueller))
        {
            planes.insert(format!("{element}.{name}"), Plane::F32(values));
            planes.insert(format!("stderr.{element}.{name}"), Plane::F32(errors));
        }
    }
    let sums = table.schlick.iter().flat_map(|sums| sums.channels(table.is_by_order()));
    planes.extend(sums.map(|(name, values)| (name, Plane::F32(values))));
    planes.insert("hits".into(), Plane::U32(&table.hits));
    for (name, plane) in &planes {
        if plane.len() != incidences * bins {
            return Err(wrong!("channel `{name}` has {} values, {} needed", plane.len(), incidences * bins));
        }
        if let Plane::F32(values) = plane {
            check_values(name, values, bins, first_incidence)?;
        }
    }
    Ok(planes)
}

/// Adds a FLOAT channel, which must fit the part and have values that a measurement gives.
pub(super) fn insert(part: &mut ImagePart, name: &str, values: &[f32]) -> Checked<()> {
    let pixels = part.width * part.height;
    if values.len() != pixels {
        return Err(wrong!("channel `{name}` has {} values, {pixels} needed", values.len()));
    }
    check_values(name, values, part.width, 0)?;
    part.channels.insert(name.into(), Samples::F32(values.to_vec()));
    Ok(())
}

/// Takes a FLOAT channel out of a part, the first row of which is that of `first_incidence`; its values must be such as a
/// measurement gives.
pub(super) fn take(part: &mut ImagePart, name: &str, first_incidence: usize) -> Checked<Vec<f32>> {
    match part.channels.remove(name) {
        Some(Samples::F32(values)) => {
            check_values(name, &values, part.width, first_incidence).map(|()| values)
        }
        Some(Samples::F16(_)) => Err(wrong!("channel `{name}` is HALF, FLOAT needed")),
        Some(Samples::U32(_)) => Err(wrong!("channel `{name}` is UINT, FLOAT needed")),
        None => Err(wrong!("channel `{name}` is missing")),
    }
}

/// Refuses what no measurement gives: values and errors are finite, and none is below 0; an error that is not known, or
/// of what was not measured, has a number of its own.
fn check_values(name: &str, values: &[f32], width: usize, first_incidence: usize) -> Checked<()> {
    let least = if may_be_negative(name) { f32::MIN } else { 0.0 };
    let is_mark = |value: f32| name.starts_with("stderr.") && [NOT_KNOWN, NOT_MEASURED].contains(&value);
    match values.iter().position(|&value| !(least..=f32::MAX).contains(&value) && !is_mark(value)) {
        Some(at) => {
            let (incidence, bin, value) = (first_incidence + at / width, at % width, values[at]);
            let what = if value.is_finite() { "is below 0" } else { "is not a finite number" };
            Err(wrong!("channel `{name}`, incidence {incidence}, bin {bin}: {value} {what}"))
        }
        None => Ok(()),
    }
}

/// Elements of the Mueller matrix, and the coefficients of a polynomial in F0.
fn may_be_negative(name: &str) -> bool {
    name.contains("parts.") || MUELLER_ELEMENTS.iter().any(|element| name.starts_with(element))
}

/// A colour's name, and the wavelength that it stands for.
pub(super) type ColourName = (String, Option<f64>);

/// The colours that a part's channels speak of, wavelengths in their order.
pub(super) fn colour_names(part: &ImagePart) -> Checked<Vec<ColourName>> {
    let has = |name: &str| part.channels.contains_key(name);
    let plain = |names: &[&str]| names.iter().map(|name| (name.to_string(), None)).collect();
    let waves = part.channels.keys().filter_map(|name| Some((name.clone(), named_wavelength(name)?)));
    let mut waves: Vec<(String, f64)> = waves.collect();
    waves.sort_by(|a, b| a.1.total_cmp(&b.1));
    match (has("Y"), has("R") || has("G") || has("B"), waves.is_empty()) {
        (true, false, true) => Ok(plain(&["Y"])),
        (false, true, true) => Ok(plain(&["R", "G", "B"])),
        (false, false, false) => Ok(waves.into_iter().map(|(name, nm)| (name, Some(nm))).collect()),
        (false, false, true) => Err("neither a `Y` channel nor `R G B`, nor one for each wavelength".into()),
        _ => Err("channels of more than one kind among `Y`, `R G B` and wavelengths".into()),
    }
}

/// The channel names of a table's colours; colours that are not distinguished are a reason to refuse it.
pub(super) fn distinct_names(table: &BrdfTable) -> Checked<Vec<String>> {
    let names = table.colour_names();
    let spectral = table.colours.iter().filter(|colour| colour.wavelength_nm.is_some()).count();
    let plain = matches!(names.len(), 1 | 3) && spectral == 0;
    let increasing = table.colours.windows(2).all(|pair| pair[0].wavelength_nm < pair[1].wavelength_nm);
    if plain || (spectral == names.len() && spectral > 0 && increasing) {
        return Ok(names);
    }
    Err(wrong!("{} colours; 1 or 3 needed, or each with its wavelength, in increasing order", names.len()))
}

/// Adds the sums of Schlick's formula.
pub(super) fn insert_schlick(
    part: &mut ImagePart,
    sums: Option<&SchlickSums>,
    by_order: bool,
) -> Checked<()> {
    let channels = sums.map(|sums| sums.channels(by_order)).unwrap_or_default();
    channels.into_iter().try_for_each(|(name, values)| insert(part, &name, values))
}

/// Takes the sums of Schlick's formula, where they are there.
pub(super) fn take_schlick(part: &mut ImagePart, first_incidence: usize) -> Checked<Option<SchlickSums>> {
    SchlickSums::gathered(|name| match part.channels.contains_key(name) {
        true => take(part, name, first_incidence).map(Some),
        false => Ok(None),
    })
}

/// Sets the errors of albedos where there are any: every number as wide as the next, so that the length of the text is
/// known before the numbers are.
pub(super) fn set_albedo_errors(part: &mut ImagePart, errors: &[Vec<f32>], incidences: usize) {
    if errors.iter().any(Vec::is_empty) {
        return;
    }
    let of_incidence =
        |incidence: usize| errors.iter().map(move |colour| colour.get(incidence).copied().unwrap_or(0.0));
    let numbers = (0..incidences).flat_map(of_incidence).map(|se| format!("{se:>15.8e}"));
    part.set_text(ALBEDO_SE, &numbers.collect::<Vec<_>>().join("\n"));
}

/// The errors of the albedos of each colour at some incidences, empty where the part has none.
pub(super) fn albedo_errors(
    part: &ImagePart,
    colours: usize,
    incidences: &[usize],
    of: usize,
) -> Checked<Vec<Vec<f32>>> {
    let Some(text) = part.text(ALBEDO_SE) else { return Ok(vec![Vec::new(); colours]) };
    let number = |word: &str| word.parse().ok().filter(|se: &f32| se.is_finite() && *se >= 0.0);
    let all: Option<Vec<f32>> = text.split_whitespace().map(number).collect();
    let all = all.filter(|all| all.len() == of * colours).ok_or_else(|| {
        format!("{ALBEDO_SE}: {} numbers from 0 up needed, one for each incidence and colour", of * colours)
    })?;
    let of_colour =
        |colour: usize| incidences.iter().map(|incidence| all[incidence * colours + colour]).collect();
    Ok((0..colours).map(of_colour).collect())
}

/// The sums of a content that is at hand.
pub(super) fn content_of(part: &ImagePart) -> ContentDigest {
    let mut content = ContentDigest::default();
    for (name, samples) in &part.channels {
        content.add_samples(name, samples);
    }
    content
}

/// Compares a part's digest with its content; a missing one is a warning.
///
/// `origin` is the text that older digests held next to the grid: the patches' digest, or the table's.
pub(super) fn check_digest(part: &ImagePart, origin: &str, warnings: &mut Vec<String>) -> Checked<()> {
    match part.text(DIGEST) {
        None => {
            warnings.push(no_digest());
            Ok(())
        }
        Some(stored) => same_digest(stored, &content_of(part), part, origin),
    }
}

/// What is said of a file without digest.
pub(super) fn no_digest() -> String {
    format!("no {DIGEST} attribute: changes of the content cannot be noticed")
}

/// The digest that is stored must be that of the content and of the part's texts.
pub(super) fn same_digest(
    stored: &str,
    content: &ContentDigest,
    part: &ImagePart,
    origin: &str,
) -> Checked<()> {
    let found = content.finish(part);
    if stored == found {
        return Ok(());
    }
    if stored == content.finish_2(part.text(GRID).unwrap_or_default(), origin) {
        return Err(wrong!(
            "{DIGEST} is of an older version, which left the campaign and the other texts out: a change of them \
             could not be noticed; measure it again"
        ));
    }
    Err(wrong!(
        "{DIGEST} says {stored}, the content gives {found}: the file was changed or damaged, or is older than \
         digests by channel; measure it again"
    ))
}
