//! Two tables bin by bin: what differs, and what of it noise explains.
//!
//! Input: tables A and B on one grid, with their realisations where they are known. Output: the summary's measures
//! with A as f and B as m: l1 = sum |a-b| w / sum b w, l1_noise = sqrt(2/pi) sum se w/c4 / sum b w with
//! se^2 = se_a^2 + se_b^2. Tables of the very same patches are paired: se is that of the differences by realisation.
//! l1_difference, the distance without noise, has realisations turn each other's sign (`model_distance`); where neither
//! table has any, l1 and l1_noise alone say between which bounds it lies.

mod bin_sums;
mod compared_table;
mod differences;
mod figures;

use std::path::Path;

use serde::Serialize;

use crate::campaign::Campaign;
use crate::error::Error;
use crate::instrument::Grid;
use crate::stats;
use crate::table::{BrdfTable, Realisations, TableRows};
use bin_sums::{ComparedPair, DifferenceSums};
pub use compared_table::ComparedTable;
pub(crate) use compared_table::paired;
pub use figures::DifferenceFigures;

/// Level of the t limit, shared by all bins.
const LEVEL: f64 = 0.01;
/// How A differs from B.
#[derive(Debug, Clone, Serialize)]
pub struct TableDifference {
    /// `total`: all orders.
    pub scope: &'static str,
    /// Bins, of all incidences and colours, that t was computed for; of two that mirror each other, one.
    pub bins: usize,
    /// Whether the errors are those of differences by realisation: both were measured on the same patches.
    pub paired: bool,
    /// What was done to make the tables comparable, one sentence each; nothing on one grid (`common_grid`).
    pub made_comparable: Vec<String>,
    /// Whether values of one table are interpolated ones: that error is not known, and in no error bar.
    pub interpolated: bool,
    /// Whether errors of one table are upper bounds, and its t's lower ones.
    pub errors_are_bounds: bool,
    /// The measures over all incidences and colours.
    #[serde(flatten)]
    pub figures: DifferenceFigures,
    /// The |t| that the largest of `bins` exceeds with probability 1 % where only noise differs.
    pub t_limit: Option<f64>,
    /// Each incidence.
    #[serde(rename = "stops")]
    pub incidences: Vec<IncidenceDifference>,
}

impl TableDifference {
    /// What the tables differ by beyond their noise; `None` where noise explains it, or nothing differs.
    ///
    /// Where no bin has an error bar, any difference is one.
    pub fn disagreement(&self) -> Option<String> {
        let l1 = self.figures.l1.unwrap_or(0.0);
        let interpolated = if self.interpolated { "; the interpolation may be off by as much" } else { "" };
        match self.t_limit.zip(self.figures.max_t) {
            Some((limit, most)) if most > limit => Some(format!(
                "the tables differ: largest t {most:.2}, the 1 % limit of {} bins is {limit:.2}{interpolated}",
                self.bins
            )),
            None if l1 > 0.0 => {
                Some(format!("the tables differ by an L1 of {l1:.6}, and no errors are known"))
            }
            _ => None,
        }
    }
}

/// One incidence of a comparison.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct IncidenceDifference {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Azimuth of the light.
    pub phi_i_deg: f64,
    /// The measures, means of the colours.
    #[serde(flatten)]
    pub figures: DifferenceFigures,
}

/// Compares two tables bin by bin; `Err` says in one line what does not fit.
///
/// - Gaps of either table are left out.
/// - Bins without hits in either table count in l1 and are left out of t's; a stderr of -1 anywhere makes the noise null.
/// - Degrees of freedom by Welch and Satterthwaite, rounded down; realisations - 1 where the tables are paired.
// Tested by `equal_laws_differ_by_their_noise_alone`, `the_measures_follow_their_definitions`.
pub fn difference(a: ComparedTable, b: ComparedTable) -> Result<TableDifference, String> {
    fits(a.table, b.table)?;
    let mut found = DifferenceRun::default();
    found.add(a, b, 0);
    let errors_are_bounds = a.errors_are_bounds || b.errors_are_bounds;
    Ok(TableDifference { errors_are_bounds, ..found.finish() })
}

/// The same of two stored tables, a band of incidences after the other: both bands together hold `bytes` at most.
///
/// The sides give campaigns and realisations; their tables are not looked at.
// Tested by `tables_compared_by_rows_differ_as_whole_ones` (tests/it/table/large_tables.rs).
pub fn difference_of_rows(
    (a, b): (&mut TableRows, &mut TableRows),
    campaigns: [Option<&Campaign>; 2],
    parts: [Option<&Realisations>; 2],
    bytes: u64,
) -> crate::error::Result<TableDifference> {
    let wrong = |path: &Path, why: String| Error::format(path, why);
    fits(a.header(), b.header()).map_err(|why| wrong(b.path(), why))?;
    a.verify()?;
    b.verify()?;
    let mut found = DifferenceRun::default();
    for incidences in a.bands(bytes, a.row_bytes() + b.row_bytes()) {
        let first_incidence = incidences.start;
        let incidences: Vec<usize> = incidences.collect();
        let tables = [a.take(&incidences)?, b.take(&incidences)?];
        fits(&tables[0], &tables[1]).map_err(|why| wrong(b.path(), why))?;
        let [a, b] = [0, 1].map(|k| ComparedTable {
            campaign: campaigns[k],
            parts: parts[k],
            ..ComparedTable::of(&tables[k])
        });
        found.add(a, b, first_incidence);
    }
    Ok(found.finish())
}

