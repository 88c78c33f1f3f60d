//! What the table's files have in common: checks of grid and values, channels in and out, the digest.

use std::collections::BTreeMap;

use crate::error::{Checked, wrong};
use crate::files::image::{ImagePart, Samples};
use crate::instrument::Grid;
use crate::instrument::grid::GridKind;

use super::brdf_table::named_wavelength;
use super::content_digest::ContentDigest;
pub(super) use super::content_digest::DIGEST;
use super::{BrdfTable, SchlickSums};

/// Name of the grid's attribute.
pub(super) const GRID: &str = "gonio.grid";

/// Layers of the Mueller matrix, row by row: the light that leaves by the light that comes.
pub const MUELLER_ELEMENTS: [&str; 16] = [
    "m00", "m01", "m02", "m03", "m10", "m11", "m12", "m13", "m20", "m21", "m22", "m23", "m30", "m31", "m32",
    "m33",
];

/// Name of the attribute of the albedos' errors: a number for each incidence and colour, incidence major.
const ALBEDO_SE: &str = "gonio.albedo_se";

/// Incidences and bins of a grid; an axis that no instrument has is a reason to refuse it.
// Tested by `axes_that_no_instrument_has_are_refused`.
pub fn check_grid(grid: &Grid) -> Checked<(usize, usize)> {
    if grid.kind == GridKind::HalfDifference {
        return half_difference(grid);
    }
    if grid.stops_deg.is_empty() {
        axis("theta_i_deg", &grid.theta_i_deg, 1, 0.0..=90.0)?;
        axis("phi_i_deg", &grid.phi_i_deg, 1, -360.0..=360.0)?;
    } else {
        if !grid.theta_i_deg.is_empty() || !grid.phi_i_deg.is_empty() {
            return Err(wrong!(
                "{GRID}: stops_deg next to the axes theta_i_deg and phi_i_deg: only one is allowed"
            ));
        }
        directions("stops_deg", &grid.stops_deg, 90.0)?;
    }
    match grid.kind {
        GridKind::Hemisphere => {
            axis("theta_r_edges_deg", &grid.theta_r_edges_deg, 2, 0.0..=180.0)?;
            increasing("theta_r_edges_deg", &grid.theta_r_edges_deg)?;
            off_horizon("theta_r_edges_deg", &grid.theta_r_edges_deg)?;
            axis("phi_r_edges_deg", &grid.phi_r_edges_deg, 2, -720.0..=720.0)?;
            increasing("phi_r_edges_deg", &grid.phi_r_edges_deg)?;
        }
        GridKind::Arm => {
            axis("theta_r_deg", &grid.theta_r_deg, 1, -180.0..=180.0)?;
            axis("phi_r_deg", &grid.phi_r_deg, 1, -360.0..=360.0)?;
            axis("aperture_deg", grid.aperture_deg.as_slice(), 1, 0.0..=90.0)?;
        }
        GridKind::Points => directions("points_deg", &grid.points_deg, 180.0)?,
        GridKind::Patches => patches(&grid.patches_deg)?,
        GridKind::HalfDifference => {}
    }
    Ok((grid.stops(), grid.bins()))
}

/// Axes of half vectors and differences; others are of no use next to them.
fn half_difference(grid: &Grid) -> Checked<(usize, usize)> {
    if !(grid.theta_i_deg.is_empty() && grid.phi_i_deg.is_empty() && grid.stops_deg.is_empty()) {
        return Err(wrong!("{GRID}: incidences next to half/difference angles: only one is allowed"));
    }
    let axes = [
        ("theta_h_deg", &grid.theta_h_deg, 90.0),
        ("phi_h_deg", &grid.phi_h_deg, 360.0),
        ("theta_d_deg", &grid.theta_d_deg, 90.0),
        ("phi_d_deg", &grid.phi_d_deg, 180.0),
    ];
    for (name, values, most) in axes {
        axis(name, values, 1, 0.0..=most)?;
        increasing(name, values)?;
        if most > 90.0 && values.last() == Some(&most) {
            return Err(wrong!("{GRID}: {name} = {most} already exists, as 0"));
        }
    }
    Ok((grid.stops(), grid.bins()))
}

