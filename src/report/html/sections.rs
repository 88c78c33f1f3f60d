//! The page's sections as HTML: what was measured, the verdict, the figures, the patch, the plots.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::inline::Inline;
use super::page::Page;
use super::specimen::PatchPicture;
use crate::campaign::{Optics, SurfaceKind};
use crate::instrument::grid::GridKind;
use crate::instrument::{Grid, angle_decimals};
use crate::report::plot::chart::escaped;
use crate::report::plot::convergence;
use crate::report::plot::masking;
use crate::report::plot::plots;
use crate::report::plot::plots::{shown_stops, shown_sweeps, spread};
use crate::report::plot::polar::polar;

/// Rows of the tables of stops before the middle is left out.
const MOST_ROWS: usize = 48;

/// Name, what was measured, the verdict.
pub fn head(page: &Page) -> String {
    let ok = page.summary["ok"].as_bool();
    let passed = page.summary["verdict"].as_str().is_some_and(|verdict| verdict.starts_with("passed"));
    let class = match ok {
        Some(true) if passed => "ok",
        Some(false) => "failed",
        _ => "unknown",
    };
    let judgements = page.summary["judgements"].as_array().into_iter().flatten().map(judgement);
    let judgements: String = judgements.collect();
    let judgements =
        if judgements.is_empty() { judgements } else { format!("<ul id=\"judgements\">{judgements}</ul>") };
    format!(
        "<h1>{}</h1>\n<p id=\"what\">{}</p>\n<p id=\"verdict\" class=\"{class}\">{}</p>{judgements}",
        escaped(page.name()),
        escaped(&measured(page)),
        escaped(&verdict(page, ok))
    )
}

/// One law: its name, what is said of it, and why.
fn judgement(judgement: &Value) -> String {
    let text = |key: &str| escaped(judgement[key].as_str().unwrap_or_default());
    let words = text("verdict");
    let class = words.replace(' ', "-");
    format!("<li class=\"{class}\"><b>{}</b>: {words}: {}</li>", text("law"), text("reason"))
}

/// What was measured, one sentence.
fn measured(page: &Page) -> String {
    let grid = &page.scene.table.grid;
    let surface = page.campaign.map_or("A table without a campaign".into(), surface);
    let rounds = page.scene.rounds();
    let decimals = angle_decimals(0, rounds.iter().map(|round| round.angle_deg)).max(3);
    let angles: Vec<String> = rounds.iter().map(|round| shortened(round.angle_deg, decimals)).collect();
    let angles = match angles.len() {
        0..=12 => angles.join(", "),
        count => format!("{count} angles from {} to {}", angles[0], angles[count - 1]),
    };
    let azimuths = match grid.phi_i_deg.len() {
        0 => format!(" in {} directions", grid.stops()),
        1 if grid.phi_r_relative => " (azimuth relative)".into(),
        1 => format!(", phi_i {}°", grid.phi_i_deg[0]),
        count => format!(", {count} azimuths from {}° to {}°", grid.phi_i_deg[0], grid.phi_i_deg[count - 1]),
    };
    let sensor = sensor(grid);
    let optics = page.campaign.map_or(String::new(), |campaign| match &campaign.optics {
        Optics::PerfectMirror => "; facets reflect everything (F = 1)".into(),
        Optics::Schlick { f0, .. } => {
            format!("; Schlick's Fresnel with F0 = {}, {}, {}", f0[0], f0[1], f0[2])
        }
        other => format!("; {}", other.described()),
    });
    format!("{surface}; light at theta_i {angles} degrees{azimuths}; {sensor}{optics}.")
}

