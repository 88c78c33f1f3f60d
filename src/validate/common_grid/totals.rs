//! Totals of a table and of its realisations, and weighted means of them with their errors.

use std::borrow::Cow;
use std::sync::Arc;

use crate::campaign::Campaign;
use crate::instrument::Grid;
use crate::stats;
use crate::table::gaps::{NOT_KNOWN, NOT_MEASURED};
use crate::table::{BrdfTable, ColourChannels, RealisationPart, Realisations};
use crate::validate::two_tables::ComparedTable;

/// What a table is compared by: its totals with their errors, in all and by realisation.
#[derive(Clone)]
pub struct Totals<'a> {
    /// The table; a mean of another one has totals, errors and hits alone and cannot be stored.
    pub table: Cow<'a, BrdfTable>,
    /// Its realisations.
    pub parts: Option<Cow<'a, Realisations>>,
    /// Whether errors are upper bounds: means of bins without realisations.
    pub errors_are_bounds: bool,
}

/// The sources of a value with weights that add up to 1; none: it is a gap.
pub type Sources = Vec<(usize, f64)>;

/// Values of a grid as weighted means of a table's.
pub struct WeightedMeans {
    /// For each colour, those of the table.
    colours: Vec<Sources>,
    /// For each incidence the table's, and for each bin the table's.
    incidences: Vec<(usize, Arc<Vec<Sources>>)>,
    /// Bins of the table.
    bins: usize,
}

impl<'a> Totals<'a> {
    /// Of a table as it is.
    pub fn of(table: &'a BrdfTable, parts: Option<&'a Realisations>) -> Self {
        Totals { table: Cow::Borrowed(table), parts: parts.map(Cow::Borrowed), errors_are_bounds: false }
    }

    /// As a side of a comparison, measured by `campaign`.
    pub fn compared<'b>(&'b self, campaign: Option<&'b Campaign>) -> ComparedTable<'b> {
        let Totals { table, parts, errors_are_bounds } = self;
        ComparedTable { table, campaign, parts: parts.as_deref(), errors_are_bounds: *errors_are_bounds }
    }
}

impl WeightedMeans {
    /// Means over bins, of the table's own colours.
    pub fn of_bins(table: &BrdfTable, incidences: Vec<(usize, Arc<Vec<Sources>>)>) -> Self {
        let colours = (0..table.colours.len()).map(|colour| vec![(colour, 1.0)]).collect();
        WeightedMeans { colours, incidences, bins: table.grid.bins() }
    }

    /// Means over colours, of all incidences and bins.
    pub fn of_colours(table: &BrdfTable, colours: Vec<Sources>) -> Self {
        let bins = table.grid.bins();
        let same = Arc::new((0..bins).map(|bin| vec![(bin, 1.0)]).collect::<Vec<_>>());
        let incidences = (0..table.grid.incidences()).map(|incidence| (incidence, same.clone())).collect();
        WeightedMeans { colours, incidences, bins }
    }

