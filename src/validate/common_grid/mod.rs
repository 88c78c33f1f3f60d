//! Two tables of different colours, incidences or bins, made comparable: what they have in common, exactly where it can be.
//!
//! Input: tables A and B with their realisations. Output: totals with errors on one grid, and what was done to each, in
//! sentences. Colours: R, G, B next to one channel become their luminance; of wavelengths the common ones are kept.
//! Incidences: the common ones. Bins: where those of one table are unions of the other's, the finer are averaged by
//! projected solid angle, and directions of arms and scans are chosen by position. Everything else is interpolated.
//!
//! The error of a mean of bins follows from their covariances: by realisation it is exact; without realisations it is
//! bounded by the mean of the errors (Minkowski), which is said. The error of an interpolation is not known.

mod bins;
mod colours;
mod common_bins;
mod incidences;
mod interpolation;
mod nesting;
mod positions;
mod totals;
mod words;

use std::sync::Arc;

use crate::error::Checked;
use crate::instrument::Grid;
use crate::validate::two_tables::{ComparedTable, TableDifference, difference};
use incidences::SharedIncidence;
pub use totals::Totals;
use totals::WeightedMeans;

/// Two tables on one grid.
pub struct OnCommonGrid<'a> {
    /// A and B.
    pub tables: [Totals<'a>; 2],
    /// What was done to them, one sentence each; nothing where they were comparable as they are.
    pub steps: Vec<String>,
    /// Whether values of one of them were interpolated: that error is in no error bar.
    pub interpolated: bool,
}

/// Makes two tables comparable. `Err` says in one line why they are not.
// Tested by `fine_bins_become_the_coarse_ones_of_the_same_rays`, `what_has_nothing_in_common_is_refused`.
pub fn on_common_grid<'a>(a: &ComparedTable<'a>, b: &ComparedTable<'a>) -> Checked<OnCommonGrid<'a>> {
    let tables = [a, b].map(|side| Totals::of(side.table, side.parts));
    let mut steps = Vec::new();
    let tables = colours::in_common(tables, &mut steps)?;
    let grids = [0, 1].map(|k| tables[k].table.grid.clone());
    if grids[0] == grids[1] {
        return Ok(OnCommonGrid { tables, steps, interpolated: false });
    }
    let shared = incidences::in_common([&grids[0], &grids[1]]);
    if !shared.is_empty() {
        steps.extend(words::incidences([&grids[0], &grids[1]], &shared));
        if let Some(common) = bins::in_common([&grids[0], &grids[1]], &shared) {
            steps.extend(common.steps);
            let mean = |k: usize| {
                let incidences =
                    shared.iter().map(|shared| shared.incidences[k]).zip(common.bins[k].iter().cloned());
                WeightedMeans::of_bins(&tables[k].table, incidences.collect()).of(&tables[k], &common.grid)
            };
            let tables = [mean(0), mean(1)];
            steps.extend([0, 1].into_iter().filter_map(|k| words::errors(k, &tables[k])));
            return Ok(OnCommonGrid { tables, steps, interpolated: false });
        }
    }
    interpolated(tables, &shared, steps)
}

/// Compares two tables where they are comparable; `Err` says in one line why they are not.
pub fn compared(a: &ComparedTable, b: &ComparedTable) -> Checked<TableDifference> {
    let OnCommonGrid { tables, steps, interpolated } = on_common_grid(a, b)?;
    let found = difference(tables[0].compared(a.campaign), tables[1].compared(b.campaign))?;
    Ok(TableDifference { made_comparable: steps, interpolated, ..found })
}

/// One table interpolated to the bins of the other, at the common incidences, or at all of the other's within reach.
///
/// Where the one that should be cannot be interpolated, as with a single azimuth of an absolute table, the other is.
fn interpolated<'a>(
    tables: [Totals<'a>; 2],
    shared: &[SharedIncidence],
    steps: Vec<String>,
) -> Checked<OnCommonGrid<'a>> {
    let order = interpolation::order(tables.each_ref().map(|side| &side.table.grid))?;
    let mut first = None;
    for from in order {
        match interpolated_from(from, &tables, shared) {
            Ok((tables, further)) => {
                let steps = steps.into_iter().chain(further).collect();
                return Ok(OnCommonGrid { tables, steps, interpolated: true });
            }
            Err(why) => first = first.or(Some(why)),
        }
    }
    Err(first.unwrap_or_else(|| "neither table can be interpolated".into()))
}

/// The table `from` on the grid of the other, and the sentences on it.
fn interpolated_from<'a>(
    from: usize,
    tables: &[Totals<'a>; 2],
    shared: &[SharedIncidence],
) -> Checked<([Totals<'a>; 2], Vec<String>)> {
    let grids = tables.each_ref().map(|side| &side.table.grid);
    let to = 1 - from;
    let mut steps = Vec::new();
    let incidences: Vec<usize> = if shared.is_empty() {
        let within = incidences::within(grids[from], grids[to])?;
        steps.push(words::between_incidences(from, grids[to], &within));
        within
    } else {
        shared.iter().map(|shared| shared.incidences[to]).collect()
    };
    let grid: Grid = incidences::some_of(grids[to], &incidences);
    steps.push(words::interpolated(from, grids, !shared.is_empty()));
    let found = interpolation::on(&tables[from], &grid)
        .map_err(|why| why.at(format_args!("{} cannot be interpolated", words::NAMES[from])))?;
    let same = Arc::new((0..grid.bins()).map(|bin| vec![(bin, 1.0)]).collect::<Vec<_>>());
    let chosen = incidences.iter().map(|&incidence| (incidence, same.clone())).collect();
    let kept = WeightedMeans::of_bins(&tables[to].table, chosen).of(&tables[to], &grid);
    steps.push(words::interpolation_error(from, &found));
    Ok((if from == 0 { [found, kept] } else { [kept, found] }, steps))
}
