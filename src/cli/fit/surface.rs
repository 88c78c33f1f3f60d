//! `gonio fit --surface`: the law of a map's own slopes, and its BRDF beside the map's.

use std::path::Path;

use glam::DVec2;

use super::{Arguments, short};
use crate::campaign::{self, Alpha, Campaign, Parsed, SurfaceKind};
use crate::cli::table_file;
use crate::cli::text::layout::{columns, wrapped};
use crate::cli::text::output::{Output, inform, to_json};
use crate::cli::text::progress::Stage;
use crate::cli::text::terminal::Terminal;
use crate::error::{Error, Result};
use crate::files::{self, Destination};
use crate::fit::slopes::{self, SlopeFamily, SlopeFit, SlopeFits, SlopeTiles};
use crate::job::{Measurement, TablePaths, Written, paths};
use crate::measure::Patches;
use crate::report::html::render;
use crate::report::html::specimen::quantiles;
use crate::report::scan_law::ScanLaw;
use crate::report::slices::Scene;
use crate::validate::two_tables::{ComparedTable, difference};

/// Realisations of the law's surface: enough for its errors to be known, at most.
const REALISATIONS: [u32; 2] = [4, 16];
/// Cells of its side: about those of the map, within these.
const CELLS: [usize; 2] = [64, 512];

pub fn run(arguments: &Arguments, threads: usize) -> Result<u8> {
    let file = &arguments.table;
    let Parsed { campaign, .. } = campaign::read(file)?;
    if !campaign.surface.kind.is_map() {
        let why = "--surface is for a measured map ([surface.file]): other surfaces are made with a law that is known";
        return Err(Error::Usage(format!("{}: {why}", file.display())));
    }
    let stage = Stage::begin("fitting the slopes");
    let Patches::Map { map, .. } = Patches::prepare(&campaign, &mut Vec::new())? else {
        return Err(Error::Internal("a map is a map".into()));
    };
    let folder = paths::folder_of(arguments.output.as_deref(), &campaign);
    let page = Destination::at(folder.join(format!("{}.law.html", campaign.name)));
    paths::spare_inputs(&[&page], file, &campaign)?;
    if !arguments.force {
        paths::spare_foreign(&page, render::MARK, "page")?;
    }
    let tiles = SlopeTiles::of(&map.field, DVec2::new(map.alpha_x, map.alpha_y), map.excluded.as_ref());
    let families = SlopeFamily::all();
    let fits = slopes::fit(&tiles, &families)
        .ok_or_else(|| Error::Usage(format!("{}: the map is flat: its slopes have no law", campaign.name)))?;
    drop(stage);
    let taken = plainest(&fits);
    let side = map.field.cells_x().min(map.field.cells_y());
    let law = of_law(&campaign, side, &fits.fits[taken])?;
    let scan = measured(arguments, &campaign, file, threads)?;
    let beside = measured(arguments, &law, file, threads)?;
    let tables = [&scan, &beside].map(|paths| table_file::load_as_stored(&paths.table));
    let [first, second] = tables;
    let (first, second) = (first?, second?);
    let parts = [(&scan, &first), (&beside, &second)];
    let [of_scan, of_law] = parts.map(|(paths, table)| table_file::realisations_beside(&paths.table, table));
    let (of_scan, of_law) = (of_scan?, of_law?);
    let side = |table, campaign, parts| ComparedTable { campaign, parts, ..ComparedTable::of(table) };
    let found = difference(
        side(&first, Some(&campaign), of_scan.as_ref()),
        side(&second, Some(&law), of_law.as_ref()),
    );
    let found = found.map_err(|why| Error::format(&beside.table, why))?;
    let quantiles: Vec<_> = fits
        .fits
        .iter()
        .map(|fit| quantiles::of_lengths(&tiles.lengths(&fit.density), fit.density.lengths()))
        .collect();
    let files = [&scan, &beside].map(|paths| paths.table.display().to_string());
    let answer = ScanLaw { name: campaign.name.clone(), slopes: fits, taken, difference: found, files };
    let scenes = [(&first, &campaign), (&second, &law)].map(|(table, campaign)| Scene {
        table,
        prediction: None,
        realisations: campaign.surface.realisations as usize,
    });
    files::write_atomically(&page, answer.page(&quantiles, scenes).as_bytes())?;
    let mut out = Output::default();
    if arguments.json {
        out.json(&to_json(&answer)?)?;
    } else {
        out.lines(lines(&answer, &page))?;
    }
    Ok(0)
}

