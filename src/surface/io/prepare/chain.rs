//! The steps of the preparation in their order, each with a sentence on what it did.

use super::cell_mask::CellMask;
use super::form::{self, Quadric};
use super::{MapGrid, detrend, filter, gaps, outliers};
use crate::campaign::{Detrend, Gaps, HeightMap, Outliers};
use crate::error::Checked;
use crate::files::memory;
use crate::surface::io::checks::check_precision;
use crate::surface::io::samples::MapSamples;

/// Gaps beyond this share of a map are the map.
const MOST_GAPS: f64 = 0.5;
/// Outliers that are listed with their places.
const LISTED: usize = 10;
/// Copies of the heights that the steps hold at most, of 8 bytes each.
const COPIES: u64 = 4;

/// What the preparation leaves besides the heights.
pub struct Prepared {
    /// Cells that no path starts on.
    pub excluded: Option<CellMask>,
    /// One sentence for each step.
    pub notes: Vec<String>,
}

/// Prepares the heights of a file, in place; `unit_um`: one unit of height.
pub fn prepare(
    map: &HeightMap,
    grid: &MapGrid,
    unit_um: Option<f64>,
    file: &mut MapSamples,
) -> Checked<Prepared> {
    let mut notes = Vec::new();
    memory::check(COPIES * 8 * file.heights.len() as u64)?;
    let excluded = without_gaps(map, grid, file, &mut notes)?;
    let heights = &mut file.heights;
    let filled: Vec<bool> = excluded.iter().flat_map(|gaps| gaps.filled.iter().copied()).collect();
    let mean = detrend::take_off_mean(heights);
    notes.push(format!("mean height {mean:.3e} taken off"));
    notes.extend(take_off_form(map, grid, &filled, heights)?);
    if map.preparation.outliers == Outliers::Keep {
        notes.extend(outliers::named(heights, grid.columns));
    }
    notes.extend(filtered(map, grid, unit_um, heights)?);
    Ok(Prepared { excluded: excluded.and_then(|gaps| gaps.excluded), notes })
}

/// The heights as the file has them, but for their mean and what has no data.
pub fn as_they_are(grid: &MapGrid, mut heights: Vec<f64>) -> Checked<Vec<f64>> {
    outliers::take_marks(&mut heights);
    gaps::fill(&mut heights, grid)?;
    detrend::take_off_mean(&mut heights);
    Ok(heights)
}

/// Samples that were filled, and cells that no path starts on.
struct Filled {
    filled: Vec<bool>,
    excluded: Option<CellMask>,
}

/// Fills what has no data and, where asked, what stands out; `None` where nothing was filled.
fn without_gaps(
    map: &HeightMap,
    grid: &MapGrid,
    file: &mut MapSamples,
    notes: &mut Vec<String>,
) -> Checked<Option<Filled>> {
    let (columns, count) = (grid.columns, file.heights.len());
    let steps = &map.preparation;
    let heights = &mut file.heights;
    if steps.gaps == Gaps::Refuse {
        refuse_gaps(heights, columns)?;
    } else {
        outliers::take_marks(heights);
    }
    let missing: Vec<bool> = heights.iter().map(|height| height.is_nan()).collect();
    let gaps = missing.iter().filter(|missing| **missing).count();
    if gaps as f64 > MOST_GAPS * count as f64 {
        return Err(format!(
            "{gaps} of {count} samples have no data, more than half: cut the map to where there are"
        )
        .into());
    }
    if let Some(why) = outliers::refused(heights, columns, steps.outliers != Outliers::Keep) {
        return Err(why.into());
    }
    let outlying = outliers::local(heights, columns);
    if !outlying.is_empty() {
        notes.push(format!(
            "outliers ({}) far off the median of what is around them: {}; {}",
            outlying.len(),
            outliers::places(&outlying, columns, LISTED),
            match steps.outliers {
                Outliers::Keep => "they are kept",
                Outliers::Fill => "they were filled from around them",
                Outliers::Exclude => "they were filled from around them, and no path starts near them",
            }
        ));
    }
    if steps.outliers != Outliers::Keep {
        outlying.iter().for_each(|(at, _)| heights[*at] = f64::NAN);
    }
    check_precision(file)?;
    let heights = &mut file.heights;
    let filled: Vec<bool> = heights.iter().map(|height| height.is_nan()).collect();
    if gaps::fill(heights, grid)? == 0 {
        return Ok(None);
    }
    if gaps > 0 {
        let share = 100.0 * gaps as f64 / count as f64;
        let exclude = if steps.gaps == Gaps::Exclude { ", and no path starts near them" } else { "" };
        notes.push(format!(
            "gaps: {gaps} of {count} samples ({share:.2} %) have no data; filled by a harmonic surface{exclude}"
        ));
    }
    let stays_out = |at: usize| {
        (missing[at] && steps.gaps == Gaps::Exclude)
            || (filled[at] && !missing[at] && steps.outliers == Outliers::Exclude)
    };
    let marked: Vec<bool> = (0..count).map(stays_out).collect();
    let excluded = marked.contains(&true).then(|| CellMask::around(&marked, columns, grid.periodic));
    if let Some(mask) = &excluded {
        let (cells, out) = mask.counts();
        if out == cells {
            return Err("no cell is away from all gaps: set surface.file.gaps = \"interpolate\"".into());
        }
        notes.push(format!(
            "{out} of {cells} cells ({:.2} %) are excluded",
            100.0 * out as f64 / cells as f64
        ));
    }
    Ok(Some(Filled { filled, excluded }))
}