fn axis(name: &str, values: &[f64], least: usize, range: std::ops::RangeInclusive<f64>) -> Checked<()> {
    if values.len() < least {
        return Err(wrong!("{GRID}: {name} has {} values, at least {least} needed", values.len()));
    }
    match values.iter().find(|value| !range.contains(value)) {
        Some(value) => {
            Err(wrong!("{GRID}: {name} = {value} lies outside [{}, {}]", range.start(), range.end()))
        }
        None => Ok(()),
    }
}

/// A bin on both sides of the surface has no meaning.
fn off_horizon(name: &str, edges: &[f64]) -> Checked<()> {
    match edges.windows(2).find(|pair| pair[0] < 90.0 && 90.0 < pair[1]) {
        Some(pair) => {
            Err(wrong!("{GRID}: {name}: the horizon, 90, lies between {} and {}", pair[0], pair[1]))
        }
        None => Ok(()),
    }
}

/// Polar angles up to `most`, and azimuths.
fn directions(name: &str, values: &[[f64; 2]], most: f64) -> Checked<()> {
    axis(name, &values.iter().map(|d| d[0]).collect::<Vec<_>>(), 1, 0.0..=most)?;
    axis(name, &values.iter().map(|d| d[1]).collect::<Vec<_>>(), 1, -360.0..=360.0)
}

fn patches(values: &[[f64; 4]]) -> Checked<()> {
    axis("patches_deg", &values.iter().flat_map(|p| [p[0], p[1]]).collect::<Vec<_>>(), 2, 0.0..=180.0)?;
    values.iter().try_for_each(|patch| off_horizon("patches_deg", &patch[..2]))?;
    axis("patches_deg", &values.iter().flat_map(|p| [p[2], p[3]]).collect::<Vec<_>>(), 2, -720.0..=720.0)?;
    match values.iter().find(|p| p[0] >= p[1] || p[2] >= p[3] || p[3] - p[2] > 360.0) {
        Some(p) => Err(wrong!("{GRID}: the patch {p:?} is empty or wider than a turn")),
        None => Ok(()),
    }
}

fn increasing(name: &str, values: &[f64]) -> Checked<()> {
    match values.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => Err(wrong!("{GRID}: {name} does not increase from {} to {}", pair[0], pair[1])),
        None => Ok(()),
    }
}

/// The grid as the text of its attribute.
pub(super) fn grid_text(grid: &Grid) -> Checked<String> {
    serde_json::to_string(grid).map_err(|e| wrong!("{GRID}: {e}"))
}

/// The grid that a part carries; its size must be the part's.
pub(super) fn read_grid(part: &ImagePart) -> Checked<Grid> {
    let text = part.text(GRID).ok_or_else(|| format!("no {GRID} attribute: not a table of this program"))?;
    let grid: Grid = serde_json::from_str(text).map_err(|e| format!("{GRID}: {e}"))?;
    let (stops, bins) = check_grid(&grid)?;
    if (stops, bins) == (part.height, part.width) {
        return Ok(grid);
    }
    let (width, height) = (part.width, part.height);
    Err(wrong!("{GRID} says {stops} incidences and {bins} bins, the image is {width} wide and {height} high"))
}

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

/// A table's channels by name, the first row being that of `first_stop`; each must fit the grid and be finite.
pub(crate) fn planes(table: &BrdfTable, first_stop: usize) -> Checked<BTreeMap<String, Plane<'_>>> {
    let (stops, bins) = check_grid(&table.grid)?;
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
        if plane.len() != stops * bins {
            return Err(wrong!("channel `{name}` has {} values, {} needed", plane.len(), stops * bins));
        }
        if let Plane::F32(values) = plane {
            check_finite(name, values, bins, first_stop)?;
        }
    }
    Ok(planes)
}

/// Adds a FLOAT channel, which must fit the part and be finite.
pub(super) fn insert(part: &mut ImagePart, name: &str, values: &[f32]) -> Checked<()> {
    let pixels = part.width * part.height;
    if values.len() != pixels {
        return Err(wrong!("channel `{name}` has {} values, {pixels} needed", values.len()));
    }
    check_finite(name, values, part.width, 0)?;
    part.channels.insert(name.into(), Samples::F32(values.to_vec()));
    Ok(())
}

