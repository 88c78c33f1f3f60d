//! The figures of a sweep as CSV: a line a table and incidence.

use super::ParameterSweep;
use super::columns::ColumnValues;
use crate::report::plot::drawing::csv_field;

/// How a file begins, by which it is recognised as one of ours.
pub const CSV_MARK: &str = "table,alpha_x,alpha_y,coverage,optics,theta_i_deg,phi_i_deg,albedo_single";

impl ParameterSweep {
    /// A line a table and incidence under the names of the columns; empty where a value is not available.
    // Tested by `a_sweep_has_its_figures_in_one_file` (tests/it/sweeps.rs).
    pub fn csv(&self) -> String {
        let columns = self.columns();
        let cells = |values: &ColumnValues| -> Vec<String> {
            match values {
                ColumnValues::Numbers(all) => {
                    all.iter().map(|value| value.map_or(String::new(), |value| value.to_string())).collect()
                }
                ColumnValues::Texts(all) => all.clone(),
            }
        };
        let cells: Vec<Vec<String>> = columns.iter().map(|column| cells(&column.values)).collect();
        let rows = cells.first().map_or(0, Vec::len);
        let head = line(columns.iter().map(|column| column.name.as_str()));
        let lines = (0..rows).map(|row| line(cells.iter().map(|column| column[row].as_str())));
        std::iter::once(head).chain(lines).collect()
    }
}

fn line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    cells.map(csv_field).collect::<Vec<_>>().join(",") + "\n"
}
