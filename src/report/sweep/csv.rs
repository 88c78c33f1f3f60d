//! The figures of a sweep as CSV: a line a table and incidence.

use super::{ParameterSweep, SweptTable};
use crate::report::StopSummary;
use crate::report::plot::drawing::csv_field;
use crate::validate::compare::{Comparison, Figures};

/// How a file begins, by which it is recognised as one of ours.
pub const CSV_MARK: &str = "table,alpha_x,alpha_y,coverage,optics,theta_i_deg,phi_i_deg,albedo_single";

/// A column: its heading, and a stop's value.
type Column<T> = (&'static str, fn(&T) -> Option<f64>);

const ALBEDOS: [Column<StopSummary>; 8] = [
    ("albedo_single", |stop| stop.albedo_single),
    ("albedo_single_se", |stop| stop.albedo_single_se),
    ("albedo_total", |stop| stop.albedo_total),
    ("albedo_total_se", |stop| stop.albedo_total_se),
    ("transmittance_single", |stop| stop.transmittance_single),
    ("transmittance_single_se", |stop| stop.transmittance_single_se),
    ("transmittance_total", |stop| stop.transmittance_total),
    ("transmittance_total_se", |stop| stop.transmittance_total_se),
];
const FIGURES: [Column<Figures>; 5] = [
    ("l1_noise", |figures| figures.l1_noise),
    ("l1_model", |figures| figures.l1_model),
    ("l1_model_se", |figures| figures.l1_model_se),
    ("l1_model_low", |figures| figures.l1_model_low),
    ("l1_model_high", |figures| figures.l1_model_high),
];

impl ParameterSweep {
    /// A line a table and incidence; empty where a value is not available. Distances stand once for each model, masking and
    /// scope that any table was compared with.
    // Tested by `a_sweep_has_its_figures_in_one_file` (tests/it/sweeps.rs).
    pub fn csv(&self) -> String {
        let mut models: Vec<String> = Vec::new();
        for comparison in self.tables.iter().flat_map(|table| &table.summary.comparisons) {
            let key = key(comparison);
            if !models.contains(&key) {
                models.push(key);
            }
        }
        let heads = ["table", "alpha_x", "alpha_y", "coverage", "optics", "theta_i_deg", "phi_i_deg"];
        let mut head: Vec<String> = heads.map(String::from).to_vec();
        head.extend(ALBEDOS.map(|(name, _)| name.into()));
        head.extend(models.iter().flat_map(|model| FIGURES.map(|(name, _)| format!("{name}:{model}"))));
        let mut lines = vec![line(head)];
        for table in &self.tables {
            let rows = table.summary.stops.iter().enumerate();
            lines.extend(rows.map(|(at, stop)| line(cells(table, (at, stop), &models))));
        }
        lines.concat()
    }
}

/// How a comparison is told from others.
fn key(comparison: &Comparison) -> String {
    let Comparison { model, masking, scope, .. } = comparison;
    format!("{model}:{masking}:{scope}")
}

fn cells(table: &SweptTable, (at, stop): (usize, &StopSummary), models: &[String]) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let mut cells = vec![table.stem.clone()];
    cells.push(number(table.alpha.map(|alpha| alpha.x)));
    cells.push(number(table.alpha.map(|alpha| alpha.y)));
    cells.push(number(table.alpha.and_then(|alpha| alpha.coverage)));
    cells.push(table.optics.clone());
    cells.extend([stop.theta_i_deg, stop.phi_i_deg].map(|angle| angle.to_string()));
    cells.extend(ALBEDOS.map(|(_, value)| number(value(stop))));
    for model in models {
        let found = table.summary.comparisons.iter().find(|comparison| key(comparison) == *model);
        let figures = found.and_then(|comparison| comparison.stops.get(at)).map(|stop| stop.figures);
        cells.extend(FIGURES.map(|(_, value)| number(figures.as_ref().and_then(value))));
    }
    cells
}

fn line(cells: Vec<String>) -> String {
    cells.iter().map(|cell| csv_field(cell)).collect::<Vec<_>>().join(",") + "\n"
}
