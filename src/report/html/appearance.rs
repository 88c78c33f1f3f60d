//! The page's section of what standards ask: gloss, haze, scatter, reflectance factors and colours.

use super::page::Page;
use super::sections::scrolled;
use crate::appearance::colorimetry::{Illuminant, Observer};
use crate::appearance::reflectance::{Colour1976, Reflected};
use crate::appearance::report::{AppearanceAtAzimuth, first_azimuths};
use crate::appearance::{Appearance, Quantity};
use crate::interchange::radiance::colour::rgb;
use crate::render::picture::srgb;
use crate::report::plot::escaped;
use crate::report::plot::plots::spread;
use crate::table::{BrdfTable, Realisations};

/// The first azimuths of the light, and incidences, that are listed.
const MOST_AZIMUTHS: usize = 4;
const MOST_ROWS: usize = 24;

/// What the section shows of a table; nothing of one of light that has gone through alone.
pub fn shown(table: &BrdfTable, parts: Option<&Realisations>) -> Option<Appearance> {
    first_azimuths(table, parts, MOST_AZIMUTHS).ok()
}

/// The section; nothing where the page has no such figures.
pub fn section(page: &Page) -> String {
    let Some(found) = page.appearance else { return String::new() };
    let azimuths: String = found.azimuths.iter().map(|at| at_azimuth(found, at)).collect();
    format!(
        "<section id=\"appearance\" aria-label=\"Appearance\">\n<h2>Gloss, scatter, colour</h2>\n<p>What instruments by \
         ISO 2813, ISO 13803, ASTM E430, ISO 13696 and CIE 15 would read of the table. {}. n/a: the table does not say it.{}{}</p>\n\
         {azimuths}</section>\n",
        escaped(&capital(&found.colours)),
        if found.azimuths.len() == MOST_AZIMUTHS {
            " At most 4 azimuths of the light are listed."
        } else {
            ""
        },
        if found.realisations == 0 {
            String::new()
        } else {
            format!(" ±: standard error over {} realisations.", found.realisations)
        }
    )
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn at_azimuth(found: &Appearance, at: &AppearanceAtAzimuth) -> String {
    let title = if found.azimuths.len() > 1 {
        format!("<h3>Light from phi_i {}°</h3>\n", at.phi_i_deg)
    } else {
        String::new()
    };
    format!("{title}<div class=\"charts\">\n{}{}{}</div>\n", glossy(at), scattered(at), coloured(at))
}

/// A number with its error, or n/a with the reason where one points at it.
fn cell(quantity: &Quantity, decimals: usize) -> String {
    let note = quantity.note.as_ref().map_or(String::new(), |note| format!(" title=\"{}\"", escaped(note)));
    let text = match (quantity.value, quantity.se) {
        (None, _) => "n/a".into(),
        (Some(value), None) => format!("{value:.decimals$}"),
        (Some(value), Some(se)) => format!("{value:.decimals$} ± {se:.decimals$}"),
    };
    format!("<td{note}>{text}</td>")
}

fn glossy(at: &AppearanceAtAzimuth) -> String {
    let haze = &at.haze;
    let gloss =
        at.gloss.iter().map(|gloss| (format!("gloss at {}°, gloss units", gloss.angle_deg), &gloss.gloss));
    let others = [
        ("reflection haze at 20°", &haze.reflection_haze),
        ("the same, logarithmic", &haze.log_haze),
        ("haze at 30°, 2° off", &haze.haze_2),
        ("haze at 30°, 5° off", &haze.haze_5),
        ("distinctness of image at 30°", &haze.doi),
    ];
    let others = others.map(|(name, quantity)| (name.to_string(), quantity));
    let row = |(name, quantity): (String, &Quantity)| {
        let why = quantity.note.as_ref().map_or(String::new(), |note| escaped(note));
        format!("<tr><th>{name}</th>{}<td>{why}</td></tr>", cell(quantity, 2))
    };
    let rows: String = gloss.chain(others).map(row).collect();
    let name = "Gloss and image";
    scrolled(name, &format!("<table class=\"facts\"><caption>{name}</caption>{rows}</table>"))
}

fn scattered(at: &AppearanceAtAzimuth) -> String {
    let row = |index: usize| {
        let scatter = &at.scatter[index];
        let cells = [cell(&scatter.reflectance, 4), cell(&scatter.tis, 4)].concat();
        format!("<tr><td>{}</td>{cells}</tr>", scatter.theta_i_deg)
    };
    let rows: String = spread(at.scatter.len(), MOST_ROWS).into_iter().map(row).collect();
    let name = "Whole hemisphere";
    let table = format!(
        "<table><caption>{name}</caption><thead><tr><th>theta_i</th><th>reflectance</th><th>scattered (TIS)</th></tr></thead>\
         <tbody>{rows}</tbody></table>"
    );
    scrolled(name, &table)
}

fn coloured(at: &AppearanceAtAzimuth) -> String {
    let known: Vec<&Reflected> =
        at.reflectance.iter().filter(|reflected| reflected.factor.value.is_some()).collect();
    let row = |index: usize| {
        let reflected = known[index];
        let daylight =
            |colour: &&Colour1976| (colour.observer, colour.illuminant) == (Observer::Two, Illuminant::D65);
        let lab = reflected.colours.iter().find(daylight).map_or(String::new(), |colour| {
            let cells: String = colour.lab.iter().map(|value| format!("<td>{value:.2}</td>")).collect();
            format!("{cells}<td>{}</td>", swatch(colour.xyz))
        });
        format!(
            "<tr><td>{}</td><td>{}</td>{}{lab}</tr>",
            escaped(&reflected.geometry),
            reflected.theta_i_deg,
            cell(&reflected.factor, 4)
        )
    };
    let rows: String = spread(known.len(), 2 * MOST_ROWS).into_iter().map(row).collect();
    let has_colours = known.iter().any(|reflected| !reflected.colours.is_empty());
    let heads = if has_colours { "<th>L*</th><th>a*</th><th>b*</th><th>colour</th>" } else { "" };
    let light = if has_colours { ", D65, 2°" } else { "" };
    let name = "Reflectance factors";
    let table = format!(
        "<table><caption>{name}{light}</caption><thead><tr><th>geometry</th><th>theta_i</th><th>factor</th>{heads}</tr></thead>\
         <tbody>{rows}</tbody></table>"
    );
    scrolled(name, &table)
}

/// A patch of the colour under D65; of one brighter than white its hue at the brightness of white.
fn swatch(xyz: [f64; 3]) -> String {
    let brightest = xyz[1].max(100.0);
    let linear = rgb(xyz.map(|value| value / brightest));
    let [r, g, b] = linear.map(|value| (255.0 * srgb(value.clamp(0.0, 1.0))).round() as u8);
    format!(
        "<span style=\"display:inline-block;width:1.6em;height:1em;background:#{r:02x}{g:02x}{b:02x}\"></span>"
    )
}