/// Takes a FLOAT channel out of a part, the first row of which is that of `first_stop`; its values must be finite.
pub(super) fn take(part: &mut ImagePart, name: &str, first_stop: usize) -> Checked<Vec<f32>> {
    match part.channels.remove(name) {
        Some(Samples::F32(values)) => check_finite(name, &values, part.width, first_stop).map(|()| values),
        Some(Samples::F16(_)) => Err(wrong!("channel `{name}` is HALF, FLOAT needed")),
        Some(Samples::U32(_)) => Err(wrong!("channel `{name}` is UINT, FLOAT needed")),
        None => Err(wrong!("channel `{name}` is missing")),
    }
}

fn check_finite(name: &str, values: &[f32], width: usize, first_stop: usize) -> Checked<()> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(at) => {
            let (stop, bin, value) = (first_stop + at / width, at % width, values[at]);
            Err(wrong!("channel `{name}`, incidence {stop}, bin {bin}: {value} is not a finite number"))
        }
        None => Ok(()),
    }
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
pub(super) fn take_schlick(part: &mut ImagePart, first_stop: usize) -> Checked<Option<SchlickSums>> {
    SchlickSums::gathered(|name| match part.channels.contains_key(name) {
        true => take(part, name, first_stop).map(Some),
        false => Ok(None),
    })
}

/// Sets the errors of albedos where there are any: every number as wide as the next, so that the length of the text is
/// known before the numbers are.
pub(super) fn set_albedo_errors(part: &mut ImagePart, errors: &[Vec<f32>], stops: usize) {
    if errors.iter().any(Vec::is_empty) {
        return;
    }
    let of_stop = |stop: usize| errors.iter().map(move |colour| colour.get(stop).copied().unwrap_or(0.0));
    let numbers = (0..stops).flat_map(of_stop).map(|se| format!("{se:>15.8e}"));
    part.set_text(ALBEDO_SE, &numbers.collect::<Vec<_>>().join("\n"));
}

/// The errors of the albedos of each colour at some incidences, empty where the part has none.
pub(super) fn albedo_errors(
    part: &ImagePart,
    colours: usize,
    stops: &[usize],
    of: usize,
) -> Checked<Vec<Vec<f32>>> {
    let Some(text) = part.text(ALBEDO_SE) else { return Ok(vec![Vec::new(); colours]) };
    let number = |word: &str| word.parse().ok().filter(|se: &f32| se.is_finite() && *se >= 0.0);
    let all: Option<Vec<f32>> = text.split_whitespace().map(number).collect();
    let all = all.filter(|all| all.len() == of * colours).ok_or_else(|| {
        format!("{ALBEDO_SE}: {} numbers from 0 up needed, one for each incidence and colour", of * colours)
    })?;
    let of_colour = |colour: usize| stops.iter().map(|stop| all[stop * colours + colour]).collect();
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

#[cfg(test)]
mod tests {
    use super::super::test_tables::table;
    use super::*;

    #[test]
    fn angles_come_back_from_the_grid_text_bit_for_bit() {
        let mut grid = table(1).grid;
        let mut state = 1_u64;
        grid.theta_i_deg = (0..20_000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 11) as f64 / (1_u64 << 53) as f64 * 90.0
            })
            .collect();
        let back: Grid = serde_json::from_str(&grid_text(&grid).expect("prints")).expect("parses");
        assert!(back == grid);
    }

    #[test]
    fn axes_that_no_instrument_has_are_refused() {
        let reason = |change: fn(&mut Grid)| {
            let mut grid = table(1).grid;
            change(&mut grid);
            check_grid(&grid).expect_err("must be refused").to_string()
        };
        assert!(reason(|g| g.phi_r_edges_deg.clear()).contains("phi_r_edges_deg has 0 values"));
        assert!(reason(|g| g.theta_r_edges_deg.swap(0, 1)).contains("does not increase"));
        assert!(reason(|g| g.theta_i_deg[0] = f64::NAN).contains("theta_i_deg = NaN"));
        assert!(reason(|g| g.kind = GridKind::Arm).contains("theta_r_deg has 0 values"));
    }
}
