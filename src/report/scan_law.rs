//! A measured surface beside a random one of the law of its slopes: what was fitted, and how far one BRDF is the other's.

use serde::Serialize;

use super::html::render::plain_page;
use super::html::sections::{figures_of, scrolled};
use super::html::specimen::quantiles::SlopeQuantiles;
use super::plot::plots::spread;
use super::plot::{
    Chart, ChartAxis, MEASURED, Marker, Series, SeriesStyle, escaped, model_style, series_style,
};
use super::slices::Scene;
use crate::fit::slopes::{SlopeFit, SlopeFits};
use crate::validate::two_tables::TableDifference;

/// Incidences that have a chart of their own, at most.
const MOST_INCIDENCES: usize = 6;

/// What the page and the command say.
#[derive(Debug, Serialize)]
pub struct ScanLaw {
    /// The campaign's name.
    pub name: String,
    /// All laws.
    #[serde(flatten)]
    pub slopes: SlopeFits,
    /// Place of the law that was measured: the plainest of those that tiles do not tell from the best.
    pub taken: usize,
    /// The scan's table against the law's.
    pub difference: TableDifference,
    /// The files of both tables.
    pub files: [String; 2],
}

impl ScanLaw {
    /// The law that was measured.
    pub fn law(&self) -> &SlopeFit {
        &self.slopes.fits[self.taken]
    }

    /// Whether the law's BRDF is the scan's, in a sentence.
    pub fn verdict(&self) -> String {
        let law = self.law().name();
        let figures = &self.difference.figures;
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        match (figures.l1_difference, figures.l1_difference_floor, figures.l1_difference_se, figures.l1) {
            (Some(found), Some(floor), ..) if found <= floor => format!(
                "A random surface of the law {law} sends the light where the scan does: they differ by less than {} of it, \
                 which is what noise hides.",
                percent(floor)
            ),
            (Some(found), _, se, _) => {
                let error = se.map_or(String::new(), |se| format!(" +- {:.1}", 100.0 * se));
                format!(
                    "A random surface of the law {law} sends {}{error} % of the light elsewhere than the scan does, noise taken off.",
                    format_args!("{:.1}", 100.0 * found)
                )
            }
            (None, _, _, Some(l1)) => format!(
                "A random surface of the law {law} and the scan differ by {} of the light, noise included.",
                percent(l1)
            ),
            _ => "Neither the scan nor its law sends light into the bins.".into(),
        }
    }

    /// One self-contained page. `quantiles`: of every law in the order of the fits; the scenes are those of both tables.
    // Tested by `a_scan_is_measured_beside_its_law` (tests/it/scan_law.rs).
    pub fn page(&self, quantiles: &[Vec<SlopeQuantiles>], scenes: [Scene; 2]) -> String {
        let slopes = figures_of(self.slope_chart(quantiles).iter().map(Chart::svg));
        let lobes = figures_of(lobe_charts(scenes).iter().map(Chart::svg));
        let (all, most) = (scenes[0].table.grid.incidences(), MOST_INCIDENCES);
        let chosen = if all > most { format!(" {most} of {all} incidences.") } else { String::new() };
        let title = format!("{}: the law of its slopes", escaped(&self.name));
        let verdict = format!("<p id=\"verdict\">{}</p>\n", escaped(&self.verdict()));
        let main = format!(
            "<section id=\"slopes\" aria-label=\"Slopes\">\n<h2>Slopes</h2>\n<p>{}</p>\n{}{slopes}</section>\n\
             <section id=\"lobes\" aria-label=\"In the plane of incidence\">\n<h2>In the plane of incidence</h2>\n<p>Bars are 95 % \
             intervals.{chosen}</p>\n{lobes}</section>\n<section id=\"figures\" aria-label=\"Distances\">\n<h2>Distances</h2>\n{}</section>\n",
            escaped(&format!(
                "{} facets in {} x {} tiles; errors are over tiles. Measured beside the scan: {}, the plainest law that tiles do \
                 not tell from the best.",
                self.slopes.facets,
                self.slopes.tiles_per_side,
                self.slopes.tiles_per_side,
                self.law().name()
            )),
            self.laws(),
            self.distances()
        );
        plain_page(&title, &verdict, &main)
    }

