//! A scan with gaps made whole: what an incidence lacks, interpolated from what it has.
//!
//! Each azimuth of an incidence: cubic along its polar angles, through the pole to the azimuth on the other side, the
//! end value beyond them; the pole is one direction at all azimuths. Then each polar angle: cubic along the azimuths
//! that the incidence has, all the way round.

use std::collections::{BTreeMap, HashMap};

use super::angles::bin_axes;
use super::axis::{AzimuthCircle, Polar, Taps, WIDEST_GAP_DEG};
use crate::error::wrong;
use crate::instrument::{Grid, GridKind};
use crate::interchange::text::samples::key;
use crate::interchange::{Checked, spectral_table};
use crate::sphere;
use crate::table::BrdfTable;

/// Why a table with gaps is not what was asked for.
pub(crate) fn not_measured(table: &BrdfTable) -> String {
    format!(
        "{} of {} pairs of directions were not measured; npz, csv, astm, exr_parts and pabopto keep such gaps, import \
         --like TABLE.exr fills them in",
        table.gaps(),
        table.grid.incidences() * table.grid.bins()
    )
}

/// The note on the gaps of a scan; half/difference angles have cells below the horizon, which are none.
pub fn note(table: &BrdfTable) -> Option<String> {
    let (gaps, all) = (table.gaps(), table.grid.incidences() * table.grid.bins());
    (gaps > 0 && table.grid.kind != GridKind::HalfDifference).then(|| {
        format!(
            "{gaps} of {all} pairs of directions were not measured: gaps, which count nowhere; --like TABLE.exr fills \
             them in"
        )
    })
}

/// The totals of a table over all pairs of its polar angles and azimuths, and one sentence of what was filled in; the
/// table itself where it has all of them. Refused: more to fill in than was measured, azimuths too far apart.
// Tested by tests/it/interchange/ragged_scans.rs.
pub fn filled(table: BrdfTable) -> Checked<(BrdfTable, Option<String>)> {
    let gaps = table.gaps();
    let whole = gaps == 0 && (table.grid.kind != GridKind::Points || bin_axes(&table.grid).is_ok());
    if whole || table.grid.kind == GridKind::HalfDifference {
        return Ok((table, None));
    }
    if table.grid.kind != GridKind::Points {
        return Err(wrong!("{gaps} bins were not measured: nothing is interpolated over them"));
    }
    let (incidences, measured) =
        (table.grid.incidences(), table.grid.incidences() * table.grid.bins() - gaps);
    let rows = Rows::of(&table.grid);
    let all = incidences.saturating_mul(rows.theta.len() * rows.phi.len());
    if all > 2 * measured {
        return Err(wrong!(
            "the sensor's polar angles and azimuths make {all} pairs with the lights, of which {measured} were \
             measured: too few to fill in the rest; leave --like out to keep what was measured as it is"
        ));
    }
    let mut total = vec![Vec::with_capacity(all); table.colours.len()];
    let mut lacking = 0;
    for incidence in 0..incidences {
        for (colour, total) in total.iter_mut().enumerate() {
            let mut cells = rows.cells(&table, incidence, colour);
            lacking += usize::from(colour == 0) * cells.iter().filter(|cell| cell.is_none()).count();
            let (theta, phi) = table.grid.incidence_deg(incidence);
            rows.fill(&mut cells).map_err(|why| why.at(format_args!("light {theta} {phi} degrees")))?;
            total.extend(cells.into_iter().map(|cell| cell.unwrap_or(0.0) as f32));
        }
    }
    let wavelengths: Vec<f64> = table.colours.iter().filter_map(|colour| colour.wavelength_nm).collect();
    let whole = spectral_table(Grid { points_deg: rows.pairs(), ..table.grid }, total, &wavelengths)?;
    let note =
        format!("{lacking} of {all} pairs of directions were not measured: filled in by cubic interpolation");
    Ok((whole, (lacking > 0).then_some(note)))
}

/// All polar angles and azimuths of a list of directions.
struct Rows {
    /// Increasing, degrees.
    theta: Vec<f64>,
    /// Increasing in [0, 360), degrees.
    phi: Vec<f64>,
    /// The bin of each row and column, where the list has it.
    bins: Vec<Option<usize>>,
    /// The bins at the pole.
    poles: Vec<usize>,
}

