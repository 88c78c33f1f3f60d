//! The start regions of a measured map: it is read once, and each of its regions stands for a realisation.

use crate::campaign::{Campaign, HeightMap};
use crate::error::{Error, Result};
use crate::measure::gap_crossings;
use crate::surface::io::import::{self, ImportedMap};
use crate::trace::Window;

/// The map, and the cells kept free along its edge; `notes` gets what it had to say.
pub(super) fn load(
    height_map: &HeightMap,
    campaign: &Campaign,
    notes: &mut Vec<String>,
) -> Result<(ImportedMap, usize)> {
    let mut map = import::load(height_map)?;
    notes.append(&mut map.notes);
    let (low, high) = map.field.range();
    let steepest = campaign.light.theta_i_deg.iter().copied().fold(0.0, f64::max);
    let slope = (steepest + campaign.light.aperture_deg).to_radians().tan();
    let reach = (high - low) * map.alpha_x.max(map.alpha_y) * slope;
    let shortest = map.field.cells_x().min(map.field.cells_y());
    let wanted = if map.field.is_periodic() { 0.0 } else { reach.ceil() };
    let margin = (wanted as usize).min(shortest / 4);
    if wanted > margin as f64 {
        notes.push(format!(
            "{}: shadows reach {wanted} cells, starts keep only {margin} from the edge: see `left_map`",
            height_map.path
        ));
    }
    let tiles = height_map.tiles as usize;
    if (shortest - 2 * margin) < tiles {
        return Err(Error::format(
            &height_map.resolved_path,
            format!("{shortest} cells are too few for {tiles} x {tiles} start regions"),
        ));
    }
    let empty =
        (0..tiles * tiles).find(|&k| tile(&map, tiles, margin, k).cells_outside(map.excluded.as_ref()) == 0);
    if let Some(empty) = empty {
        let why = format!(
            "start region {empty} of {tiles} x {tiles} is all gaps: lower surface.file.tiles, or set \
             surface.file.gaps = \"interpolate\""
        );
        return Err(Error::format(&height_map.resolved_path, why));
    }
    notes.extend(gap_crossings::note(&map, margin, campaign));
    Ok((map, margin))
}

/// Start region `index` of tiles x tiles inside the margin: equal ones, or where cells are excluded ones of about as many
/// cells that are left, so that each group of paths stands for as much of the map.
pub(super) fn tile(map: &ImportedMap, tiles: usize, margin: usize, index: usize) -> Window {
    let field = &map.field;
    let Some(excluded) = &map.excluded else {
        let part = |cells: usize, k: usize| {
            let inner = cells - 2 * margin;
            (margin + k * inner / tiles, margin + (k + 1) * inner / tiles)
        };
        return Window { x: part(field.cells_x(), index % tiles), y: part(field.cells_y(), index / tiles) };
    };
    let whole = Window { x: (margin, field.cells_x() - margin), y: (margin, field.cells_y() - margin) };
    let row = |y: usize| Window { y: (y, y + 1), ..whole }.cells_outside(Some(excluded));
    let band = Window { y: share(whole.y, tiles, index / tiles, row), ..whole };
    let column = |x: usize| Window { x: (x, x + 1), ..band }.cells_outside(Some(excluded));
    Window { x: share(band.x, tiles, index % tiles, column), ..band }
}

/// Part `k` of `parts` of a range of lines, all of about as many cells as `cells` says that each line has.
fn share(
    (first, end): (usize, usize),
    parts: usize,
    k: usize,
    cells: impl Fn(usize) -> usize,
) -> (usize, usize) {
    let counts: Vec<usize> = (first..end).map(cells).collect();
    let all: usize = counts.iter().sum();
    let cut = |k: usize| {
        let mut before = 0;
        let line = counts.iter().position(|count| {
            before += count;
            before * parts > k * all
        });
        first + if k == 0 { 0 } else { line.unwrap_or(counts.len()) }
    };
    (cut(k), if k + 1 == parts { end } else { cut(k + 1) })
}