fn refuse_gaps(heights: &[f64], columns: usize) -> Result<(), String> {
    let Some(at) = heights.iter().position(|height| !height.is_finite()) else { return Ok(()) };
    let count = heights.iter().filter(|height| !height.is_finite()).count();
    Err(format!(
        "no data at row {}, column {} ({count} such of {}): set surface.file.gaps = \"interpolate\" or \"exclude\"",
        at / columns,
        at % columns,
        heights.len()
    ))
}

/// Takes the form off, and says which.
fn take_off_form(
    map: &HeightMap,
    grid: &MapGrid,
    filled: &[bool],
    heights: &mut [f64],
) -> Result<Option<String>, String> {
    if map.periodic {
        return match map.detrend {
            Detrend::None => Ok(None),
            Detrend::Plane => {
                Ok(Some("the map is periodic and cannot be tilted: only its mean was taken off".into()))
            }
            _ => Err("the map is periodic and has no form: set surface.file.detrend = \"none\"".into()),
        };
    }
    Ok(Some(match map.detrend {
        Detrend::None => return Ok(None),
        Detrend::Plane if filled.is_empty() => {
            let [x, y] = detrend::take_off_plane(heights, grid.columns);
            let slope = |per_sample: f64, axis: usize| per_sample / grid.pitch[axis];
            format!("plane with slopes {:.2e} and {:.2e} taken off", slope(x, 0), slope(y, 1))
        }
        Detrend::Plane => {
            let rms = detrend::take_off_polynomial(heights, grid, filled, 1)?;
            format!("plane of root mean square height {rms:.3e} taken off")
        }
        Detrend::Polynomial(degree) => {
            let rms = detrend::take_off_polynomial(heights, grid, filled, degree)?;
            format!("polynomial of degree {degree} and root mean square height {rms:.3e} taken off")
        }
        Detrend::Sphere | Detrend::Cylinder => {
            let (quadric, name) = match map.detrend {
                Detrend::Sphere => (Quadric::Sphere, "sphere"),
                _ => (Quadric::Cylinder, "cylinder"),
            };
            let form = form::take_off(heights, grid, filled, quadric)?;
            let shape = if form.convex { "convex" } else { "concave" };
            let axis =
                form.azimuth_deg.map_or(String::new(), |azimuth| format!(", axis at {azimuth:.2} degrees"));
            format!(
                "{name} of radius {:.5e} (in the unit of the heights, {shape}{axis}) taken off",
                form.radius
            )
        }
    }))
}

/// The S-filter, then the L-filter, with a sentence for each.
fn filtered(
    map: &HeightMap,
    grid: &MapGrid,
    unit_um: Option<f64>,
    heights: &mut Vec<f64>,
) -> Result<Vec<String>, String> {
    let steps = &map.preparation;
    let size = [grid.columns, grid.rows(heights)];
    let cut_off = |name: &str, um: f64| {
        let unit = unit_um.ok_or_else(|| {
            format!("surface.file.{name} = {um}: the unit of the heights is not known; give pitch_x_um, pitch_y_um and height_unit_um")
        })?;
        let [shortest, longest] = [
            2.0 * unit * grid.pitch[0].max(grid.pitch[1]),
            unit * (size[0] as f64 * grid.pitch[0]).min(size[1] as f64 * grid.pitch[1]),
        ];
        if (shortest..=longest).contains(&um) {
            Ok(um / unit)
        } else {
            Err(format!(
                "surface.file.{name} = {um}: must be between two samples, {shortest:.4}, and the map's shorter side, {longest:.4}"
            ))
        }
    };
    let mut notes = Vec::new();
    if let Some(um) = steps.s_filter_um {
        *heights = filter::low_pass(heights, grid, cut_off("s_filter_um", um)?);
        notes.push(format!(
            "S-filter: Gaussian (ISO 16610-61), waves of {um} um pass by half, shorter ones less"
        ));
    }
    if let Some(um) = steps.l_filter_um {
        let waviness = filter::low_pass(heights, grid, cut_off("l_filter_um", um)?);
        heights.iter_mut().zip(&waviness).for_each(|(height, waviness)| *height -= waviness);
        notes.push(format!(
            "L-filter: Gaussian (ISO 16610-61), waves of {um} um pass by half, longer ones less"
        ));
    }
    Ok(notes)
}
