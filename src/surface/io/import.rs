//! Measured height maps: from a file to a heightfield whose slopes are those of the sample.
//!
//! Input: `[surface.file]`. Output: heights in the file's unit, prepared as the campaign asks for (`chain`), on a grid that is
//! fine enough (`refine`), and the factors that turn a difference of neighbouring heights into a slope.

use std::path::Path;

use glam::DVec2;

use crate::campaign::HeightMap;
use crate::error::{Checked, Error, Result};
use crate::files;
use crate::files::memory;

use super::checks::{check_size, check_slopes, positive, slope_factor};
use super::map_file;
use super::prepare::MapGrid;
use super::prepare::cell_mask::CellMask;
use super::prepare::chain;
use super::prepare::refine::{self, AGREEMENT, AUTO_CELLS, Cuts, Refined};
use super::samples::{MapSamples, Stored};
use crate::surface::Heightfield;

/// Change of the rms slope by refinement from which on the samples do not resolve the slopes.
const RESOLVED: f64 = 0.1;

/// A measured surface.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportedMap {
    /// Heights in the file's unit.
    pub field: Heightfield,
    /// World slope along x = difference of neighbouring columns times this.
    pub alpha_x: f64,
    /// World slope along y = difference of neighbouring rows times this.
    pub alpha_y: f64,
    /// Cells for each of the file's own along a side.
    pub steps: usize,
    /// Slopes of the refined map.
    pub cuts: Cuts,
    /// Cells that no path starts on: those round gaps that are excluded.
    pub excluded: Option<CellMask>,
    /// One unit of height, um; `None` where neither campaign nor file says.
    pub unit_um: Option<f64>,
    /// What was done to the map, and what to know about it.
    pub notes: Vec<String>,
}

/// A patch as this program wrote it: heights untouched.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchFile {
    /// The periodic heights.
    pub field: Heightfield,
    /// Distance of neighbouring columns, in the unit of the heights.
    pub pitch_x: f64,
    /// Distance of neighbouring rows.
    pub pitch_y: f64,
}

/// Reads a measured map.
///
/// Scaling heights and pitches by one power of two leaves every slope as it was, bit for bit.
// Tested by `scaling_by_a_power_of_two_keeps_every_slope_bit_for_bit`,
// `an_offset_in_f64_changes_nothing_and_in_f32_is_refused`.
pub fn load(map: &HeightMap) -> Result<ImportedMap> {
    let path = &map.resolved_path;
    let file = read(path, map.channel.as_deref())?;
    import(map, file).map_err(|why| Error::format(path, why))
}

/// The heights of a measured map on the file's own grid, as its file has them (their mean taken off, gaps filled) and as
/// they are measured, before any refinement.
pub fn load_steps(map: &HeightMap) -> Result<MapSteps> {
    let path = &map.resolved_path;
    let file = read(path, map.channel.as_deref())?;
    steps(map, file).map_err(|why| Error::format(path, why))
}

/// A measured map before and after its preparation.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSteps {
    /// Where the heights lie.
    pub grid: MapGrid,
    /// One unit of height, um; `None` where neither campaign nor file says.
    pub unit_um: Option<f64>,
    /// As the file has them.
    pub before: Vec<f64>,
    /// As they are measured.
    pub after: Vec<f64>,
}

/// Reads a patch that this program wrote, with its pitches.
pub fn load_patch(path: &Path) -> Result<PatchFile> {
    let file = read(path, None)?;
    if let Some(at) = file.heights.iter().position(|height| !height.is_finite()) {
        let (row, column, height) = (at / file.columns, at % file.columns, file.heights[at]);
        return Err(Error::format(path, format!("height at row {row}, column {column} is {height}")));
    }
    let pitch = |name: &str, value: Option<f64>| {
        let value = value.ok_or_else(|| format!("no attribute `{name}`"))?;
        positive(name, value)
    };
    let pitches = pitch("pitch_x", file.pitch[0]).and_then(|x| Ok((x, pitch("pitch_y", file.pitch[1])?)));
    let (pitch_x, pitch_y) = pitches.map_err(|why| Error::format(path, why))?;
    check_size(&file, true).map_err(|why| Error::format(path, why))?;
    let field = Heightfield::new(file.columns, file.rows, true, file.heights);
    Ok(PatchFile { field, pitch_x, pitch_y })
}

fn read(path: &Path, channel: Option<&str>) -> Result<MapSamples> {
    let bytes = files::read(path)?;
    let wrong = |why| Error::format(path, why);
    memory::check_file(path, map_file::needed(&bytes).map_err(wrong)?)?;
    map_file::read_channel(&bytes, channel).map_err(wrong)
}