/// An angle of up to so many decimals, without zeros at their end.
fn shortened(angle: f64, decimals: usize) -> String {
    let text = format!("{angle:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

/// Where the sensor looks, in words.
fn sensor(grid: &Grid) -> String {
    let bins = grid.bins();
    match grid.kind {
        GridKind::Hemisphere => {
            let (rows, columns) = (grid.theta_r_edges_deg.len() - 1, grid.phi_r_edges_deg.len() - 1);
            format!("a hemisphere of {rows} x {columns} bins")
        }
        GridKind::Arm => {
            let aperture = grid.aperture_deg.unwrap_or(0.0);
            format!("{bins} positions of a sensor arm, aperture ±{aperture}°")
        }
        GridKind::Patches => format!("{bins} patches of the hemisphere"),
        GridKind::Points => format!("{bins} single directions of the sensor"),
        GridKind::HalfDifference => format!("{bins} cells of half and difference angles"),
    }
}

fn surface(campaign: &crate::campaign::Campaign) -> String {
    let alpha = match campaign.alphas().first().copied().flatten() {
        Some(alpha) if alpha.x == alpha.y => format!(", alpha {}", alpha.x),
        Some(alpha) => format!(", alpha {} along x and {} along y", alpha.x, alpha.y),
        None => String::new(),
    };
    let surface = &campaign.surface;
    let patches = if surface.realisations == 1 { "patch" } else { "patches" };
    let cells = format!("{} {patches} of {} x {} cells", surface.realisations, surface.cells, surface.cells);
    match &surface.kind {
        SurfaceKind::Ggx(_) => format!("A random GGX surface{alpha}, {cells}"),
        SurfaceKind::Beckmann { .. } => format!("A Gaussian (Beckmann) surface{alpha}, {cells}"),
        SurfaceKind::StudentT { gamma, .. } => {
            format!("A random surface with Student's t of slopes, gamma {gamma}{alpha}, {cells}")
        }
        SurfaceKind::BlinnPhong { exponent, .. } => {
            format!("A random Blinn-Phong surface, exponent {exponent}, {cells}")
        }
        SurfaceKind::Smith(_) => format!("A statistical Smith surface{alpha}"),
        SurfaceKind::Mirror => "A flat mirror".into(),
        SurfaceKind::VGroove { slope } => format!("V-grooves along y of slope {slope}"),
        SurfaceKind::File(map) => format!("The height map {}", map.path),
    }
}

/// The verdict, one sentence.
fn verdict(page: &Page, ok: Option<bool>) -> String {
    let (Some(_), Some(laws)) = (ok, page.summary["verdict"].as_str()) else {
        return "Nothing is known that this table should agree with.".into();
    };
    let laws = format!("Verdict: {laws}");
    let comparisons = &page.summary["comparisons"];
    let nearest = page.summary["nearest_masking"].as_str().unwrap_or_default();
    let with = |masking: &str| comparisons.as_array()?.iter().find(|c| c["masking"] == masking).cloned();
    let Some(comparison) = with(nearest) else {
        return format!("{laws}.");
    };
    let number = |key: &str| comparison[key].as_f64().map_or("n/a".into(), |value| format!("{value:.4}"));
    let distance = if comparison["l1_model"].is_null() { "l1" } else { "l1_model" };
    format!(
        "{laws}. Of the maskings, {} is nearest, {} of the flux away ({distance}; noise {}).",
        nearest.replace('_', "-"),
        number(distance),
        number("l1_noise")
    )
}

/// The comparisons, the albedos, the cost.
pub fn figures(page: &Page) -> String {
    [comparisons(page), albedos(page), cost(page.summary)].concat()
}

/// A number with `decimals` digits behind its key, or a dash.
fn cell(value: &Value, key: &str, decimals: usize) -> String {
    let text = value[key].as_f64().map_or("–".into(), |number| format!("{number:.decimals$}"));
    format!("<td data-key=\"{key}\">{text}</td>")
}

/// The light's angles at each of these stops; the azimuth where there are several.
fn angle_cells<'a>(page: &Page, stops: &'a [Value]) -> impl Fn(usize) -> String + use<'a> {
    let keys: &[&str] =
        if page.scene.has_azimuths() { &["theta_i_deg", "phi_i_deg"] } else { &["theta_i_deg"] };
    let decimals = |key: &&str| angle_decimals(1, stops.iter().filter_map(|stop| stop[*key].as_f64()));
    let decimals: Vec<usize> = keys.iter().map(decimals).collect();
    move |index| {
        keys.iter().zip(&decimals).map(|(key, &decimals)| cell(&stops[index], key, decimals)).collect()
    }
}

fn comparisons(page: &Page) -> String {
    let Some(all) = page.summary["comparisons"].as_array().filter(|all| !all.is_empty()) else {
        return "<p>No model speaks of this surface: nothing to compare with.</p>".into();
    };
    let several = page.scene.has_azimuths();
    let maskings = all.iter().filter_map(|c| c["masking"].as_str());
    let heads: String =
        maskings.map(|name| format!("<th>{}</th>", escaped(&name.replace('_', "-")))).collect();
    let stops = all[0]["stops"].as_array().map_or(&[][..], Vec::as_slice);
    let angles = angle_cells(page, stops);
    let distance = |value: &Value| {
        if value["l1_model"].is_null() { cell(value, "l1", 4) } else { cell(value, "l1_model", 4) }
    };
    let row = |stop: usize| {
        let here = |c: &Value| c["stops"][stop].clone();
        let cells: String = all.iter().map(|c| distance(&here(c))).collect();
        format!("<tr>{}{}{cells}</tr>", angles(stop), cell(&here(&all[0]), "l1_noise", 4))
    };
    let rows: String = spread(stops.len(), MOST_ROWS).into_iter().map(row).collect();
    let mean: String = all.iter().map(distance).collect();
    let azimuth = if several { ["<th>phi_i</th>", "<td></td>"] } else { ["", ""] };
    let model = escaped(&all[0]["model"].as_str().unwrap_or("model").replace('_', " "));
    format!(
        "<h2>Against the {model} model</h2>\n<p>Flux-weighted L1 distance of order 1 from the model's bin means, by \
         masking, with the noise taken off.{}</p>\n<div class=\"scroll\"><table id=\"comparisons\"><thead><tr>\
         <th>theta_i</th>{}<th>noise</th>{heads}</tr></thead>\n<tbody>{rows}</tbody>\n<tfoot><tr><td>mean</td>{}{}{mean}\
         </tr></tfoot></table></div>\n",
        left_out(stops.len()),
        azimuth[0],
        azimuth[1],
        cell(&all[0], "l1_noise", 4)
    )
}

