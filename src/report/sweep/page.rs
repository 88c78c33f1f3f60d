//! The page of a sweep: what differs from table to table, in joint plots, and every table in a line.

use super::{ParameterSweep, SweptTable};
use crate::fit::Fit;
use crate::report::IncidenceSummary;
use crate::report::html::render::plain_page;
use crate::report::html::sections::{figures_of, scrolled};
use crate::report::plot::plots::spread;
use crate::report::plot::{Chart, ChartAxis, Series, escaped, series_style};
use crate::validate::compare::Comparison;
use crate::validate::error_measures::Figures;

/// Curves of one chart at most: more cannot be told apart.
const MOST_CURVES: usize = 8;

/// A value of an incidence, and half of its 95 % interval.
type Value<'a> = &'a dyn Fn(&SweptTable, usize) -> Option<(f64, Option<f64>)>;

impl ParameterSweep {
    /// One self-contained page. `link`: whether the pages of the tables lie next to it, by their stems.
    // Tested by `a_sweep_has_its_figures_in_one_file` (tests/it/sweeps.rs).
    pub fn page(&self, link: bool) -> String {
        let charts = figures_of(self.charts().iter().map(Chart::svg));
        let name = escaped(&self.name);
        let what = format!("<p id=\"what\">{} tables side by side.</p>\n", self.tables.len());
        let main = format!(
            "<section id=\"plots\" aria-label=\"Plots\">\n<h2>Side by side</h2>\n<p>Bars are 95 % intervals of the \
             measurement.</p>\n{charts}</section>\n\
             <section id=\"tables\" aria-label=\"Tables\">\n<h2>Tables</h2>\n{}</section>\n",
            self.listed(link)
        );
        plain_page(&name, &what, &main)
    }

    fn charts(&self) -> Vec<Chart> {
        let albedo = |table: &SweptTable, incidence: usize| {
            let incidence = table.summary.incidences.get(incidence)?;
            Some((incidence.albedo_total?, half_of(table, incidence.albedo_total_se)))
        };
        let through = |table: &SweptTable, incidence: usize| {
            let incidence = table.summary.incidences.get(incidence)?;
            Some((incidence.transmittance_total?, half_of(table, incidence.transmittance_total_se)))
        };
        let distance = |table: &SweptTable, incidence: usize| {
            let figures = compared(table)?.incidences.get(incidence)?.figures;
            Some((100.0 * figures.l1_model?, half_of(table, figures.l1_model_se).map(|half| 100.0 * half)))
        };
        let masking =
            self.tables.iter().find_map(compared).map(|comparison| comparison.masking.replace('_', "-"));
        let label = format!("% of the light, {}", masking.unwrap_or_default());
        let parts: [(&str, &str, Value); 3] = [
            ("Albedo", "share of the light", &albedo),
            ("Transmittance", "share of the light", &through),
            ("Distance from the formula", &label, &distance),
        ];
        let both = |(title, label, value): (&str, &str, Value)| {
            [self.against_swept((title, label), value), self.against_theta((title, label), value)]
        };
        parts.into_iter().flat_map(both).flatten().chain(self.fitted_alpha()).collect()
    }

    /// Against what differs from table to table, a curve for each angle of the light.
    fn against_swept(&self, (title, label): (&str, &str), value: Value) -> Option<Chart> {
        let (name, axis, values) = self.swept()?;
        let first = self.tables.first()?;
        let incidences = spread(first.summary.incidences.len(), MOST_CURVES);
        let curves = incidences.iter().enumerate().map(|(k, &incidence)| {
            let points = self.tables.iter().zip(&values);
            let points = points.filter_map(|(table, &x)| Some((x, value(table, incidence)?)));
            curve(
                angles(&first.summary.incidences[incidence], &first.summary.incidences),
                points.collect(),
                k,
            )
        });
        let range = [values[0], values[values.len() - 1]];
        let axis = ChartAxis::linear(axis, range);
        chart_of(format!("{title} against the {name}"), axis, label, curves.collect())
    }

    /// What alone differs from table to table and increases, its axis and its values; `None` where less than three tables, or
    /// more than one quantity or material, make no curve.
    fn swept(&self) -> Option<(&'static str, &'static str, Vec<f64>)> {
        let first = self.tables.first()?;
        type Quantity = fn(&SweptTable) -> Option<f64>;
        let quantities: [(&str, &str, Quantity); 4] = [
            ("roughness", "alpha (along x)", |table| Some(table.alpha?.x)),
            ("coverage", "coverage", |table| table.alpha?.coverage),
            ("correlation length", "correlation length, cells", |table| table.correlation_cells),
            ("seed", "seed", |table| Some(table.summary.seed as f64)),
        ];
        let differs = |quantity: Quantity| self.tables.iter().any(|table| quantity(table) != quantity(first));
        let mut differing = quantities.into_iter().filter(|(.., quantity)| differs(*quantity));
        let ((name, axis, quantity), None) = (differing.next()?, differing.next()) else { return None };
        let values: Vec<f64> = self.tables.iter().filter_map(quantity).collect();
        let one_material = self.tables.iter().all(|table| table.optics == first.optics);
        let all = values.len() == self.tables.len() && values.len() >= 3;
        (all && one_material && values.is_sorted_by(|a, b| a < b)).then_some((name, axis, values))
    }