/// Slope of one unit of height a cell, along x and y.
fn slope_factors(map: &HeightMap, file: &MapSamples) -> Checked<DVec2> {
    let [own_x, own_y] = file.pitch;
    let no_pitch = |name: &str| match &file.no_pitch {
        Some(why) => format!("{why}; give surface.file.pitch_x_um, pitch_y_um and height_unit_um"),
        None => format!("the file has no attribute `{name}`; give surface.file.{name}_um"),
    };
    let alpha = |name: &str, pitch_um, own| slope_factor(name, pitch_um, map.height_unit_um, own, no_pitch);
    Ok(DVec2::new(alpha("pitch_x", map.pitch_x_um, own_x)?, alpha("pitch_y", map.pitch_y_um, own_y)?))
}

/// What one unit of height is, um.
fn unit_um(map: &HeightMap, file: &MapSamples) -> Option<f64> {
    if map.pitch_x_um.is_some() { map.height_unit_um } else { file.unit_um }
}

fn grid_of(map: &HeightMap, file: &MapSamples, alpha: DVec2) -> MapGrid {
    MapGrid { columns: file.columns, pitch: [1.0 / alpha.x, 1.0 / alpha.y], periodic: map.periodic }
}

fn steps(map: &HeightMap, mut file: MapSamples) -> Checked<MapSteps> {
    let (grid, unit_um) = (grid_of(map, &file, slope_factors(map, &file)?), unit_um(map, &file));
    check_size(&file, map.periodic)?;
    let before = chain::as_they_are(&grid, file.heights.clone())?;
    chain::prepare(map, &grid, unit_um, &mut file)?;
    Ok(MapSteps { grid, unit_um, before, after: file.heights })
}

fn import(map: &HeightMap, mut file: MapSamples) -> Checked<ImportedMap> {
    let alpha = slope_factors(map, &file)?;
    let (cells_x, cells_y) = check_size(&file, map.periodic)?;
    let (grid, unit_um) = (grid_of(map, &file, alpha), unit_um(map, &file));
    let mut notes = vec![format!("{} x {} samples, {cells_x} x {cells_y} cells", file.columns, file.rows)];
    notes.append(&mut file.notes);
    match file.stored {
        Stored::Byte => notes.push("heights are whole numbers of 8 bits: slopes are coarse".into()),
        Stored::Half => notes.push("heights are half floats of 11 bits: slopes are coarse".into()),
        Stored::Single | Stored::Exact => {}
    }
    let mut prepared = chain::prepare(map, &grid, unit_um, &mut file)?;
    notes.append(&mut prepared.notes);
    let field = Heightfield::new(cells_x, cells_y, map.periodic, file.heights);
    let (low, high) = field.range();
    let refined = refine::refine(field, alpha, map.refine)?;
    let steps = refined.steps as f64;
    let (alpha_x, alpha_y, cuts) = (alpha.x * steps, alpha.y * steps, refined.after);
    if low == high {
        notes.push("the map is flat: a mirror".into());
    } else {
        check_slopes(map, &refined.before, &mut notes)?;
        notes.extend(refinement(&refined));
    }
    let excluded = prepared.excluded.map(|mask| mask.refined(refined.steps));
    Ok(ImportedMap {
        field: refined.field,
        alpha_x,
        alpha_y,
        steps: refined.steps,
        cuts,
        excluded,
        unit_um,
        notes,
    })
}

impl ImportedMap {
    /// Distance of neighbouring columns and rows of the refined map, in the unit of the heights.
    pub fn pitch(&self) -> [f64; 2] {
        [1.0 / self.alpha_x, 1.0 / self.alpha_y]
    }

    /// Size of the map along x and y, in the unit of the heights.
    pub fn size(&self) -> [f64; 2] {
        let [x, y] = self.pitch();
        [x * self.field.cells_x() as f64, y * self.field.cells_y() as f64]
    }

    /// Root mean square height about the mean, Sq of ISO 25178, in the unit of the heights.
    pub fn sq(&self) -> f64 {
        let heights = self.field.heights();
        let mean = |f: &dyn Fn(f64) -> f64| heights.iter().map(|&h| f(h)).sum::<f64>() / heights.len() as f64;
        let centre = mean(&|h| h);
        mean(&|h| (h - centre).powi(2)).sqrt()
    }
}

