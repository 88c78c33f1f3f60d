//! The figures of a sweep as columns: a row a table and incidence. What its CSV and its NetCDF file hold.

use super::{ParameterSweep, SweptTable};
use crate::fit::Fit;
use crate::report::IncidenceSummary;
use crate::validate::compare::Comparison;
use crate::validate::error_measures::Figures;

/// A column.
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its unit; "1" without one.
    pub units: &'static str,
    /// What it is, in words.
    pub long_name: String,
    /// A value for each row.
    pub values: ColumnValues,
}

/// The values of a column.
pub enum ColumnValues {
    /// Numbers, where they are available.
    Numbers(Vec<Option<f64>>),
    /// Words.
    Texts(Vec<String>),
}

/// A quantity: its name, what it is, and its value of an incidence or comparison.
type Quantity<T> = (&'static str, &'static str, fn(&T) -> Option<f64>);

const ALBEDOS: [Quantity<IncidenceSummary>; 8] = [
    ("albedo_single", "share of the light that comes back after one bounce", |incidence| {
        incidence.albedo_single
    }),
    ("albedo_single_se", "standard error of albedo_single", |incidence| incidence.albedo_single_se),
    ("albedo_total", "share of the light that comes back", |incidence| incidence.albedo_total),
    ("albedo_total_se", "standard error of albedo_total", |incidence| incidence.albedo_total_se),
    ("transmittance_single", "share of the light that goes through one facet", |incidence| {
        incidence.transmittance_single
    }),
    ("transmittance_single_se", "standard error of transmittance_single", |incidence| {
        incidence.transmittance_single_se
    }),
    ("transmittance_total", "share of the light that goes through", |incidence| {
        incidence.transmittance_total
    }),
    ("transmittance_total_se", "standard error of transmittance_total", |incidence| {
        incidence.transmittance_total_se
    }),
];
const FIGURES: [Quantity<Figures>; 5] = [
    ("l1_noise", "what noise alone shows of the distance", |figures| figures.l1_noise),
    ("l1_model", "flux-weighted L1 distance without noise", |figures| figures.l1_model),
    ("l1_model_se", "standard error of l1_model", |figures| figures.l1_model_se),
    ("l1_model_low", "lower end of the 95 % interval of l1_model", |figures| figures.l1_model_low),
    ("l1_model_high", "upper end of the 95 % interval of l1_model", |figures| figures.l1_model_high),
];

/// A row: a table and one of its incidences.
type Row<'a> = (&'a SweptTable, usize, &'a IncidenceSummary);

impl ParameterSweep {
    /// All columns. Distances stand once for each model, masking and scope that any table was compared with; parameters of
    /// fits where any table has them.
    // Tested by `a_sweep_has_its_figures_in_one_file` (tests/it/sweeps.rs).
    pub fn columns(&self) -> Vec<Column> {
        let rows: Vec<Row<'_>> = self
            .tables
            .iter()
            .flat_map(|table| {
                table.summary.incidences.iter().enumerate().map(move |(at, incidence)| (table, at, incidence))
            })
            .collect();
        let mut found = identity(&rows);
        found.extend(ALBEDOS.map(|(name, what, value)| number(&rows, name, ("1", what), |row| value(row.2))));
        found.push(number(&rows, "seed", ("1", "seed of all that is random"), |row| {
            Some(row.0.summary.seed as f64)
        }));
        found.push(number(&rows, "correlation_cells", ("1", "correlation length, cells"), |row| {
            row.0.correlation_cells
        }));
        for model in distinct(self.tables.iter().flat_map(|table| &table.summary.comparisons).map(key)) {
            found.extend(FIGURES.map(|(name, what, value)| {
                let of_row = |row: &Row<'_>| value(&figures(row, &model)?);
                number(&rows, &format!("{name}:{model}"), ("1", what), of_row)
            }));
        }
        found.extend(self.fitted(&rows));
        found
    }

