//! The page's further sections as HTML: the patch, the plots, what is left out, the foot.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::inline::Inline;
use super::page::Page;
use super::specimen::PatchPicture;
use crate::campaign::SurfaceKind;
use crate::report::plot::plots::{self, shown_incidences, shown_sweeps};
use crate::report::plot::polar::polar;
use crate::report::plot::{Chart, escaped};
use crate::report::plot::{convergence, ladders, masking};
use crate::report::slices::Scene;
use crate::table::header;

/// The picture's data for the script.
pub fn picture(specimen: &PatchPicture) -> Value {
    json!({
        "columns": specimen.cells[0],
        "rows": specimen.cells[1],
        "aspect": specimen.aspect,
        "shades": STANDARD.encode(&specimen.shades),
        "heights": STANDARD.encode(&specimen.relief.heights),
        "high": specimen.relief.high,
        "bar": specimen.relief.bar_cells,
        "bar_text": specimen.relief.bar_text,
    })
}

/// Error against samples, of a page that has it.
pub fn proof(page: &Page) -> String {
    let charts = convergence_charts(page);
    if charts.is_empty() {
        return String::new();
    }
    format!(
        "<section id=\"proof\" aria-label=\"Error against samples\">\n<h2>Error against samples</h2>\n{}</section>\n",
        figures_of(charts.iter().map(Chart::svg))
    )
}

/// All benches in one chart, the ladders of each, and what the run itself saw on its way.
fn convergence_charts(page: &Page) -> Vec<Chart> {
    let several = (page.benches.len() > 1).then(|| ladders::together(page.benches)).flatten();
    let ladders = page.benches.iter().flat_map(ladders::charts);
    several
        .into_iter()
        .chain(ladders)
        .chain(convergence::looks(&page.scene, &page.summary.incidences))
        .collect()
}

/// A table that is scrolled where the window is narrow, by keys too; `name` is what a screen reader says of it.
pub(crate) fn scrolled(name: &str, table: &str) -> String {
    format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">{table}</div>\n",
        escaped(name)
    )
}

pub(crate) fn figures_of(pictures: impl IntoIterator<Item = String>) -> String {
    let figures: String = pictures.into_iter().map(|svg| format!("<figure>{svg}</figure>\n")).collect();
    format!("<div class=\"charts\">\n{figures}</div>\n")
}

/// The patch, its certificate and its slopes.
pub fn specimen(page: &Page) -> String {
    let specimen = match &page.specimen {
        Ok(specimen) => specimen,
        Err(why) => return format!("<p id=\"no-patch\">{}</p>", escaped(why)),
    };
    let c = &specimen.facts.certificate;
    let (least, most) = c.azimuth_extremes();
    let rows = [
        (
            "distance from the slope law (Kolmogorov-Smirnov)",
            c.ks.map_or("no law wanted".into(), |ks| format!("{ks:.5}")),
        ),
        ("facets by azimuth, least to most (1 is even)", format!("{least:.3} to {most:.3}")),
        ("rank correlation of slope with height", format!("{:.4}", c.rank_correlation_height)),
        ("... with squared height", format!("{:.4}", c.rank_correlation_height_squared)),
        (
            "skewness and kurtosis of the heights",
            format!("{:.3}, {:.3}", c.height_skewness, c.height_kurtosis),
        ),
        if specimen.facts.of_map {
            ("lowest to highest, unit of the map", format!("{:.4e}", c.height_range))
        } else {
            ("lowest to highest, cells (alpha = 1)", format!("{:.2}", c.height_range))
        },
        (
            if specimen.facts.of_map { "median slope" } else { "median slope, units of alpha" },
            format!("{:.4}", c.median_slope),
        ),
    ];
    let rows: String =
        rows.iter().map(|(what, value)| format!("<tr><th>{what}</th><td>{value}</td></tr>")).collect();
    let ([columns, lines], name) = (specimen.cells, "Certificate of patch 0");
    let charts: String = [Some(specimen.slopes()), specimen.quantiles()]
        .iter()
        .flatten()
        .map(|chart| format!("<figure>{}</figure>\n", chart.svg()))
        .collect();
    format!(
        "<div class=\"charts\"><figure><canvas id=\"relief\" role=\"img\" aria-label=\"Relief of the patch\"></canvas>\
         <figcaption>{columns} x {lines} cells of patch 0 from above its corner at the smallest x and y, x to the right, y to the \
         left, lit from the left; heights are drawn {} times {} than they are.</figcaption></figure>\n<figure><canvas id=\"patch\" \
         role=\"img\" aria-label=\"Shaded patch\"></canvas><figcaption>The same from above, x to the right, lit from the upper left; \
         slopes are scaled to a median of 0.45.</figcaption></figure>\n{}{}</div>",
        specimen.relief.times(),
        if specimen.relief.exaggeration < 1.0 { "lower" } else { "higher" },
        charts,
        scrolled(name, &format!("<table class=\"facts\"><caption>{name}</caption>{rows}</table>"))
    )
}