    /// Against the light's polar angle at its first azimuth, a curve for each table.
    fn against_theta(&self, (title, label): (&str, &str), value: Value) -> Option<Chart> {
        let shown = spread(self.tables.len(), MOST_CURVES);
        let curves = shown.iter().enumerate().map(|(k, &at)| {
            let table = &self.tables[at];
            let incidences = &table.summary.incidences;
            let along = (0..incidences.len())
                .filter(|&incidence| incidences[incidence].phi_i_deg == incidences[0].phi_i_deg);
            let points = along
                .filter_map(|incidence| Some((incidences[incidence].theta_i_deg, value(table, incidence)?)));
            curve(self.short(&table.stem), points.collect(), k)
        });
        let several = self.tables.iter().any(|table| table.summary.incidences.len() > 1);
        let axis = ChartAxis::degrees("light theta_i, degrees", [0.0, 90.0]);
        if several {
            chart_of(format!("{title} against the light's angle"), axis, label, curves.collect())
        } else {
            None
        }
    }

    /// A table's name without what all have in common.
    fn short(&self, stem: &str) -> String {
        stem.strip_prefix(&self.name).map_or(stem, |rest| rest.trim_start_matches('_')).into()
    }

    /// Every table in a line.
    fn listed(&self, link: bool) -> String {
        let row = |table: &SweptTable| {
            let stem = escaped(&table.stem);
            let name = if link { format!("<a href=\"{stem}.html\">{stem}</a>") } else { stem };
            let number = |value: Option<f64>, decimals: usize| {
                value.map_or("–".to_string(), |value| format!("{value:.decimals$}"))
            };
            let figures = compared(table).map_or(Figures::default(), |comparison| comparison.figures);
            let fit = table.fit.as_ref().map_or("–".to_string(), fit_text);
            let albedo = table.summary.incidences.first().and_then(|incidence| incidence.albedo_total);
            format!(
                "<tr><th>{name}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                number(albedo, 5),
                number(figures.l1_noise, 4),
                number(figures.l1_model, 4),
                escaped(&fit),
                escaped(table.summary.verdict.as_deref().unwrap_or("–"))
            )
        };
        let rows: String = self.tables.iter().map(row).collect();
        let table = format!(
            "<table class=\"facts\"><thead><tr><th>table</th><th>albedo, first light</th><th>noise</th>\
             <th>from the formula, l1_model</th><th>best fit</th><th>verdict</th></tr></thead>\n<tbody>{rows}</tbody></table>"
        );
        scrolled("Tables", &table)
    }
}

/// A model with its first parameter and what half of its 95 % interval is.
fn fit_text(fit: &Fit) -> String {
    let Some((name, Some(value))) = fit.parameters.0.first() else { return fit.name() };
    let interval = fit.intervals_95.as_ref().and_then(|all| all.get(name));
    let half = interval.map_or(String::new(), |[low, high]| format!(" ± {:.5}", 0.5 * (high - low)));
    format!("{}, {name} {value:.5}{half}", fit.name())
}

/// Half of the 95 % interval by a standard error.
fn half_of(table: &SweptTable, se: Option<f64>) -> Option<f64> {
    Some(se? * table.interval()?)
}

/// The comparison that is shown: with height-correlated masking where there is one, else the first.
fn compared(table: &SweptTable) -> Option<&Comparison> {
    let all = &table.summary.comparisons;
    all.iter().find(|comparison| comparison.masking == "height_correlated").or(all.first())
}

/// The light's angles; the azimuth where there are several.
fn angles(incidence: &IncidenceSummary, all: &[IncidenceSummary]) -> String {
    let theta = format!("theta_i {}°", incidence.theta_i_deg);
    let several = all.iter().any(|other| other.phi_i_deg != all[0].phi_i_deg);
    if several { format!("{theta}, phi_i {}°", incidence.phi_i_deg) } else { theta }
}

fn curve(label: String, points: Vec<(f64, (f64, Option<f64>))>, index: usize) -> Series {
    let error: Vec<f64> = points.iter().filter_map(|(_, (_, half))| *half).collect();
    let series = Series::new(label, points.iter().map(|&(x, (y, _))| [x, y]).collect(), series_style(index));
    // A band without a half-width somewhere would be invented there.
    if error.len() == points.len() { Series { error, ..series } } else { series }
}

/// A chart from 0 up; `None` where nothing is known.
pub(super) fn chart_of(title: String, x: ChartAxis, label: &str, series: Vec<Series>) -> Option<Chart> {
    let series: Vec<Series> = series.into_iter().filter(|series| !series.points.is_empty()).collect();
    let ends = series.iter().flat_map(|series| {
        let halves = series.error.iter().copied().chain(std::iter::repeat(0.0));
        series.points.iter().zip(halves).map(|(point, half)| point[1] + half)
    });
    let highest = ends.fold(0.0, f64::max);
    (!series.is_empty()).then(|| Chart {
        title,
        x,
        y: ChartAxis::linear(label, [0.0, (1.1 * highest).max(1e-6)]),
        series,
    })
}
