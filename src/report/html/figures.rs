//! The figures of the page as tables: the comparisons, the albedos; and the cost.

use super::page::Page;
use super::sections::scrolled;
use crate::instrument::angle_decimals;
use crate::measure::Cost;
use crate::report::plot::escaped;
use crate::report::plot::plots::spread;
use crate::report::summary::{IncidenceSummary, Summary};
use crate::validate::compare::Comparison;
use crate::validate::error_measures::Figures;

/// Rows of the tables of incidences before the middle is left out.
const MOST_ROWS: usize = 48;

/// A column of albedos: its key, its heading, and its value.
type AlbedoColumn = (&'static str, &'static str, fn(&IncidenceSummary) -> Option<f64>);
const ALBEDOS: [AlbedoColumn; 4] = [
    ("albedo_single", "one bounce", |incidence| incidence.albedo_single),
    ("albedo_single_se", "±", |incidence| incidence.albedo_single_se),
    ("albedo_total", "all", |incidence| incidence.albedo_total),
    ("albedo_total_se", "±", |incidence| incidence.albedo_total_se),
];

/// The comparisons, the albedos, the cost.
pub fn figures(page: &Page) -> String {
    [of_light(page, ""), cost(page.summary)].concat()
}

/// The comparisons and the albedos of the light that `page` is of; `mark` ends the names of their tables.
pub fn of_light(page: &Page, mark: &str) -> String {
    [comparisons(page, mark), albedos(page, mark)].concat()
}

/// A number with `decimals` digits next to its key, or a dash.
fn cell(key: &str, value: Option<f64>, decimals: usize) -> String {
    let text = value.map_or("–".into(), |number| format!("{number:.decimals$}"));
    format!("<td data-key=\"{key}\">{text}</td>")
}

/// The light's angles (theta, phi) at each incidence; the azimuth where there are several.
fn angle_cells(page: &Page, angles: Vec<(f64, f64)>) -> impl Fn(usize) -> String + use<> {
    let of_theta = angle_decimals(1, angles.iter().map(|angle| angle.0));
    let of_phi = page.scene.has_azimuths().then(|| angle_decimals(1, angles.iter().map(|angle| angle.1)));
    move |incidence| {
        let (theta, phi) = angles[incidence];
        let azimuth = of_phi.map(|decimals| cell("phi_i_deg", Some(phi), decimals));
        cell("theta_i_deg", Some(theta), of_theta) + &azimuth.unwrap_or_default()
    }
}

fn distance(figures: &Figures) -> String {
    let (key, value) = figures.distance();
    cell(key, value, 4)
}

fn comparisons(page: &Page, mark: &str) -> String {
    let all = &page.summary.comparisons[..];
    let [first, ..] = all else {
        return "<p>No model speaks of this surface: nothing to compare with.</p>".into();
    };
    let heads: String =
        all.iter().map(|c| format!("<th>{}</th>", escaped(&c.masking.replace('_', "-")))).collect();
    let angles = angle_cells(page, first.incidences.iter().map(|s| (s.theta_i_deg, s.phi_i_deg)).collect());
    let row = |incidence: usize| {
        let here = |c: &Comparison| {
            c.incidences.get(incidence).map(|incidence| incidence.figures).unwrap_or_default()
        };
        let cells: String = all.iter().map(|c| distance(&here(c))).collect();
        format!(
            "<tr>{}{}{cells}</tr>",
            angles(incidence),
            cell("l1_noise", first.incidences[incidence].figures.l1_noise, 4)
        )
    };
    let rows: String = spread(first.incidences.len(), MOST_ROWS).into_iter().map(row).collect();
    let mean: String = all.iter().map(|c| distance(&c.figures)).collect();
    let [head, foot] = if page.scene.has_azimuths() { ["<th>phi_i</th>", "<td></td>"] } else { ["", ""] };
    let table = format!(
        "<table id=\"comparisons{mark}\"><thead><tr><th>theta_i</th>{head}<th>noise</th>{heads}</tr></thead>\n\
         <tbody>{rows}</tbody>\n<tfoot><tr><td>mean</td>{foot}{}{mean}</tr></tfoot></table>",
        cell("l1_noise", first.figures.l1_noise, 4)
    );
    format!(
        "<h2>Against the {} model</h2>\n<p>Flux-weighted L1 distance of order 1 from the model's bin means, by \
         masking, with the noise taken off.{}</p>\n{}",
        escaped(&first.model.replace('_', " ")),
        left_out(first.incidences.len()),
        scrolled("Distances from the model", &table)
    )
}

fn left_out(incidences: usize) -> String {
    if incidences > MOST_ROWS {
        format!(" {MOST_ROWS} of {incidences} light directions are listed.")
    } else {
        String::new()
    }
}

fn albedos(page: &Page, mark: &str) -> String {
    let incidences = &page.summary.incidences;
    // Another program's table does not know how often its light has bounced.
    let columns = if page.campaign.is_some() { &ALBEDOS[..] } else { &ALBEDOS[2..] };
    let is_known = |column: &&AlbedoColumn| incidences.iter().any(|incidence| column.2(incidence).is_some());
    let shown: Vec<&AlbedoColumn> = columns.iter().filter(is_known).collect();
    let Some((first, ..)) = shown.first() else { return String::new() };
    let alone = *first == "albedo_total";
    let head = |&&(key, head, _): &&AlbedoColumn| {
        format!("<th>{}</th>", if alone && key == "albedo_total" { "albedo" } else { head })
    };
    let heads: String = shown.iter().map(head).collect();
    let angles = angle_cells(
        page,
        incidences.iter().map(|incidence| (incidence.theta_i_deg, incidence.phi_i_deg)).collect(),
    );
    let row = |index: usize| {
        let cells: String =
            shown.iter().map(|(key, _, pick)| cell(key, pick(&incidences[index]), 5)).collect();
        format!("<tr>{}{cells}</tr>", angles(index))
    };
    let rows: String = spread(incidences.len(), MOST_ROWS).into_iter().map(row).collect();
    let azimuth = if page.scene.has_azimuths() { "<th>phi_i</th>" } else { "" };
    let what = if page.campaign.is_some() {
        " after one bounce, and after all that were followed; ±: standard error over patches."
    } else {
        ", from the bins."
    };
    let table = format!(
        "<table id=\"albedos{mark}\"><thead><tr><th>theta_i</th>{azimuth}{heads}</tr></thead><tbody>{rows}</tbody></table>"
    );
    format!(
        "<h2>Albedo</h2>\n<p>Share of the light that leaves{what}{}</p>\n{}",
        left_out(incidences.len()),
        scrolled("Albedos", &table)
    )
}

fn cost(summary: &Summary) -> String {
    let Some(Cost { wall_s, cpu_s, threads, samples, rays_traced, peak_bytes, .. }) = &summary.cost else {
        return "<p id=\"cost\">What the measurement cost stands in its summary, which is not next to the table.</p>\n".into();
    };
    let stopped = summary.stopped_by.map(|by| format!(" Stopped by: {}.", by.to_string().replace('_', " ")));
    let millions = |count: &u64| format!("{:.2} million", *count as f64 / 1e6);
    format!(
        "<p id=\"cost\">Cost: {wall_s:.1} s, {cpu_s:.1} s of processor time on {threads} threads; {} samples, {} rays, {:.0} \
         MB of memory.{}</p>\n",
        millions(samples),
        millions(rays_traced),
        *peak_bytes as f64 / 1e6,
        stopped.unwrap_or_default()
    )
}