/// The lobes in the plane of incidence, and their ratio to the model's.
pub(super) fn in_plane_plots(scene: &Scene, incidences: &[usize]) -> Vec<String> {
    let both = |&incidence: &usize| [plots::lobe(scene, incidence), plots::ratio(scene, incidence)];
    incidences.iter().flat_map(both).flatten().map(|chart| chart.svg()).collect()
}

/// All plots after the `first`, and what cannot be plotted.
pub fn plots(page: &Page, first: Vec<String>) -> String {
    let scene = &page.scene;
    let mut absent = Vec::new();
    let incidences = shown_incidences(scene);
    let lobes = in_plane_plots(scene, &incidences);
    if lobes.is_empty() {
        absent.push("No light in the plane of incidence, or no bins there: no in-plane lobes.".into());
    } else if incidences.len() < scene.table.grid.incidences() {
        absent.push(format!(
            "{} of {} light directions have plots.",
            incidences.len(),
            scene.table.grid.incidences()
        ));
    }
    let mut shown = [first, lobes].concat();
    for sweep in shown_sweeps(scene) {
        shown.extend(polar(scene, &sweep.incidences, page.masking_index()));
        shown.extend(plots::albedo(scene, &page.summary.incidences, &sweep).map(|chart| chart.svg()));
    }
    match plots::anisotropy(scene) {
        Some(chart) => shown.push(chart.svg()),
        None => absent.push(
            "One azimuth of the light (or none of its own): no plot of anisotropy against azimuth.".into(),
        ),
    }
    if convergence_charts(page).is_empty() {
        absent.push(if page.benches.is_empty() {
            "Error against samples: a campaign with stop.relative_error notes it on its way; `gonio bench` measures it, \
             for `gonio report --bench FILE`."
                .into()
        } else {
            "Error against samples: the bench holds no rung with an error above 0.".into()
        });
    }
    let scaled = page.campaign.is_some_and(|campaign| campaign.surface.kind.alphas().is_some());
    match masking::chart(scene, &page.summary.incidences, scaled) {
        Some(chart) => shown.push(chart.svg()),
        None => absent.push(no_masking(page).into()),
    }
    let absent: String = absent.iter().map(|why: &String| format!("<li>{}</li>", escaped(why))).collect();
    format!("{}<ul class=\"absent\">{absent}</ul>", figures_of(shown))
}

/// Why there is no plot of masking given the normal.
fn no_masking(page: &Page) -> &'static str {
    match page.campaign {
        None => "Masking given the normal (G1): only the measurement of a surface knows its facets.",
        Some(campaign) if !campaign.trace.visibility => {
            "Masking given the normal (G1): visibility is switched off."
        }
        Some(campaign) if matches!(campaign.surface.kind, SurfaceKind::Smith(_)) => {
            "Masking given the normal (G1): on a statistical Smith surface it is Smith's by construction."
        }
        Some(_) => {
            "Masking given the normal (G1) is not known: the summary next to the table has none, or not every facet was \
             started on, or paths left the map."
        }
    }
}

/// What the pictures and the viewer do not show of each half; without any they have nothing to show.
pub fn reduced(page: &Page, halves: &[&Inline]) -> String {
    let spots = halves.iter().any(|half| half.spots);
    let spots = if spots {
        "<p id=\"spots\">The sensor looks in single directions, too few to make a hemisphere: they are drawn as they \
         are, and there is no sphere.</p>"
    } else {
        ""
    };
    let mut notes: Vec<&str> = Vec::new();
    for note in halves.iter().flat_map(|half| &half.notes) {
        // Both halves mostly lack the same.
        if !notes.contains(&note.as_str()) {
            notes.push(note);
        }
    }
    let notes = match (halves, &notes[..]) {
        ([], _) => {
            let kind = serde_json::to_value(page.scene.table.grid.kind).unwrap_or_default();
            let kind = kind.as_str().unwrap_or("other").replace('_', " ");
            format!(
                "<p id=\"no-pictures\">This table's grid is of the kind “{}”, which the pictures and the viewer do not \
                 know.</p>",
                escaped(&kind)
            )
        }
        (_, []) => String::new(),
        (_, notes) => format!(
            "<p id=\"reduced\">Pictures and viewer hold {}. Plots and figures are of the whole table.</p>",
            escaped(&notes.join("; "))
        ),
    };
    let thinned = match page.summary.thinned {
        Some([kept, all]) => format!(
            "<p id=\"thinned\">The table is larger than this page can hold: plots, pictures and the figures by position \
             are of {kept} of its {all} positions of the light. Means over positions are of all of them.</p>"
        ),
        None => String::new(),
    };
    format!("{thinned}{notes}{spots}")
}

/// Version and conventions.
pub fn foot(page: &Page) -> String {
    let table = page.scene.table;
    let version = if table.version.is_empty() { "unknown" } else { &table.version };
    format!(
        "<p>gonio {}, seed {}. {}</p>",
        escaped(version),
        table.seed,
        escaped(&header::convention(page.whole))
    )
}
