//! A list of measured pairs of directions as a table of points: what CSV, ASTM, SSDD and UTIA files hold.

use std::collections::HashMap;

use super::read_back::{Listing, ReadBack, middle_deg};
use super::{Colour, Reason, foreign_table};
use crate::instrument::{Grid, GridKind};
use crate::table::{BrdfTable, check_grid};

/// One value by colour for (theta_i, phi_i, theta_r, phi_r) in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The stop.
    pub light: [f64; 2],
    /// The sensor.
    pub sensor: [f64; 2],
    /// The values, as many as there are colours.
    pub value: Colour,
}

impl Sample {
    /// Four angles and one or three values.
    pub fn of(numbers: &[f64]) -> Self {
        let mut value = [0.0; 3];
        value.iter_mut().zip(&numbers[4..]).for_each(|(v, n)| *v = *n);
        Sample { light: [numbers[0], numbers[1]], sensor: [numbers[2], numbers[3]], value }
    }
}

/// The table of points. Stops come in the order of their first sample; all must see the same directions, in any
/// order, each once.
pub fn table(samples: &[Sample], colours: usize) -> Reason<BrdfTable> {
    let key = |pair: [f64; 2]| pair.map(|angle| (angle + 0.0).to_bits());
    let (mut stops, mut stop_of) = (Vec::new(), HashMap::new());
    let (mut points, mut point_of) = (Vec::new(), HashMap::new());
    for sample in samples {
        stop_of.entry(key(sample.light)).or_insert_with(|| (stops.push(sample.light), stops.len() - 1).1);
        point_of
            .entry(key(sample.sensor))
            .or_insert_with(|| (points.push(sample.sensor), points.len() - 1).1);
    }
    let (stop_count, bins) = (stops.len(), points.len());
    if samples.is_empty() {
        return Err("no samples".into());
    }
    if stop_count.checked_mul(bins) != Some(samples.len()) {
        return Err(format!(
            "{} samples do not make {stop_count} stops of {bins} directions each: every stop needs the same ones, once",
            samples.len()
        ));
    }
    let mut total = vec![vec![f32::NAN; samples.len()]; colours];
    for sample in samples {
        let at = stop_of[&key(sample.light)] * bins + point_of[&key(sample.sensor)];
        if !total[0][at].is_nan() {
            return Err(format!("the pair {:?}, {:?} is there twice", sample.light, sample.sensor));
        }
        total.iter_mut().zip(sample.value).for_each(|(values, value)| values[at] = value as f32);
    }
    let grid = Grid { kind: GridKind::Points, stops_deg: stops, points_deg: points, ..Grid::default() };
    let grid = with_axes(grid);
    check_grid(&grid)?;
    foreign_table(grid, total)
}

/// Holds samples of the table's own bins, in their order, to the table; their angles may be off by `digits` degrees.
pub fn held_to(
    table: &BrdfTable,
    digits: f64,
    visit: impl FnOnce(&mut dyn FnMut(Sample) -> Reason<()>) -> Reason<()>,
) -> Reason<Option<ReadBack>> {
    listed(table, digits, visit)?.finish()
}

/// The same as a listing, for tables of which this is a band.
pub fn listed<'a>(
    table: &'a BrdfTable,
    digits: f64,
    visit: impl FnOnce(&mut dyn FnMut(Sample) -> Reason<()>) -> Reason<()>,
) -> Reason<Listing<'a>> {
    let (grid, bins) = (&table.grid, table.grid.bins());
    let (mut listing, mut count, mut regions) = (Listing::new(table), 0, Vec::new());
    let mut each = |sample: Sample| {
        let (stop, bin) = (count / bins, count % bins);
        if stop >= grid.stops() {
            return Err("more samples than bins".into());
        }
        if bin == 0 {
            regions = grid.regions(stop);
        }
        let (light, sensor) = (grid.stop_deg(stop), middle_deg(&regions[bin]));
        let wanted = [light.0, light.1, sensor.0, sensor.1];
        let found = [sample.light, sample.sensor].concat();
        let off = found.iter().zip(wanted).any(|(found, wanted)| {
            // A negative azimuth may come back a turn later.
            let turn = (found - wanted).rem_euclid(360.0);
            turn.min(360.0 - turn) > digits
        });
        if off {
            return Err(format!("sample {count} is at {found:?} degrees, the bin at {wanted:?}"));
        }
        for colour in 0..table.colours.len() {
            listing.add(stop, bin, colour, sample.value[colour] as f32);
        }
        count += 1;
        Ok(())
    };
    visit(&mut each)?;
    Ok(listing)
}

/// The stops as axes where they are a product.
fn with_axes(grid: Grid) -> Grid {
    match super::lookup::stop_axes(&grid) {
        Ok((theta_i_deg, phi_i_deg)) => Grid { theta_i_deg, phi_i_deg, stops_deg: vec![], ..grid },
        Err(_) => grid,
    }
}