/// What refinement did, or could not do.
fn refinement(refined: &Refined) -> Vec<String> {
    let Refined { field, steps, before, after } = refined;
    let percent = |share: f64| format!("{:.2} %", 100.0 * share);
    let mut notes = vec![format!(
        "refine = {steps}: {} x {} cells, slopes under the two diagonals of a cell agree within {} ({} as sampled)",
        field.cells_x(),
        field.cells_y(),
        percent(after.disagreement()),
        percent(before.disagreement())
    )];
    if !after.agree() {
        let more = if *steps < refine::MOST_STEPS && 4 * field.cells_x() * field.cells_y() > AUTO_CELLS {
            format!("; auto stops at {} Mi cells, a larger refine goes on", AUTO_CELLS >> 20)
        } else {
            String::new()
        };
        notes.push(format!(
            "slopes depend on the diagonal that cells are cut along by {}, above {}: a mirrored map will not give the \
             mirrored table{more}",
            percent(after.disagreement()),
            percent(AGREEMENT)
        ));
    }
    if (after.sdq - before.sdq).abs() > RESOLVED * before.sdq {
        notes.push(format!(
            "the samples do not resolve the slopes: rms slope {:.4} from sample to sample, {:.4} of the spline through \
             them; steps and noise overshoot, refine = 1 leaves them as they are",
            before.sdq, after.sdq
        ));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::{Detrend, Preparation};

    fn map() -> HeightMap {
        HeightMap {
            path: "scan.npy".into(),
            resolved_path: "scan.npy".into(),
            channel: None,
            preparation: Preparation::default(),
            pitch_x_um: Some(0.5),
            pitch_y_um: Some(0.25),
            height_unit_um: Some(0.001),
            periodic: false,
            detrend: Detrend::Plane,
            refine: None,
            tiles: 4,
        }
    }

    fn file(columns: usize, rows: usize, height: impl Fn(f64, f64) -> f64) -> MapSamples {
        let at = |i: usize| height((i % columns) as f64, (i / columns) as f64);
        let heights = (0..columns * rows).map(at).collect();
        MapSamples::new(columns, rows, heights, Stored::Exact)
    }

    #[test]
    fn a_tilted_plane_is_wholly_taken_off_and_its_slopes_are_said() {
        let imported = import(&map(), file(20, 31, |x, y| 7.0 + 50.0 * x - 20.0 * y)).expect("sound");
        let (low, high) = imported.field.range();
        // Heights reach 1550: residues are a few rounding errors of that size.
        assert!(low.abs().max(high.abs()) < 1550.0 * 16.0 * f64::EPSILON, "{low} {high}");
        let plane = imported.notes.iter().find(|note| note.contains("plane")).expect("said");
        let slopes: Vec<f64> = plane.split(' ').filter_map(|word| word.parse().ok()).collect();
        approx::assert_relative_eq!(slopes[0], 0.1, max_relative = 1e-12);
        approx::assert_relative_eq!(slopes[1], -0.08, max_relative = 1e-12);
        assert_eq!((imported.alpha_x, imported.alpha_y), (0.001 / 0.5, 0.001 / 0.25));
    }

    #[test]
    fn a_periodic_map_keeps_its_plane_and_says_so() {
        let periodic = HeightMap { periodic: true, ..map() };
        let imported = import(&periodic, file(9, 8, |x, _| x)).expect("sound");
        assert_eq!((imported.field.cells_x(), imported.field.cells_y()), (9, 8));
        assert_eq!(imported.field.corners(0, 0).lower_slope().x, 1.0);
        assert!(imported.notes.iter().any(|note| note.contains("only its mean")));
    }

    #[test]
    fn a_flat_map_is_a_mirror_and_a_small_one_is_refused() {
        let imported = import(&map(), file(9, 9, |_, _| 0.1)).expect("sound");
        assert!(imported.notes.iter().any(|note| note.contains("mirror")));
        assert_eq!((imported.field.cells_x(), imported.field.cells_y()), (8, 8));
        assert!(
            import(&map(), file(8, 9, |_, _| 0.1)).expect_err("7 cells").to_string().contains("7 x 8 cells")
        );
    }

    #[test]
    fn pitches_come_from_the_campaign_or_the_file_or_are_asked_for() {
        let own = HeightMap { pitch_x_um: None, pitch_y_um: None, height_unit_um: None, ..map() };
        let mut with_pitch = file(9, 9, |x, _| x);
        assert!(
            import(&own, with_pitch.clone())
                .expect_err("none")
                .to_string()
                .contains("surface.file.pitch_x_um")
        );
        with_pitch.pitch = [Some(4.0), Some(8.0)];
        let imported = import(&own, with_pitch.clone()).expect("sound");
        assert_eq!((imported.alpha_x, imported.alpha_y), (0.25, 0.125));
        with_pitch.pitch = [Some(f64::NAN), Some(8.0)];
        assert!(import(&own, with_pitch.clone()).expect_err("NaN").to_string().contains("pitch_x = NaN"));
        let unitless = HeightMap { height_unit_um: None, ..map() };
        assert!(import(&unitless, with_pitch).expect_err("no unit").to_string().contains("height_unit_um"));
    }
}