    /// The means, on their grid.
    pub fn of<'a>(&self, side: &Totals<'_>, grid: &Grid) -> Totals<'a> {
        let table = &side.table;
        let totals = |colours: &[&[f32]]| -> Vec<Vec<f32>> {
            self.colours.iter().map(|sources| self.totals(colours, sources)).collect()
        };
        let of_table: Vec<&[f32]> = table.colours.iter().map(|colour| &colour.total[..]).collect();
        let parts = side.parts.as_ref().map(|parts| Realisations {
            parts: parts
                .parts
                .iter()
                .map(|part| {
                    let colours: Vec<&[f32]> = part.total.iter().map(|total| &total[..]).collect();
                    RealisationPart { total: totals(&colours), ..RealisationPart::default() }
                })
                .collect(),
        });
        let gaps: Vec<bool> = self
            .entries()
            .map(|(incidence, bin)| {
                bin.is_empty() || bin.iter().any(|&(bin, _)| table.is_gap(incidence * self.bins + bin))
            })
            .collect();
        let hits: Vec<u32> = self
            .entries()
            .map(|(incidence, bin)| {
                bin.iter()
                    .fold(0u32, |sum, &(bin, _)| sum.saturating_add(table.hits[incidence * self.bins + bin]))
            })
            .collect();
        let known = parts.as_ref().filter(|parts| parts.parts.len() > 1);
        let colours =
            totals(&of_table).into_iter().zip(&self.colours).enumerate().map(|(k, (total, sources))| {
                let stderr = self.errors(table, sources, &hits, &total, known.map(|parts| (parts, k)));
                let wavelength_nm =
                    if sources.len() == 1 { table.colours[sources[0].0].wavelength_nm } else { None };
                ColourChannels { total, stderr, wavelength_nm, ..ColourChannels::default() }
            });
        let mixed = |sources: &Sources| sources.len() > 1;
        let averaged =
            self.colours.iter().any(mixed) || self.incidences.iter().any(|(_, bins)| bins.iter().any(mixed));
        let mut found = BrdfTable { colours: colours.collect(), hits, ..table.header(grid) };
        // Channels that are not there cannot be zeroed: a gap is what its error says.
        for entry in (0..gaps.len()).filter(|&entry| gaps[entry]) {
            found.colours.iter_mut().for_each(|colour| colour.stderr[entry] = NOT_MEASURED);
        }
        Totals {
            table: Cow::Owned(found),
            errors_are_bounds: side.errors_are_bounds || (averaged && known.is_none()),
            parts: parts.map(Cow::Owned),
        }
    }

    /// The sources of every value, by incidence and bin.
    fn entries(&self) -> impl Iterator<Item = (usize, &Sources)> {
        self.incidences.iter().flat_map(|(incidence, bins)| bins.iter().map(move |bin| (*incidence, bin)))
    }

    fn totals(&self, colours: &[&[f32]], sources: &Sources) -> Vec<f32> {
        let value = |(incidence, bin): (usize, &Sources)| -> f64 {
            let of_colour = |&(colour, weight): &(usize, f64)| {
                let at =
                    |&(bin, w): &(usize, f64)| w * f64::from(colours[colour][incidence * self.bins + bin]);
                weight * bin.iter().map(at).sum::<f64>()
            };
            sources.iter().map(of_colour).sum()
        };
        self.entries().map(|entry| value(entry) as f32).collect()
    }

    /// Standard errors of the means: over the realisations, else the same mean of the errors, which none exceeds.
    ///
    /// A bin without light has the BRDF of as many arrivals as each of its sources has: their error times their weight.
    fn errors(
        &self,
        table: &BrdfTable,
        sources: &Sources,
        hits: &[u32],
        total: &[f32],
        parts: Option<(&Realisations, usize)>,
    ) -> Vec<f32> {
        let error = |(at, (incidence, bin)): (usize, (usize, &Sources))| -> f32 {
            let of_bin = |&(bin, w): &(usize, f64)| {
                let entry = incidence * self.bins + bin;
                let errors =
                    sources.iter().map(|&(colour, weight)| (weight, table.colours[colour].stderr[entry]));
                errors
                    .map(|(weight, se)| (se >= 0.0).then_some(weight * w * f64::from(se)))
                    .sum::<Option<f64>>()
            };
            let Some(bounds) = bin.iter().map(of_bin).collect::<Option<Vec<f64>>>() else { return NOT_KNOWN };
            if hits[at] == 0 || total[at] == 0.0 {
                return bounds.into_iter().fold(0.0, f64::max) as f32;
            }
            let Some((parts, colour)) = parts else { return bounds.iter().sum::<f64>() as f32 };
            let values = parts.parts.iter().map(|part| f64::from(part.total[colour][at]));
            stats::mean_and_se(values).1.map_or(NOT_KNOWN, |se| se as f32)
        };
        self.entries().enumerate().map(error).collect()
    }
}