    /// Every law in a line.
    fn laws(&self) -> String {
        let row = |fit: &SlopeFit| {
            let value = |(name, value): &(String, Option<f64>)| {
                let error = fit.standard_errors.get(name).map_or(String::new(), |se| format!(" ± {se:.4}"));
                format!(
                    "{} {}{error}",
                    escaped(name),
                    value.map_or("–".into(), |value| format!("{value:.4}"))
                )
            };
            let values: Vec<String> = fit.parameters.0.iter().map(value).collect();
            let behind = fit.behind_se.map_or("–".into(), |se| format!("{:.5} ± {se:.5}", fit.behind));
            format!(
                "<tr><th>{}</th><td>{}</td><td>{behind}</td><td>{:.4}</td></tr>\n",
                escaped(&fit.name()),
                values.join("<br>"),
                fit.ks
            )
        };
        let rows: String = self.slopes.fits.iter().map(row).collect();
        let heads = "<th>law</th><th>parameters</th><th>behind the best, nats a facet</th><th>largest difference of shares</th>";
        let table =
            format!("<table class=\"facts\"><thead><tr>{heads}</tr></thead>\n<tbody>{rows}</tbody></table>");
        scrolled("Laws", &table)
    }

    fn distances(&self) -> String {
        let number = |value: Option<f64>| value.map_or("–".to_string(), |value| format!("{value:.4}"));
        let all = self.difference.incidences.iter().map(|incidence| {
            format!(
                "<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                escaped(&format!("theta_i {:.1}°, phi_i {:.1}°", incidence.theta_i_deg, incidence.phi_i_deg)),
                number(incidence.figures.l1),
                number(incidence.figures.l1_noise),
                escaped(&incidence.figures.shown())
            )
        });
        let table = format!(
            "<table class=\"facts\"><thead><tr><th>light</th><th>L1</th><th>noise alone</th><th>without noise</th></tr></thead>\n\
             <tbody>{}</tbody></table>",
            all.collect::<String>()
        );
        scrolled("Distances", &table)
    }

    /// The quantiles of the scan's slopes against those of each law with the axes of the law that was taken.
    fn slope_chart(&self, quantiles: &[Vec<SlopeQuantiles>]) -> Option<Chart> {
        let shown = self.slopes.fits.iter().zip(quantiles);
        let shown = shown.filter(|(fit, all)| fit.anisotropic == self.law().anisotropic && !all.is_empty());
        let series: Vec<Series> = shown
            .enumerate()
            .map(|(k, (fit, all))| {
                let style = SeriesStyle { marker: Marker::Ring, line: false, ..series_style(k) };
                Series::new(fit.law, all.iter().map(|both| [both.law, both.patch]).collect(), style)
            })
            .collect();
        let lengths = || series.iter().flat_map(|series| series.points.iter().flatten().copied());
        let (low, high) = (lengths().fold(f64::INFINITY, f64::min), lengths().fold(0.0, f64::max));
        if low >= high {
            return None;
        }
        let axis = |label: &str| ChartAxis::decades(label, [low, high]);
        let equal =
            Series::new("equal", vec![[low; 2], [high; 2]], SeriesStyle { dashes: "", ..model_style(5) });
        Some(Chart {
            title: "Quantiles of the slopes".into(),
            x: axis("slope of the law at the same share, units of alpha"),
            y: axis("slope of the scan, units of alpha"),
            series: std::iter::once(equal).chain(series).collect(),
        })
    }
}

/// The lobes of both tables in the plane of incidence.
fn lobe_charts([scan, law]: [Scene; 2]) -> Vec<Chart> {
    let incidences = spread(scan.table.grid.incidences(), MOST_INCIDENCES);
    let chart = |incidence: usize| {
        let series = [("scan", scan, MEASURED), ("surface of its law", law, series_style(1))];
        let series = series.map(|(label, scene, style)| {
            let cuts = scene.in_plane(incidence);
            let points: Vec<[f64; 2]> =
                cuts.iter().map(|cut| [cut.theta_deg, scene.total(incidence, cut.bin)]).collect();
            let error: Vec<f64> =
                cuts.iter().filter_map(|cut| scene.half_width_of_total(incidence, cut.bin)).collect();
            let error = if error.len() == points.len() { error } else { vec![] };
            Series { error, ..Series::new(label, points, style) }
        });
        let highest =
            series.iter().flat_map(|series| &series.points).map(|point| point[1]).fold(0.0, f64::max);
        let (theta, phi) = scan.table.grid.incidence_deg(incidence);
        (highest > 0.0).then(|| Chart {
            title: format!("Light at theta_i {theta:.1}°, phi_i {phi:.1}°"),
            x: ChartAxis::degrees("theta_r, degrees; the mirror's side is right", [-90.0, 90.0]),
            y: ChartAxis::linear("BRDF, 1/sr", [0.0, 1.1 * highest]),
            series: series.into(),
        })
    };
    incidences.into_iter().filter_map(chart).collect()
}