    /// The best fit of each table, which stands in all its rows; nothing where no table has one.
    fn fitted(&self, rows: &[Row<'_>]) -> Vec<Column> {
        let fits: Vec<&Fit> = self.tables.iter().filter_map(|table| table.fit.as_ref()).collect();
        if fits.is_empty() {
            return Vec::new();
        }
        let name = |row: &Row<'_>| row.0.fit.as_ref().map_or(String::new(), Fit::name);
        let mut found = vec![text(rows, "fit", "best of the models that were fitted", name)];
        let of = |pick: fn(&Fit) -> Option<f64>| move |row: &Row<'_>| pick(row.0.fit.as_ref()?);
        found.push(number(rows, "fit_l1", ("1", "flux-weighted L1 distance of the fit"), of(|fit| fit.l1)));
        let ratio = "squared residuals over squared errors of the fit";
        found.push(number(rows, "fit_chi2_per_dof", ("1", ratio), of(|fit| fit.chi2_per_dof)));
        let parameters = fits.iter().flat_map(|fit| fit.parameters.0.iter().map(|(name, _)| name.clone()));
        for name in distinct(parameters) {
            let units = if name.ends_with("_deg") { "degree" } else { "1" };
            let value = |row: &Row<'_>| row.0.fit.as_ref()?.parameters.get(&name);
            let error = |row: &Row<'_>| row.0.fit.as_ref()?.standard_errors.get(&name);
            let column = format!("fit_{name}");
            found.push(number(rows, &column, (units, &format!("{name} of the fit")), value));
            found.push(number(
                rows,
                &format!("{column}_se"),
                (units, &format!("standard error of {column}")),
                error,
            ));
        }
        found
    }
}

fn identity(rows: &[Row<'_>]) -> Vec<Column> {
    let alpha = |row: &Row<'_>| row.0.alpha;
    vec![
        text(rows, "table", "stem of the table's file", |row| row.0.stem.clone()),
        number(rows, "alpha_x", ("1", "roughness along x"), |row| alpha(row).map(|alpha| alpha.x)),
        number(rows, "alpha_y", ("1", "roughness along y"), |row| alpha(row).map(|alpha| alpha.y)),
        number(rows, "coverage", ("1", "share of the plane under grains"), |row| alpha(row)?.coverage),
        text(rows, "optics", "material and side of the light", |row| row.0.optics.clone()),
        number(rows, "theta_i_deg", ("degree", "polar angle of the light"), |row| Some(row.2.theta_i_deg)),
        number(rows, "phi_i_deg", ("degree", "azimuth of the light"), |row| Some(row.2.phi_i_deg)),
    ]
}

fn number<'a>(
    rows: &[Row<'a>],
    name: &str,
    (units, long_name): (&'static str, &str),
    value: impl Fn(&Row<'a>) -> Option<f64>,
) -> Column {
    let values = ColumnValues::Numbers(rows.iter().map(value).collect());
    Column { name: name.into(), units, long_name: long_name.into(), values }
}

fn text<'a>(rows: &[Row<'a>], name: &str, long_name: &str, value: impl Fn(&Row<'a>) -> String) -> Column {
    let values = ColumnValues::Texts(rows.iter().map(value).collect());
    Column { name: name.into(), units: "1", long_name: long_name.into(), values }
}

/// How a comparison is told from others.
fn key(comparison: &Comparison) -> String {
    let Comparison { model, masking, scope, .. } = comparison;
    format!("{model}:{masking}:{scope}")
}

fn figures((table, at, _): &Row<'_>, model: &str) -> Option<Figures> {
    let found = table.summary.comparisons.iter().find(|comparison| key(comparison) == *model)?;
    found.incidences.get(*at).map(|incidence| incidence.figures)
}

/// Each once, in the order of their first.
fn distinct(all: impl Iterator<Item = String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    all.for_each(|one| {
        if !found.contains(&one) {
            found.push(one);
        }
    });
    found
}
