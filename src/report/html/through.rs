//! What the page of a table has more where light goes through the surface.
//!
//! Input: the pages of the two halves. Output: a section and charts as HTML, and what the viewer must know of the interface.

use serde_json::{Value, json};

use super::figures::of_light;
use super::page::Page;
use super::sections::{figures_of, in_plane_plots};
use crate::campaign::{Dielectric, LightSide, Optics};
use crate::report::plot::plots::{self, shown_incidences, shown_sweeps};
use crate::report::plot::polar::polar;

/// The view through the surface.
pub const VIEW: &str = include_str!("assets/through.html");
/// Its code.
pub const SCRIPT: &str = include_str!("assets/through.js");
/// How hemispheres of light that has gone through are to be read.
pub const HINT: &str = "<p class=\"hint\" id=\"through-hint\">R: light that comes back; T: light that has gone through, its \
                        disc seen through the surface from the same place: the middle is straight on, and theta_r is 180° less \
                        90° times the radius. ×: the direction of refraction at the mean plane (Snell), where its index is \
                        known and nothing is totally reflected. phi_r runs from x towards y, from the light's azimuth where \
                        the table's is relative.</p>\n";
/// What is said where the page shows light that has gone through alone.
pub const ALONE: &str = "<p id=\"through\">All figures and plots are of light that has gone through the surface, as a mirror in \
                         the horizon shows it: their theta_r is 180° less that of the table.</p>\n";

/// Light that has gone through, next to light that comes back: figures and plots.
pub fn section(page: &Page) -> String {
    let scene = &page.scene;
    let shown = in_plane_plots(scene, &shown_incidences(scene));
    let around = shown_sweeps(scene).into_iter().flat_map(|sweep| {
        let albedo = plots::albedo(scene, &page.summary.incidences, &sweep).map(|chart| chart.svg());
        polar(scene, &sweep.incidences, page.masking_index()).into_iter().chain(albedo).collect::<Vec<_>>()
    });
    format!(
        "<section id=\"through\" aria-label=\"Light that has gone through\">\n<h2>Light that has gone through</h2>\n\
         <p>As a mirror in the horizon shows it: theta_r is 180° less that of the table. Albedo stands for the share of the \
         light that goes through.</p>\n{}{}</section>\n",
        figures_of(shown.into_iter().chain(around)),
        of_light(page, "-through")
    )
}

/// The shares of the light that come back and go through, a chart for each azimuth of the light.
pub fn shares(back: &Page, through: &Page) -> Vec<String> {
    let masking = back.masking_index();
    let chart =
        |sweep| plots::shares([&back.scene, &through.scene], &back.summary.incidences, sweep, masking);
    shown_sweeps(&back.scene).iter().filter_map(chart).map(|chart| chart.svg()).collect()
}

/// The index of the far side over that of the light's, in the colour that is shown, and whether the light is inside.
pub fn interface(page: &Page) -> Value {
    let clear = page.campaign.and_then(|campaign| match &campaign.optics {
        Optics::Dielectric(clear) => Some(clear),
        _ => None,
    });
    let inside = clear.is_some_and(|clear| clear.light == LightSide::Back);
    let eta = |clear: &Dielectric| clear.by_colour().get(page.scene.colour()).map(|medium| medium.eta);
    let eta = clear.and_then(eta).map(|eta| if inside { 1.0 / eta } else { eta });
    json!({ "eta": eta, "inside": inside })
}