fn left_out(stops: usize) -> String {
    if stops > MOST_ROWS {
        format!(" {MOST_ROWS} of {stops} light directions are listed.")
    } else {
        String::new()
    }
}

fn albedos(page: &Page) -> String {
    let Some(stops) = page.summary["stops"].as_array() else { return String::new() };
    let several = page.scene.has_azimuths();
    // Another program's table does not know how often its light has bounced.
    let keys: &[_] = if page.campaign.is_some() {
        &["albedo_single", "albedo_single_se", "albedo_total", "albedo_total_se"]
    } else {
        &["albedo_total", "albedo_total_se"]
    };
    let known = |key: &str| stops.iter().any(|stop| stop[key].is_number());
    let shown: Vec<&str> = keys.iter().copied().filter(|key| known(key)).collect();
    if shown.is_empty() {
        return String::new();
    }
    let heads: String =
        shown.iter().map(|key| format!("<th>{}</th>", header(key, shown[0] == "albedo_total"))).collect();
    let angles = angle_cells(page, stops);
    let row = |index: usize| {
        let stop = &stops[index];
        let cells: String = shown.iter().map(|key| cell(stop, key, 5)).collect();
        format!("<tr>{}{cells}</tr>", angles(index))
    };
    let rows: String = spread(stops.len(), MOST_ROWS).into_iter().map(row).collect();
    let azimuth = if several { "<th>phi_i</th>" } else { "" };
    let what = if page.campaign.is_some() {
        " after one bounce, and after all that were followed; ±: standard error over patches."
    } else {
        ", from the bins."
    };
    format!(
        "<h2>Albedo</h2>\n<p>Share of the light that leaves{what}{}</p>\n<div class=\"scroll\"><table id=\"albedos\">\
         <thead><tr><th>theta_i</th>{azimuth}{heads}</tr></thead><tbody>{rows}</tbody></table></div>\n",
        left_out(stops.len())
    )
}

/// What stands over a column of albedos, of which there may be one `alone`.
fn header(key: &str, alone: bool) -> &str {
    match key {
        "albedo_single" => "one bounce",
        "albedo_total" if alone => "albedo",
        "albedo_total" => "all",
        _ => "±",
    }
}

fn cost(summary: &Value) -> String {
    let cost = &summary["cost"];
    let number = |key: &str| cost[key].as_f64();
    let Some((wall, cpu)) = number("wall_s").zip(number("cpu_s")) else {
        return "<p id=\"cost\">What the measurement cost stands in its summary, which is not beside the table.</p>\n".into();
    };
    let stopped = summary["stopped_by"].as_str().map(|by| format!(" Stopped by: {}.", by.replace('_', " ")));
    let stopped = escaped(&stopped.unwrap_or_default());
    let count = |key: &str| number(key).map_or("n/a".into(), |count| format!("{:.2} million", count / 1e6));
    format!(
        "<p id=\"cost\">Cost: {wall:.1} s, {cpu:.1} s of processor time on {} threads; {} samples, {} rays, {:.0} MB of \
         memory.{stopped}</p>\n",
        cost["threads"],
        count("samples"),
        count("rays_traced"),
        number("peak_bytes").unwrap_or(0.0) / 1e6
    )
}

/// The picture's data for the script.
pub fn picture(specimen: &PatchPicture) -> Value {
    json!({
        "columns": specimen.cells[0],
        "rows": specimen.cells[1],
        "aspect": specimen.aspect,
        "shades": STANDARD.encode(&specimen.shades),
    })
}