impl Rows {
    fn of(grid: &Grid) -> Self {
        let points = &grid.points_deg;
        let (mut theta, mut phi, mut places) = (BTreeMap::new(), BTreeMap::new(), HashMap::new());
        for (bin, &point) in points.iter().enumerate() {
            let [t, p] = key(point);
            theta.entry(t).or_insert(point[0]);
            // The azimuth of the pole is none.
            if t != 0 {
                phi.entry(p).or_insert(sphere::reduced_deg(point[1]));
            }
            places.entry([t, p]).or_insert(bin);
        }
        let pairs = theta.keys().flat_map(|&t| phi.keys().map(move |&p| [t, p]));
        Rows {
            bins: pairs.map(|pair| places.get(&pair).copied()).collect(),
            poles: (0..points.len()).filter(|&bin| key(points[bin])[0] == 0).collect(),
            theta: theta.into_values().collect(),
            phi: phi.into_values().collect(),
        }
    }

    fn pairs(&self) -> Vec<[f64; 2]> {
        self.theta.iter().flat_map(|&t| self.phi.iter().map(move |&p| [t, p])).collect()
    }

    /// What an incidence has of each row and column.
    fn cells(&self, table: &BrdfTable, incidence: usize, colour: usize) -> Vec<Option<f64>> {
        let first = incidence * table.grid.bins();
        let value = |&bin: &usize| {
            let measured = !table.is_gap(first + bin);
            measured.then(|| f64::from(table.colours[colour].total[first + bin]))
        };
        let mut cells: Vec<Option<f64>> = self.bins.iter().map(|bin| bin.as_ref().and_then(value)).collect();
        if let Some(pole) = self.poles.iter().find_map(value) {
            cells[..self.phi.len()].iter_mut().for_each(|cell| *cell = cell.or(Some(pole)));
        }
        cells
    }

    /// The column half a turn away.
    fn opposite(&self, column: usize) -> Option<usize> {
        let wanted = key([90.0, self.phi[column] + 180.0]);
        (0..self.phi.len()).find(|&other| key([90.0, self.phi[other]]) == wanted)
    }

    /// Fills in the values of one incidence.
    fn fill(&self, cells: &mut [Option<f64>]) -> Checked<()> {
        let columns = self.phi.len();
        let mut full = Vec::new();
        let measured = cells.to_vec();
        for column in 0..columns {
            let along = |column: usize| {
                let row = move |row: usize| (self.theta[row].to_radians(), column + row * columns);
                let places = (0..self.theta.len()).map(row);
                places.filter_map(|(theta, at)| Some((theta, measured[at]?))).collect::<Vec<_>>()
            };
            let near = along(column);
            // The pole alone tells no azimuth.
            if near.iter().all(|&(theta, _)| theta == 0.0) {
                continue;
            }
            let far = self.opposite(column).map_or(Vec::new(), along).into_iter().rev();
            let beyond = far.filter(|&(theta, _)| theta > 0.0).map(|(theta, value)| (-theta, value));
            let known: Vec<(f64, f64)> = beyond.chain(near).collect();
            let axis = Polar::new(&known.iter().map(|known| known.0).collect::<Vec<_>>(), false);
            for (row, theta) in self.theta.iter().enumerate() {
                let cell = &mut cells[row * columns + column];
                *cell = cell.or_else(|| Some(sum(axis.cubic(theta.to_radians()), |node| known[node].1)));
            }
            full.push(column);
        }
        if full.len() == columns {
            return Ok(());
        }
        if full.is_empty() {
            return Err(
                "a position of the light has no sample off the normal: nothing to fill in from".into()
            );
        }
        let circle = AzimuthCircle::new(full.iter().map(|&column| self.phi[column].to_radians()).collect());
        if circle.widest_gap().to_degrees() > WIDEST_GAP_DEG {
            return Err("its azimuths of the sensor lie too far apart to fill in what it lacks".into());
        }
        for row in cells.chunks_mut(columns) {
            let known: Vec<f64> = full.iter().filter_map(|&column| row[column]).collect();
            for (column, phi) in self.phi.iter().enumerate() {
                row[column] =
                    row[column].or_else(|| Some(sum(circle.cubic(phi.to_radians()), |node| known[node])));
            }
        }
        Ok(())
    }
}

/// A cubic may swing below 0 next to a lobe; there the value is 0, as everywhere between bins.
fn sum(taps: Taps, value: impl Fn(usize) -> f64) -> f64 {
    taps.iter().map(|tap| tap.weight * value(tap.node)).sum::<f64>().max(0.0)
}
