//! The lobe in the plane of incidence as plain text.

use super::layout;
use crate::report::plot::plots::{incidence_name, spread};
use crate::report::slices::{Cut, Scene};

/// Columns of the plot inside its frame: one in the middle, and as many on either side.
const COLUMNS: usize = 61;
/// The same on a narrow terminal, next to the labels.
const FEW_COLUMNS: usize = 47;
/// Columns of a label and the frame.
const LABEL: usize = 10;
const ROWS: usize = 9;
/// Light angles that are drawn at most.
const MOST_ANGLES: usize = 3;

/// The plots of some light angles at the first azimuth; empty where no bins lie in the plane.
///
/// `*` measured, `-` the model with the masking `masking`, `+` both; heights are shares of the peak.
pub fn lobes(scene: &Scene, masking: usize) -> Vec<String> {
    let incidences = scene.sweeps().into_iter().next().map_or(Vec::new(), |sweep| sweep.incidences);
    let mut lines = Vec::new();
    for index in spread(incidences.len(), MOST_ANGLES) {
        lines.extend(lobe(scene, incidences[index], masking).into_iter().flatten());
    }
    if !lines.is_empty() {
        let half = columns_of_plot() / 2;
        lines.push(format!("{:8}-90{:>half$}{:>half$}", "", 0, 90));
        lines.push(match scene.maskings().get(masking) {
            Some(name) => format!("{:10}theta_r; * measured   - model, {name}   + both", ""),
            None => format!("{:10}theta_r; * measured", ""),
        });
    }
    lines
}

fn columns_of_plot() -> usize {
    if layout::width() >= LABEL + COLUMNS { COLUMNS } else { FEW_COLUMNS }
}

fn lobe(scene: &Scene, incidence: usize, masking: usize) -> Option<Vec<String>> {
    let cuts = scene.in_plane(incidence);
    let measured = |bin: usize| scene.single(incidence, bin);
    let model = |bin: usize| scene.model(masking, incidence, bin).unwrap_or(0.0);
    let highest = cuts.iter().map(|c| measured(c.bin).max(model(c.bin))).fold(0.0, f64::max);
    if cuts.len() < 2 || highest <= 0.0 {
        return None;
    }
    let row = |value: f64| ((1.0 - value / highest) * (ROWS - 1) as f64).round() as usize;
    let count = columns_of_plot();
    let marks = |column: usize| {
        let theta = -90.0 + 180.0 * column as f64 / (count - 1) as f64;
        let distance = |cut: &&Cut| (cut.theta_deg - theta).abs();
        let nearest = cuts.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        Some((row(measured(nearest.bin)), scene.prediction.map(|_| row(model(nearest.bin)))))
    };
    let columns: Vec<(usize, Option<usize>)> = (0..count).filter_map(marks).collect();
    let mark =
        |at: usize, &(measured, model): &(usize, Option<usize>)| match (measured == at, model == Some(at)) {
            (true, true) => '+',
            (true, false) => '*',
            (false, true) => '-',
            (false, false) => ' ',
        };
    let name = incidence_name(scene, incidence).replace('°', "");
    let mut lines = vec![format!("{name}: BRDF{} in the plane of incidence, 1/sr", scene.colour_note())];
    for at in 0..ROWS {
        let label = match at {
            0 => format!("{highest:8.3}"),
            _ if at == ROWS - 1 => format!("{:8}", 0),
            _ => " ".repeat(8),
        };
        let line: String = columns.iter().map(|column| mark(at, column)).collect();
        lines.push(format!("{label} |{}", line.trim_end()));
    }
    lines.push(format!("{:8} +{}", "", "-".repeat(count)));
    Some(lines)
}