/// The patch, its certificate and its slopes.
pub fn specimen(page: &Page) -> String {
    let specimen = match &page.specimen {
        Ok(specimen) => specimen,
        Err(why) => return format!("<p id=\"no-patch\">{}</p>", escaped(why)),
    };
    let c = &specimen.certificate;
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
        if specimen.of_map {
            ("lowest to highest, unit of the map", format!("{:.4e}", c.height_range))
        } else {
            ("lowest to highest, cells (alpha = 1)", format!("{:.2}", c.height_range))
        },
        (
            if specimen.of_map { "median slope" } else { "median slope, units of alpha" },
            format!("{:.4}", c.median_slope),
        ),
    ];
    let rows: String =
        rows.iter().map(|(what, value)| format!("<tr><th>{what}</th><td>{value}</td></tr>")).collect();
    let [columns, lines] = specimen.cells;
    format!(
        "<div class=\"charts\"><figure><canvas id=\"patch\" role=\"img\" aria-label=\"Shaded patch\"></canvas>\
         <figcaption>{columns} x {lines} cells of patch 0, x to the right, lit from the upper left; slopes are scaled to a \
         median of 0.45.</figcaption></figure>\n<figure>{}</figure>\n<div class=\"scroll\"><table class=\"facts\"><caption>\
         Certificate of patch 0</caption>{rows}</table></div></div>",
        specimen.slopes().svg()
    )
}

/// All plots, and what cannot be plotted.
pub fn plots(page: &Page) -> String {
    let scene = &page.scene;
    let mut shown = Vec::new();
    let mut absent = Vec::new();
    let stops = shown_stops(scene);
    for &stop in &stops {
        shown.extend(plots::lobe(scene, stop).map(|chart| chart.svg()));
        shown.extend(plots::ratio(scene, stop).map(|chart| chart.svg()));
    }
    if shown.is_empty() {
        absent.push("No light in the plane of incidence, or no bins there: no in-plane lobes.".into());
    } else if stops.len() < scene.table.grid.stops() {
        absent.push(format!("{} of {} light directions have plots.", stops.len(), scene.table.grid.stops()));
    }
    for sweep in shown_sweeps(scene) {
        shown.extend(polar(scene, &sweep.stops, page.masking_index()));
        shown.extend(plots::albedo(scene, &page.summary["stops"], &sweep).map(|chart| chart.svg()));
    }
    match plots::anisotropy(scene) {
        Some(chart) => shown.push(chart.svg()),
        None => absent.push(
            "One azimuth of the light (or none of its own): no plot of anisotropy against azimuth.".into(),
        ),
    }
    match page.bench.map(convergence::charts) {
        Some(Ok(charts)) => shown.extend(charts.iter().map(|chart| chart.svg())),
        Some(Err(why)) => absent.push(format!("Error against samples: the document {why}.")),
        None => {}
    }
    match convergence::looks(scene, &page.summary["stops"]) {
        Some(chart) => shown.push(chart.svg()),
        None if page.bench.is_some() => {}
        None => absent.push(
            "Error against samples: a campaign with stop.relative_error notes it on its way; `gonio bench` measures it, \
             for `gonio report --bench FILE`."
                .into(),
        ),
    }
    let scaled = page.campaign.is_some_and(|campaign| campaign.surface.kind.alphas().is_some());
    match masking::chart(scene, &page.summary["stops"], scaled) {
        Some(chart) => shown.push(chart.svg()),
        None => absent.push(no_masking(page).into()),
    }
    let figures: String = shown.iter().map(|svg| format!("<figure>{svg}</figure>\n")).collect();
    let absent: String = absent.iter().map(|why: &String| format!("<li>{}</li>", escaped(why))).collect();
    format!("<div class=\"charts\">\n{figures}</div>\n<ul class=\"absent\">{absent}</ul>")
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
            "Masking given the normal (G1) is not known: the summary beside the table has none, or not every facet was \
             started on, or paths left the map."
        }
    }
}

/// What the pictures and the viewer do not show; `None`: they have nothing to show.
pub fn reduced(page: &Page, inlined: Option<&Inline>) -> String {
    let spots = inlined.is_some_and(|inlined| inlined.spots);
    let spots = if spots {
        "<p id=\"spots\">The sensor looks in single directions, too few to make a hemisphere: they are drawn as they \
         are, and there is no sphere.</p>"
    } else {
        ""
    };
    let notes = match inlined.map(|inlined| &inlined.notes[..]) {
        None => {
            let kind = serde_json::to_value(page.scene.table.grid.kind).unwrap_or_default();
            let kind = kind.as_str().unwrap_or("other").replace('_', " ");
            format!(
                "<p id=\"no-pictures\">This table's grid is of the kind “{}”, which the pictures and the viewer do not \
                 know.</p>",
                escaped(&kind)
            )
        }
        Some([]) => String::new(),
        Some(notes) => format!(
            "<p id=\"reduced\">Pictures and viewer hold {}. Plots and figures are of the whole table.</p>",
            escaped(&notes.join("; "))
        ),
    };
    let thinned = match page.summary["page_stops"].as_array().map(Vec::as_slice) {
        Some([kept, all]) => format!(
            "<p id=\"thinned\">The table is larger than this page can hold: plots, pictures and the figures by position \
             are of {kept} of its {all} positions of the light. Means over positions are of all of them.</p>"
        ),
        _ => String::new(),
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
        escaped(crate::table::store::CONVENTION_TEXT)
    )
}
