//! A list of measured pairs of directions as a table of points: what CSV, ASTM, SSDD and UTIA files hold.

use std::collections::HashMap;

use super::named_columns::{ColourValues, Columns};
use crate::error::wrong;
use crate::files::memory;
use crate::instrument::{Grid, GridKind};
use crate::interchange::read_back::{Listing, middles_deg, upper};
use crate::interchange::{Checked, needed, spectral_table};
use crate::sphere;
use crate::table::{BrdfTable, check_grid};

/// The largest azimuth either way, degrees.
const MOST_AZIMUTH: f64 = 3600.0;
/// Pairs that a list does not have, at most. Each takes the memory of a value in every colour.
const MOST_GAPS: usize = 1 << 22;

/// The values for (theta_i, phi_i, theta_r, phi_r) in degrees, absolute azimuths.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPair {
    /// The incidence.
    pub light: [f64; 2],
    /// The sensor.
    pub sensor: [f64; 2],
    /// A value for each colour.
    pub values: ColourValues,
    /// Their standard errors; empty where they are unknown.
    pub errors: ColourValues,
    /// Arrivals, where they are counted.
    pub hits: Option<u32>,
    /// Where it stands in the file.
    pub line: usize,
}

impl MeasuredPair {
    /// Four angles, and what the columns say of the numbers. A negative polar angle is the far side of its plane,
    /// phi + 180.
    pub fn of(line: usize, numbers: &[f64], columns: &Columns) -> Self {
        MeasuredPair {
            light: upper([numbers[0], numbers[1]]),
            sensor: upper([numbers[2], numbers[3]]),
            values: columns.values(numbers),
            errors: columns.errors(numbers),
            hits: columns.hits(numbers),
            line,
        }
    }

    /// Which of its angles is none, if one is not.
    fn fault(&self) -> Option<String> {
        // Beyond 90 degrees the sensor sees what has gone through.
        for (arm, [theta, phi], most) in [("light", self.light, 90.0), ("sensor", self.sensor, 180.0)] {
            if !(0.0..=most).contains(&theta) {
                return Some(format!(
                    "line {}: polar angle {theta} of the {arm} lies outside [0, {most}] degrees",
                    self.line
                ));
            }
            // Beyond a few turns degrees lose their digits.
            if phi.abs() > MOST_AZIMUTH {
                return Some(format!(
                    "line {}: azimuth {phi} of the {arm} lies outside [-{MOST_AZIMUTH}, {MOST_AZIMUTH}] degrees",
                    self.line
                ));
            }
        }
        None
    }

    /// The sensor's azimuth counted from the light, to ten digits.
    fn seen_from_light(mut self) -> Self {
        self.sensor[1] = ((self.sensor[1] - self.light[1]) * 1e10).round() / 1e10;
        self
    }
}

/// The table of points. Incidences come in the order of their first sample, and so do directions, in any order at
/// each incidence. A pair that is there twice, as a seam at 0 and 360 degrees, must agree. Where only azimuths from
/// the light are the same at all incidences, the table has those. Pairs that the list does not have are gaps
/// ([`BrdfTable::is_gap`]).
// Tested by tests/it/interchange/interchange_angles.rs, tests/it/interchange/ragged_scans.rs.
pub fn table(samples: &[MeasuredPair], columns: &Columns, isotropic: bool) -> Checked<BrdfTable> {
    if samples.is_empty() {
        return Err("no samples".into());
    }
    if let Some(fault) = samples.iter().find_map(MeasuredPair::fault) {
        return Err(fault.into());
    }
    let from_light = || samples.iter().cloned().map(MeasuredPair::seen_from_light).collect::<Vec<_>>();
    if isotropic {
        return one_azimuth(SampleLayout::of(&from_light()).table(columns, true)?);
    }
    let absolute = SampleLayout::of(samples);
    if absolute.gaps() == 0 {
        return absolute.table(columns, false);
    }
    let turned = from_light();
    let relative = SampleLayout::of(&turned);
    // The azimuths by which the list has fewer gaps are those of the instrument.
    if relative.gaps() < absolute.gaps() {
        relative.table(columns, true)
    } else {
        absolute.table(columns, false)
    }
}