/// A comparison under way: the incidences come in their order, in bands.
#[derive(Default)]
struct DifferenceRun {
    incidences: Vec<((f64, f64), DifferenceSums)>,
    paired: bool,
    most_dof: usize,
}

impl DifferenceRun {
    fn add(&mut self, a: ComparedTable, b: ComparedTable, first_incidence: usize) {
        let pair = ComparedPair::new(a, b, first_incidence);
        let grid = &a.table.grid;
        self.incidences.extend(
            (0..grid.incidences())
                .map(|incidence| (grid.incidence_deg(incidence), pair.incidence(incidence))),
        );
        (self.paired, self.most_dof) = (pair.paired.is_some(), pair.most_dof());
    }

    fn finish(self) -> TableDifference {
        let sums: Vec<&DifferenceSums> = self.incidences.iter().map(|(_, sums)| sums).collect();
        let whole = sums.iter().fold(DifferenceSums::default(), |all, incidence| all.merged(incidence));
        let row = |((theta_i_deg, phi_i_deg), sums): &((f64, f64), DifferenceSums)| IncidenceDifference {
            theta_i_deg: *theta_i_deg,
            phi_i_deg: *phi_i_deg,
            figures: sums.figures(),
        };
        let judged = (whole.bins > 0).then_some(whole.bins);
        TableDifference {
            scope: "total",
            bins: whole.bins,
            paired: self.paired,
            made_comparable: Vec::new(),
            interpolated: false,
            errors_are_bounds: false,
            t_limit: judged.map(|bins| stats::student_limit(stats::sidak(LEVEL, bins), self.most_dof)),
            figures: mean_of_incidences(whole.figures(), &sums),
            incidences: self.incidences.iter().map(row).collect(),
        }
    }
}

/// l1, its noise and what realisations add as means over the incidences that have light; t's over all bins.
fn mean_of_incidences(whole: DifferenceFigures, incidences: &[&DifferenceSums]) -> DifferenceFigures {
    let mean = |pick: fn(&DifferenceFigures) -> Option<f64>| {
        let values: Vec<f64> = incidences.iter().filter_map(|incidence| pick(&incidence.figures())).collect();
        (!values.is_empty()).then(|| stats::mean(&values))
    };
    let parts: Vec<Vec<f64>> =
        incidences.iter().map(|incidence| incidence.by_part()).filter(|p| !p.is_empty()).collect();
    let of_part = |k: usize| parts.iter().map(|parts| parts[k]).sum::<f64>() / parts.len() as f64;
    let by_part: Vec<f64> = (0..parts.first().map_or(0, Vec::len)).map(of_part).collect();
    DifferenceFigures { l1: mean(|f| f.l1), l1_noise: mean(|f| f.l1_noise), ..whole }
        .with_difference(&by_part)
}

/// Whether the tables have the same incidences, bins and colours.
fn fits(a: &BrdfTable, b: &BrdfTable) -> Result<(), String> {
    if a.colours.len() != b.colours.len() {
        let names = [a, b].map(|table| table.colour_names().join(" "));
        return Err(format!("its colours are {}, the other table's {}", names[1], names[0]));
    }
    let (a, b) = (&a.grid, &b.grid);
    if a == b {
        return Ok(());
    }
    let axis = |name: &str, pick: fn(&Grid) -> &[f64]| {
        let (here, there) = (pick(b), pick(a));
        let at = here.iter().zip(there).find(|(here, there)| here != there);
        (here != there).then(|| match at {
            Some((here, there)) => format!("{name} has {here} where the other table has {there}"),
            None => format!("{name} has {} values, the other table's {}", here.len(), there.len()),
        })
    };
    let first = axis("theta_i_deg", |g| &g.theta_i_deg)
        .or_else(|| axis("phi_i_deg", |g| &g.phi_i_deg))
        .or_else(|| axis("theta_r_edges_deg", |g| &g.theta_r_edges_deg))
        .or_else(|| axis("phi_r_edges_deg", |g| &g.phi_r_edges_deg))
        .or_else(|| axis("theta_r_deg", |g| &g.theta_r_deg))
        .or_else(|| axis("phi_r_deg", |g| &g.phi_r_deg))
        .or_else(|| axis("aperture_deg", |g| g.aperture_deg.as_slice()));
    let what = first.unwrap_or_else(|| "kind or phi_r_relative differs".into());
    Err(format!("gonio.grid: {what}; tables on different grids are compared where both fit the memory"))
}
