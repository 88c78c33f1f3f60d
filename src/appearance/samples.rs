//! A table's values and those of its realisations, read alike.

use super::colorimetry::ColourScale;
use super::quantity::Quantity;
use super::reading::{BinWeights, Reading};
use crate::stats;
use crate::table::{BrdfTable, RealisationPart, Realisations};

/// Where bounds are as near as this part of them, the reading is one whatever its bins.
const ALIKE: f64 = 0.01;
/// What bins twice as large may change at most, as a part of the reading.
const MOST_OPEN: f64 = 0.1;

/// How the weight of a bin is taken.
type WeightOf = fn(&BinWeights) -> f64;

/// A table, its realisations, and how its colours are seen.
pub struct TableSamples<'a> {
    /// The table.
    pub table: &'a BrdfTable,
    parts: &'a [RealisationPart],
    /// What its colours weigh.
    pub scale: ColourScale,
}

/// Readings by colour, those of one receptor after another: of the table, of one with other bins, of every realisation.
struct Values {
    best: Vec<f64>,
    other: Vec<f64>,
    parts: Vec<Vec<f64>>,
}

impl<'a> TableSamples<'a> {
    /// The table with its realisations; of one alone no errors follow.
    pub fn new(table: &'a BrdfTable, parts: Option<&'a Realisations>) -> Self {
        let parts = parts.map_or(&[][..], |all| &all.parts);
        let entries = table.grid.incidences() * table.grid.bins();
        let fits = |part: &RealisationPart| {
            part.total.len() == table.colours.len() && part.total.iter().all(|colour| colour.len() == entries)
        };
        let parts = if parts.len() > 1 && parts.iter().all(fits) { parts } else { &[] };
        TableSamples { table, parts, scale: ColourScale::of(table) }
    }

    /// Realisations behind the errors; 0 where there are none.
    pub fn realisations(&self) -> usize {
        self.parts.len()
    }

    /// One number of readings that each give what they are said to (see [`Self::checked`]); `of` has them by receptor, and by
    /// colour within.
    pub fn quantity(&self, readings: &[&Reading], of: impl Fn(&[f64]) -> f64) -> Quantity {
        match self.quantities(readings, |values| vec![of(values)]) {
            Ok(mut found) => found.pop().unwrap_or_default(),
            Err(why) => Quantity::missing(why),
        }
    }

    /// Several numbers of the same readings.
    pub fn quantities(
        &self,
        readings: &[&Reading],
        of: impl Fn(&[f64]) -> Vec<f64>,
    ) -> Result<Vec<Quantity>, String> {
        let ways = readings.iter().map(|reading| self.checked(reading)).collect::<Result<Vec<_>, _>>()?;
        let values = self.values(readings, &ways);
        let (best, other) = (of(&values.best), of(&values.other));
        let without: Vec<Vec<f64>> = (0..values.parts.len()).map(|k| of(&values.without(k))).collect();
        let note = readings.iter().find_map(|reading| reading.note.clone());
        let one = |k: usize| {
            let left: Vec<f64> = without.iter().map(|all| all[k]).collect();
            let open = (best[k] - other[k]).abs();
            Quantity::new(best[k], stats::jackknife_se(&left), Some(open), note.clone())
        };
        Ok((0..best.len()).map(one).collect())
    }

    /// The luminance of the colours of one reading, of those that stand from `receptor` on.
    pub fn luminance(&self, values: &[f64], receptor: usize) -> f64 {
        let weights = &self.scale.luminance;
        let here = &values[receptor * weights.len()..][..weights.len()];
        here.iter().zip(weights).map(|(value, weight)| value * weight).sum()
    }

    /// How a reading is taken, and next to it with other bins; the error says why it is none.
    ///
    /// Where its bounds are nearly one number whatever lies within the bins, evenly, and the lower bound. Else its bins must be
    /// small enough, the plane's reading within the bounds, and bins twice as large must change it little.
    // Tested by `what_bins_do_not_resolve_is_not_invented` (tests/it/appearance/readings.rs).
    fn checked(&self, reading: &Reading) -> Result<[WeightOf; 2], String> {
        let sum = |pick: WeightOf| {
            let of = |channel: &Vec<f32>| weighted(reading, channel, pick);
            let colours: Vec<f64> = self.table.colours.iter().map(|colour| of(&colour.total)).collect();
            self.luminance(&colours, 0)
        };
        let [low, high] = [sum(|w| w.bounds[0]), sum(|w| w.bounds[1])];
        if high - low <= ALIKE * high {
            return Ok([|w| w.even, |w| w.bounds[0]]);
        }
        if !reading.is_resolved() {
            let [bins, most] = [reading.bins_deg, reading.most_deg].map(|[a, b]| format!("{a:.2} x {b:.2}"));
            return Err(format!("bins of {bins} degrees (theta_r x phi_r) there, {most} at most would do"));
        }
        let (plane, coarse) = (sum(|w| w.plane), sum(|w| w.coarse));
        if (plane - coarse).abs() > MOST_OPEN * plane || !(low..=high).contains(&plane) {
            return Err(
                "the lobe is too narrow for the bins, twice as large ones change it by more than a tenth"
                    .into(),
            );
        }
        Ok([|w| w.plane, |w| w.coarse])
    }

    fn values(&self, readings: &[&Reading], ways: &[[WeightOf; 2]]) -> Values {
        let of = |channels: &[&Vec<f32>], which: usize| -> Vec<f64> {
            let each = |(reading, way): (&&Reading, &[WeightOf; 2])| -> Vec<f64> {
                channels.iter().map(|channel| weighted(reading, channel, way[which])).collect()
            };
            readings.iter().zip(ways).flat_map(each).collect()
        };
        let totals: Vec<&Vec<f32>> = self.table.colours.iter().map(|colour| &colour.total).collect();
        let part = |part: &RealisationPart| of(&part.total.iter().collect::<Vec<_>>(), 0);
        Values { best: of(&totals, 0), other: of(&totals, 1), parts: self.parts.iter().map(part).collect() }
    }
}

impl Values {
    /// The means of all realisations but one.
    fn without(&self, left_out: usize) -> Vec<f64> {
        let others = (self.parts.len() - 1) as f64;
        let mean = |k: usize| {
            let rest = self.parts.iter().enumerate().filter(|(part, _)| *part != left_out);
            rest.map(|(_, values)| values[k]).sum::<f64>() / others
        };
        (0..self.best.len()).map(mean).collect()
    }
}

fn weighted(reading: &Reading, channel: &[f32], pick: WeightOf) -> f64 {
    reading.terms.iter().map(|(entry, weights)| f64::from(channel[*entry]) * pick(weights)).sum()
}