/// Samples over all pairs of their incidences and directions.
struct SampleLayout<'a> {
    samples: &'a [MeasuredPair],
    incidences: Directions,
    points: Directions,
    /// Incidence and direction of each sample.
    places: Vec<(usize, usize)>,
}

impl<'a> SampleLayout<'a> {
    fn of(samples: &'a [MeasuredPair]) -> Self {
        let (mut incidences, mut points) = (Directions::default(), Directions::default());
        let place = |sample: &MeasuredPair| (incidences.place(sample.light), points.place(sample.sensor));
        let places = samples.iter().map(place).collect();
        SampleLayout { samples, incidences, points, places }
    }

    /// Pairs without a sample, at least.
    fn gaps(&self) -> usize {
        self.incidences.list.len().saturating_mul(self.points.list.len()).saturating_sub(self.samples.len())
    }

    fn table(self, columns: &Columns, phi_r_relative: bool) -> Checked<BrdfTable> {
        let (incidence_count, bins) = (self.incidences.list.len(), self.points.list.len());
        if self.gaps() > MOST_GAPS {
            return Err(wrong!(
                "{} samples of {incidence_count} lights and {bins} directions of the sensor: most directions belong to one \
                 light alone, and a table of all pairs would be nearly empty; at most {MOST_GAPS} gaps are kept",
                self.samples.len()
            ));
        }
        // A few thousand lines may list millions of pairs, each with all colours: no length of a file says it before.
        memory::check(needed::table(incidence_count * bins, columns.colours()))?;
        let mut first: Vec<Option<&MeasuredPair>> = vec![None; incidence_count * bins];
        for (sample, (incidence, bin)) in self.samples.iter().zip(self.places) {
            match &mut first[incidence * bins + bin] {
                Some(earlier) => agree(earlier, sample)?,
                empty => *empty = Some(sample),
            }
        }
        let number = |sample: &Option<&MeasuredPair>, c: usize| sample.map_or(0.0, |sample| sample.values[c]);
        let total = (0..columns.colours()).map(|c| first.iter().map(|sample| number(sample, c)).collect());
        let (incidences_deg, points_deg) = (self.incidences.list, self.points.list);
        let grid =
            Grid { kind: GridKind::Points, incidences_deg, points_deg, phi_r_relative, ..Grid::default() };
        let grid = with_axes(grid);
        check_grid(&grid)?;
        let mut table = spectral_table(grid, total.collect(), &columns.wavelengths_nm)?;
        for (entry, sample) in first.into_iter().enumerate() {
            match sample {
                Some(sample) => put(&mut table, entry, sample),
                None => table.set_gap(entry),
            }
        }
        Ok(table)
    }
}

/// Errors and arrivals of an entry. Every value counts as an arrival where none are counted.
fn put(table: &mut BrdfTable, entry: usize, sample: &MeasuredPair) {
    for (colour, &error) in table.colours.iter_mut().zip(&sample.errors) {
        (colour.stderr[entry], colour.stderr_single[entry]) = (error, error);
    }
    table.hits[entry] = sample.hits.unwrap_or(1);
}

/// Directions by the order in which they come.
#[derive(Default)]
struct Directions {
    list: Vec<[f64; 2]>,
    places: HashMap<[i64; 2], usize>,
}

impl Directions {
    fn place(&mut self, direction: [f64; 2]) -> usize {
        *self
            .places
            .entry(key(direction))
            .or_insert_with(|| (self.list.push(direction), self.list.len() - 1).1)
    }
}

/// Radians in degrees to eight digits: what twelve digits of radians are worth.
pub fn whole_deg(angle: f64) -> f64 {
    (angle.to_degrees() * 1e8).round() / 1e8
}

/// A direction to 1e-8 degrees, what twelve digits of radians are worth; azimuths a turn apart are one, those at the
/// pole are distinguished, as an arm's are.
pub fn key([theta, phi]: [f64; 2]) -> [i64; 2] {
    let whole = |angle: f64| (angle * 1e8).round() as i64;
    [whole(theta), whole(sphere::reduced_deg(phi)) % whole(360.0)]
}

