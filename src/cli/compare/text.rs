//! What `gonio compare` prints.

use std::path::{Path, PathBuf};

use crate::cli::text::layout::{columns, wrapped};
use crate::cli::text::numbers::or_na;
use crate::validate::prediction::aperture::Extrapolated;
use crate::validate::two_tables::{DifferenceFigures, TableDifference};

/// The rows of `--richardson`.
pub fn extrapolated_lines(rows: &[Extrapolated]) -> Vec<String> {
    let several = rows.iter().any(|row| row.colour > 0);
    let cells = |row: &Extrapolated| {
        let angles = [row.theta_i_deg, row.phi_i_deg, row.theta_r_deg, row.phi_r_deg];
        let mut cells = angles.map(|angle| angle.to_string()).to_vec();
        if several {
            cells.push(["R", "G", "B"][row.colour.min(2)].into());
        }
        cells.extend([row.wide, row.narrow, row.extrapolated].map(|value| format!("{value:.6}")));
        cells.push(or_na(row.extrapolated_se, 6));
        cells
    };
    let mut head = vec!["theta_i", "phi_i", "theta_r", "phi_r"];
    if several {
        head.push("colour");
    }
    head.extend(["A", "B", "(4 B - A)/3", "+-"]);
    let mut lines = vec!["BRDF, 1/sr, extrapolated to apertures of 0:".to_string()];
    lines.extend(columns(&head, &rows.iter().map(cells).collect::<Vec<_>>()));
    lines
}

/// What the column "without it" means, and how far off it may be.
fn interval(figures: &DifferenceFigures) -> Option<String> {
    let (low, high) = figures.l1_difference_low.zip(figures.l1_difference_high)?;
    Some(match figures.l1_difference {
        Some(_) => {
            format!("without it: l1 without noise, by realisations; 95 % interval {low:.5} to {high:.5}")
        }
        None => {
            "without it: on average between l1 - noise and l1; neither table has 4 realisations to say more"
                .into()
        }
    })
}

/// A against B.
pub fn lines(found: &TableDifference) -> Vec<String> {
    let errors = if found.paired { "paired by realisation" } else { "of both tables in quadrature" };
    let mut lines: Vec<String> = found.made_comparable.iter().flat_map(|step| wrapped("", step)).collect();
    lines.push(match found.bins {
        0 => "all orders, without errors of single bins; distances relative to B:".to_string(),
        bins => format!("{bins} bins of all orders, errors {errors}; distances relative to B:"),
    });
    let cells = |figures: &DifferenceFigures| {
        let share = figures.share_outside_95.map(|share| 100.0 * share);
        vec![
            or_na(figures.l1, 5),
            or_na(figures.l1_noise, 5),
            figures.shown(),
            or_na(figures.max_t, 2),
            or_na(share, 1),
        ]
    };
    let row = |head: [String; 2], figures: &DifferenceFigures| [head.to_vec(), cells(figures)].concat();
    let mut rows: Vec<Vec<String>> = found
        .incidences
        .iter()
        .map(|incidence| {
            row([incidence.theta_i_deg.to_string(), incidence.phi_i_deg.to_string()], &incidence.figures)
        })
        .collect();
    rows.push(row(["all".into(), String::new()], &found.figures));
    lines.extend(columns(&["theta_i", "phi_i", "l1", "noise", "without it", "max t", "% outside 95"], &rows));
    lines.extend(interval(&found.figures));
    if let Some((most, share)) = found.figures.max_e_n.zip(found.figures.share_e_n_above_1) {
        let text = format!(
            "{:.1} % of the bins above 1, the largest {most:.2}; |a - b| over the 95 % uncertainties of both (ISO 13528)",
            100.0 * share
        );
        lines.extend(wrapped("E_n: ", &text));
    }
    if let (Some((limit, most)), None) = (found.t_limit.zip(found.figures.max_t), found.disagreement()) {
        let bins = found.bins;
        lines.push(format!("largest t {most:.2}, 1 % limit of {bins} bins {limit:.2}: noise explains it"));
    }
    lines
}

/// A against each of several tables, a row each.
pub fn lines_of_many(a: &Path, others: &[PathBuf], all: &[TableDifference]) -> Vec<String> {
    let mut lines =
        vec![format!("A: {}; compared with each B, all orders; distances relative to B:", a.display())];
    let row = |(path, found): (&PathBuf, &TableDifference)| {
        let figures = &found.figures;
        vec![
            path.display().to_string(),
            or_na(figures.l1, 5),
            or_na(figures.l1_noise, 5),
            figures.shown(),
            or_na(figures.max_t, 2),
            or_na(found.t_limit, 2),
            if found.disagreement().is_some() { "differs" } else { "noise" }.into(),
        ]
    };
    let rows: Vec<Vec<String>> = others.iter().zip(all).map(row).collect();
    lines.extend(columns(&["B", "l1", "noise", "without it", "max t", "1 % limit", ""], &rows));
    for (path, found) in others.iter().zip(all) {
        for step in &found.made_comparable {
            lines.extend(wrapped(&format!("{}: ", path.display()), step));
        }
    }
    lines
}
