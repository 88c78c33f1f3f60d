//! A study in words and columns, at most 100 wide.

use super::layout::columns;
use super::numbers::or_na;
use crate::stats;
use crate::study::{AzimuthHarmonic, LEVEL, Study};

impl Study {
    /// The printable report.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "{} turns of the sample, {} realisations; mirror images and folding are off",
            self.turns, self.realisations
        )];
        let index = |incidence: String, index: f64, se: Option<f64>| {
            vec![incidence, format!("{index:.5}"), or_na(se, 5)]
        };
        let mut rows: Vec<Vec<String>> = self
            .incidences
            .iter()
            .map(|incidence| {
                index(
                    incidence.theta_i_deg.to_string(),
                    incidence.anisotropy_index,
                    incidence.anisotropy_index_se,
                )
            })
            .collect();
        rows.push(index("all".into(), self.anisotropy_index, self.anisotropy_index_se));
        lines.extend(columns(&["theta_i", "anisotropy index", "+-"], &rows));
        let harmonic = |harmonic: &AzimuthHarmonic| {
            let note = if harmonic.counts { "" } else { "the square grid's own, not counted" };
            vec![
                harmonic.order.to_string(),
                format!("{:.5}", harmonic.amplitude),
                or_na(harmonic.amplitude_se, 5),
                format!("{:.2}", harmonic.phase_deg),
                harmonic.p_value.map_or("n/a".into(), |p| format!("{p:.2e}")),
                note.into(),
            ]
        };
        let rows: Vec<Vec<String>> = self.harmonics.iter().map(harmonic).collect();
        let table = columns(&["harmonic", "amplitude", "+-", "crest, deg", "p", ""], &rows);
        lines.extend(table.iter().map(|line| line.trim_end().into()));
        lines.push(verdict(self));
        lines.extend(self.worst.map(|worst| {
            format!(
                "isotropy costs most at theta_i {}, theta_r {}, phi_r {} from the light: {:.1} % of the mean there",
                worst.theta_i_deg,
                worst.theta_r_deg,
                worst.phi_r_deg,
                100.0 * worst.relative_deviation
            )
        }));
        lines.extend(fit_lines(self));
        lines
    }
}

/// One roughness where isotropy stands, else two and their turn.
fn fit_lines(study: &Study) -> Vec<String> {
    let (Some(model), Some(masking), 2..) = (&study.model, &study.masking, study.realisations) else {
        return Vec::new();
    };
    // Student's t for intervals of 95 %.
    let t = stats::student_limit(0.05, study.realisations - 1);
    let x = |name| (name, study.alpha_x, study.alpha_x_se, 5);
    let parameters = match study.dimensions {
        Some(4) => vec![
            x("alpha_x"),
            ("alpha_y", study.alpha_y, study.alpha_y_se, 5),
            ("rotation_deg", study.rotation_deg, study.rotation_deg_se, 3),
        ],
        _ => vec![x("alpha")],
    };
    let mut lines = vec![format!("fit of {model} {masking}; +- one standard error by jackknife:")];
    for (name, value, se, digits) in parameters {
        let range = value.zip(se).map_or("n/a".into(), |(value, se)| {
            format!("{:.digits$} .. {:.digits$}", value - t * se, value + t * se)
        });
        lines.push(format!("{name:>14} {} +- {}; 95 %: {range}", or_na(value, digits), or_na(se, digits)));
    }
    lines
}

fn verdict(study: &Study) -> String {
    let level = 100.0 * LEVEL;
    match (study.p_value, study.dimensions) {
        (Some(p), Some(4)) => {
            format!("p = {p:.2e}: anisotropic at {level} %; the table needs 4 dimensions")
        }
        (Some(p), _) => format!("p = {p:.3}: isotropy stands at {level} %; 3 dimensions are enough"),
        (None, _) => "fewer than four realisations: no test, no errors, no fit".into(),
    }
}