/// The law with the fewest parameters of those that tiles do not tell from the best.
fn plainest(fits: &SlopeFits) -> usize {
    let alike = (0..fits.fits.len()).filter(|&k| fits.fits[k].alike);
    alike.min_by_key(|&k| fits.fits[k].parameters.0.len()).unwrap_or(0)
}

/// The same campaign over random heights of the law, on patches about as large as a map of so many cells a side.
fn of_law(campaign: &Campaign, side: usize, fit: &SlopeFit) -> Result<Campaign> {
    let ([x, y], turn_deg, gamma) = fit.shape();
    let alphas = vec![Alpha::new(x, y)];
    let mut law = campaign.clone();
    law.name = format!("{}_law", campaign.name);
    law.surface.kind = match (fit.law, gamma) {
        (_, Some(gamma)) => SurfaceKind::StudentT { alphas, gamma },
        ("ggx", _) => SurfaceKind::Ggx(alphas),
        _ => SurfaceKind::Beckmann { alphas, spectrum: campaign::HeightSpectrum::Gaussian },
    };
    law.surface.rotation_deg = (campaign.surface.rotation_deg + turn_deg).rem_euclid(360.0);
    law.surface.cells = side.next_power_of_two().clamp(CELLS[0], CELLS[1]) as u32;
    law.surface.realisations = campaign.surface.realisations.clamp(REALISATIONS[0], REALISATIONS[1]);
    // What a random surface cannot be made with is refused as any campaign is.
    Ok(campaign::parse(campaign::to_toml(&law), &law.name, Path::new(""))?.campaign)
}

/// The table of a campaign, measured where it is not there yet.
fn measured(arguments: &Arguments, campaign: &Campaign, file: &Path, threads: usize) -> Result<TablePaths> {
    inform(format_args!("measuring {}", campaign.name));
    let terminal = Terminal::new(true, &|error| error);
    let folder = paths::folder_of(arguments.output.as_deref(), campaign);
    let job = Measurement::new(campaign.clone()).source(file).folder(folder).threads(threads);
    match job.force(arguments.force).watcher(&terminal).write()? {
        Written::Tables(mut all) if all.len() == 1 => Ok(all.remove(0)),
        _ => Err(Error::Usage(format!("{}: several materials: give optics one", campaign.name))),
    }
}

fn lines(answer: &ScanLaw, page: &Path) -> Vec<String> {
    let fits = &answer.slopes;
    let mut lines = wrapped("", &answer.verdict());
    lines.push(String::new());
    lines.push(format!(
        "slopes of {} facets in {} x {} tiles, the likeliest law first:",
        fits.facets, fits.tiles_per_side, fits.tiles_per_side
    ));
    let mut rows = Vec::new();
    for fit in &fits.fits {
        for (k, (name, value)) in fit.parameters.0.iter().enumerate() {
            let head = |text: String| if k == 0 { text } else { String::new() };
            let number = |value: Option<f64>| value.map_or("n/a".to_string(), |value| short(value, 4));
            rows.push(vec![
                head(fit.law.into()),
                name.clone(),
                number(*value),
                number(fit.standard_errors.get(name)),
                head(short(fit.behind, 5)),
                head(fit.behind_se.map_or("-".into(), |se| short(se, 5))),
                head(short(fit.ks, 4)),
            ]);
        }
    }
    lines.extend(columns(&["law", "parameter", "value", "+-", "behind", "+-", "ks"], &rows));
    lines.extend(wrapped(
        "",
        "behind: nats a facet less than the best; ks: largest difference of the shares of slopes. Errors are over tiles.",
    ));
    let law = answer.law();
    lines.extend(wrapped(
        "",
        &format!(
            "measured beside the scan: {}, the plainest that tiles do not tell from the best",
            law.name()
        ),
    ));
    if law.gamma_on_bound {
        lines.push(
            "its gamma stands at an end of 2 to 100: no surface is made with longer or shorter tails".into(),
        );
    }
    lines.push(String::new());
    let number = |value: Option<f64>| value.map_or("n/a".to_string(), |value| short(value, 4));
    let incidences = answer.difference.incidences.iter().map(|incidence| {
        let figures = &incidence.figures;
        vec![
            short(incidence.theta_i_deg, 1),
            short(incidence.phi_i_deg, 1),
            number(figures.l1),
            number(figures.l1_noise),
            figures.shown(),
        ]
    });
    let incidences: Vec<Vec<String>> = incidences.collect();
    lines.extend(columns(&["theta_i", "phi_i", "l1", "noise", "without noise"], &incidences));
    let [scan, beside] = &answer.files;
    lines.push(format!("tables  {scan}, {beside}"));
    lines.push(format!("page    {}", page.display()));
    lines
}
