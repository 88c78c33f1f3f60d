//! The head of the page: name, what was measured, the verdict.

use super::page::Page;
use crate::campaign::{Campaign, GrainShape, Optics, SurfaceKind};
use crate::instrument::grid::GridKind;
use crate::instrument::{Grid, angle_decimals};
use crate::report::plot::escaped;
use crate::validate::{GeometricOptics, Judgement, words};

/// Name, what was measured, the verdict.
pub fn head(page: &Page) -> String {
    let passed = page.summary.verdict.as_ref().is_some_and(|verdict| verdict.starts_with("passed"));
    let class = match page.summary.ok {
        Some(true) if passed => "ok",
        Some(false) => "failed",
        _ => "unknown",
    };
    let judgements: String = page.summary.judgements.iter().map(judgement).collect();
    let judgements =
        if judgements.is_empty() { judgements } else { format!("<ul id=\"judgements\">{judgements}</ul>") };
    format!(
        "<h1>{}</h1>\n<p id=\"what\">{}</p>\n<p id=\"verdict\" class=\"{class}\">{}</p>{judgements}",
        escaped(&page.summary.name),
        escaped(&measured(page)),
        escaped(&verdict(page))
    )
}

/// One law: its name, what is said of it, and why.
fn judgement(Judgement { law, ruling, reason, .. }: &Judgement) -> String {
    let words = ruling.to_string();
    let class = words.replace(' ', "-");
    format!("<li class=\"{class}\"><b>{}</b>: {words}: {}</li>", escaped(law), escaped(reason))
}

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
        0 => format!(" in {} directions", grid.incidences()),
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

fn surface(campaign: &Campaign) -> String {
    let alpha = match campaign.alphas().first().copied().flatten() {
        Some(alpha) => format!(", alpha {}", alpha.text()),
        None => String::new(),
    };
    let surface = &campaign.surface;
    let patches = if surface.realisations == 1 { "patch" } else { "patches" };
    let cells = format!("{} {patches} of {} x {} cells", surface.realisations, surface.cells, surface.cells);
    match &surface.kind {
        SurfaceKind::Ggx(_) => format!("A random GGX surface{alpha}, {cells}"),
        SurfaceKind::Beckmann { .. } => format!("A Gaussian (Beckmann) surface{alpha}, {cells}"),
        SurfaceKind::Psd(psd) => {
            format!("Gaussian heights by their power spectral density{alpha}, {cells} of {} um", psd.pitch_um)
        }
        SurfaceKind::StudentT { gamma, .. } => {
            format!("A random surface with Student's t of slopes, gamma {gamma}{alpha}, {cells}")
        }
        SurfaceKind::BlinnPhong { exponent, .. } => {
            format!("A random Blinn-Phong surface, exponent {exponent}, {cells}")
        }
        SurfaceKind::Smith(_) => format!("A statistical Smith surface{alpha}"),
        SurfaceKind::Grains(grains) => match grains.shape {
            GrainShape::Grains => format!("Grains on a plane{alpha}, {} {patches}", surface.realisations),
            GrainShape::Pits => format!("Pits in a plane{alpha}, {} {patches}", surface.realisations),
            GrainShape::Heights => format!("Random heights with the normals of grains{alpha}, {cells}"),
        },
        SurfaceKind::Mirror => "A flat mirror".into(),
        SurfaceKind::VGroove { slope } => format!("V-grooves along y of slope {slope}"),
        SurfaceKind::File(map) => format!("The height map {}", map.path),
    }
}

fn verdict(page: &Page) -> String {
    let (Some(_), Some(laws)) = (page.summary.ok, &page.summary.verdict) else {
        return "Nothing is known that this table should agree with.".into();
    };
    let waves = page.summary.geometric_optics.as_ref().and_then(GeometricOptics::words);
    let waves = waves.map_or(String::new(), |text| format!(" {}", words::sentence(&text)));
    let plain = format!("{}{waves}", words::in_words(&page.summary.judgements));
    let Some(comparison) = page.summary.nearest() else { return format!("Verdict: {laws}. {plain}") };
    let figures = &comparison.figures;
    let number = |value: Option<f64>| value.map_or("n/a".into(), |value| format!("{value:.4}"));
    let (key, distance) = figures.distance();
    format!(
        "Verdict: {laws}. {plain} Of the maskings, {} is nearest, {} of the flux away ({key}; noise {}).",
        comparison.masking.replace('_', "-"),
        number(distance),
        number(figures.l1_noise)
    )
}