/// Whether two values are one: as far apart as f32 and its decimals may be.
pub fn alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= 4.0 * f64::from(f32::EPSILON) * a.abs().max(b.abs())
}

fn agree(a: &MeasuredPair, b: &MeasuredPair) -> Checked<()> {
    match (0..a.values.len()).find(|&c| !alike(f64::from(a.values[c]), f64::from(b.values[c]))) {
        Some(c) => Err(wrong!(
            "lines {} and {}: the same light {:?} and sensor {:?} (degrees) with {} and {}",
            a.line,
            b.line,
            b.light,
            b.sensor,
            a.values[c],
            b.values[c]
        )),
        None => Ok(()),
    }
}

/// The table with its single azimuth of the light standing for all.
// Tested by `the_users_word_makes_a_single_azimuth_isotropic` (tests/it/interchange/interchange_angles.rs).
pub fn one_azimuth(mut table: BrdfTable) -> Checked<BrdfTable> {
    let grid = &mut table.grid;
    if grid.is_isotropic() {
        return Ok(table);
    }
    if grid.kind == GridKind::HalfDifference {
        return Err("isotropic: half/difference angles say that themselves; leave --isotropic out".into());
    }
    if grid.azimuths() > 1 {
        return Err("isotropic: the file has several azimuths of the light, one needed".into());
    }
    let turn = grid.incidence_deg(0).1;
    let back = |phi: &mut f64| *phi = ((*phi - turn) * 1e10).round() / 1e10;
    grid.phi_r_edges_deg.iter_mut().chain(&mut grid.phi_r_deg).for_each(back);
    grid.patches_deg.iter_mut().flat_map(|patch| &mut patch[2..]).for_each(back);
    grid.points_deg.iter_mut().map(|point| &mut point[1]).for_each(back);
    grid.phi_r_relative = true;
    check_grid(grid)?;
    Ok(table)
}

/// Compares samples of the table's own bins, in their order, with the table; their angles may be off by `digits`
/// degrees.
pub fn listed<'a>(
    table: &'a BrdfTable,
    digits: f64,
    visit: impl FnOnce(&mut dyn FnMut(MeasuredPair) -> Checked<()>) -> Checked<()>,
) -> Checked<Listing<'a>> {
    let (grid, bins) = (&table.grid, table.grid.bins());
    let (mut listing, mut entry, mut middles) = (Listing::new(table), 0, Vec::new());
    let mut middles_of = None;
    let mut each = |sample: MeasuredPair| {
        while table.is_gap(entry) {
            entry += 1;
        }
        let (incidence, bin) = (entry / bins, entry % bins);
        if incidence >= grid.incidences() {
            return Err("more samples than bins".into());
        }
        if middles_of != Some(incidence) {
            (middles, middles_of) = (middles_deg(grid, incidence), Some(incidence));
        }
        let (light, sensor) = (grid.incidence_deg(incidence), middles[bin]);
        let wanted = [light.0, light.1, sensor.0, sensor.1];
        let found = [sample.light, sample.sensor].concat();
        let off = found.iter().zip(wanted).any(|(found, wanted)| {
            // A negative azimuth may come back a turn later.
            let turn = (found - wanted).rem_euclid(360.0);
            turn.min(360.0 - turn) > digits
        });
        if off {
            return Err(wrong!("entry {entry} is at {found:?} degrees, the bin at {wanted:?}"));
        }
        for colour in 0..table.colours.len() {
            listing.add(incidence, bin, colour, sample.values[colour]);
        }
        entry += 1;
        Ok(())
    };
    visit(&mut each)?;
    Ok(listing)
}

/// The incidences as axes where they are a product.
pub(crate) fn with_axes(grid: Grid) -> Grid {
    match crate::interchange::resample::angles::incidence_axes(&grid) {
        Ok((theta_i_deg, phi_i_deg)) => Grid { theta_i_deg, phi_i_deg, incidences_deg: vec![], ..grid },
        Err(_) => grid,
    }
}
