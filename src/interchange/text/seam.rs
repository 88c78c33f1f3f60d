//! Azimuths that a file lists twice, 0 and 360 or -180 and 180: one direction, which may have one value.
//!
//! Input: a table as a file lists it. Output: the same without what is there twice. Also finds the angles of one grid
//! in another, so that a file is compared with its table by angles and not by the order of its values.

use std::collections::HashMap;

use super::samples::{alike, key, with_axes};
use crate::error::wrong;
use crate::instrument::{Grid, GridKind};
use crate::interchange::Checked;
use crate::interchange::read_back::middles_deg;
use crate::table::BrdfTable;

/// The table with each incidence and each single direction once. Values of one direction that differ are a reason.
// Tested by `an_equal_seam_is_dropped_and_an_unequal_one_refused` (tests/it/interchange/interchange_angles.rs).
pub fn dropped(table: BrdfTable) -> Checked<BrdfTable> {
    let grid = &table.grid;
    if grid.kind == GridKind::HalfDifference {
        return Ok(table);
    }
    let bins = grid.bins();
    let all: Vec<[f64; 2]> =
        (0..grid.incidences()).map(|incidence| grid.incidence_deg(incidence).into()).collect();
    let columns = if grid.kind == GridKind::Points { grid.points_deg.as_slice() } else { &[] };
    let (incidences, points) = (first_places(&all), first_places(columns));
    if incidences.iter().chain(&points).all(|(at, first)| at == first) {
        return Ok(table);
    }
    for (incidence, first) in incidences.iter().filter(|(at, first)| at != first) {
        let pairs = (0..bins).map(|bin| (incidence * bins + bin, first * bins + bin));
        one_value(&table, pairs, [all[*first], all[*incidence]])?;
    }
    for (bin, first) in points.iter().filter(|(at, first)| at != first) {
        let pairs = (0..all.len()).map(|incidence| (incidence * bins + bin, incidence * bins + first));
        one_value(&table, pairs, [columns[*first], columns[*bin]])?;
    }
    let keep = |places: &[(usize, usize)]| -> Vec<usize> {
        places.iter().filter(|(at, first)| at == first).map(|(at, _)| *at).collect()
    };
    let (rows, kept) = (keep(&incidences), keep(&points));
    let kept = if columns.is_empty() { (0..bins).collect() } else { kept };
    let grid = with_axes(Grid {
        incidences_deg: rows.iter().map(|&incidence| all[incidence]).collect(),
        theta_i_deg: vec![],
        phi_i_deg: vec![],
        points_deg: if columns.is_empty() { vec![] } else { kept.iter().map(|&bin| columns[bin]).collect() },
        ..grid.clone()
    });
    let pixels: Vec<usize> =
        rows.iter().flat_map(|incidence| kept.iter().map(move |bin| incidence * bins + bin)).collect();
    Ok(of_pixels(table, grid, &pixels))
}

/// Each place and the first of the same direction.
fn first_places(list: &[[f64; 2]]) -> Vec<(usize, usize)> {
    let mut places = HashMap::new();
    list.iter()
        .enumerate()
        .map(|(at, &direction)| (at, *places.entry(key(direction)).or_insert(at)))
        .collect()
}

fn one_value(
    table: &BrdfTable,
    mut pairs: impl Iterator<Item = (usize, usize)>,
    [first, second]: [[f64; 2]; 2],
) -> Checked<()> {
    let differ =
        |&(a, b): &(usize, usize)| table.colours.iter().any(|c| !alike(c.total[a].into(), c.total[b].into()));
    let Some((a, b)) = pairs.find(differ) else { return Ok(()) };
    let values =
        |at: usize| table.colours.iter().map(|c| c.total[at].to_string()).collect::<Vec<_>>().join(" ");
    Err(wrong!(
        "{first:?} and {second:?} degrees are one direction, with {} and {}: one value needed",
        values(b),
        values(a)
    ))
}

/// The table of some of another's pixels.
fn of_pixels(mut table: BrdfTable, grid: Grid, pixels: &[usize]) -> BrdfTable {
    fn take<T: Copy>(values: &mut Vec<T>, pixels: &[usize]) {
        *values = pixels.iter().filter_map(|&at| values.get(at).copied()).collect();
    }
    for colour in &mut table.colours {
        let channels = [
            &mut colour.total,
            &mut colour.single,
            &mut colour.multiple,
            &mut colour.stderr,
            &mut colour.stderr_single,
        ];
        let planes = colour.orders.iter_mut().chain(&mut colour.mueller).chain(&mut colour.stderr_mueller);
        channels.into_iter().chain(planes).for_each(|values| take(values, pixels));
    }
    take(&mut table.hits, pixels);
    BrdfTable { grid, schlick: None, ..table }
}

/// Where `found` has its incidences and bins in `wanted`. Both must be isotropic, or neither.
pub fn places(found: &Grid, wanted: &Grid) -> Checked<(Vec<usize>, Vec<usize>)> {
    if found.is_isotropic() != wanted.is_isotropic() {
        return Err(wrong!("isotropic: {} instead of {}", found.is_isotropic(), wanted.is_isotropic()));
    }
    let lights = |grid: &Grid| -> Vec<[f64; 2]> {
        let light = |incidence| <[f64; 2]>::from(grid.incidence_deg(incidence));
        (0..grid.incidences())
            .map(|incidence| if grid.is_isotropic() { [light(incidence)[0], 0.0] } else { light(incidence) })
            .collect()
    };
    let sensors = |grid: &Grid| -> Vec<[f64; 2]> {
        let turn = if grid.is_isotropic() { grid.incidence_deg(0).1 } else { 0.0 };
        middles_deg(grid, 0).into_iter().map(|(theta, phi)| [theta, phi - turn]).collect()
    };
    Ok((matched(&lights(found), &lights(wanted))?, matched(&sensors(found), &sensors(wanted))?))
}

fn matched(found: &[[f64; 2]], wanted: &[[f64; 2]]) -> Checked<Vec<usize>> {
    let known: HashMap<_, _> = wanted.iter().map(|&direction| key(direction)).zip(0..).collect();
    let place = |direction: &[f64; 2]| {
        known
            .get(&key(*direction))
            .copied()
            .ok_or_else(|| format!("{direction:?} degrees is no direction of the table"))
    };
    Ok(found.iter().map(place).collect::<Result<_, String>>()?)
}
