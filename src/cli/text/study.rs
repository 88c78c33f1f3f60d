//! A study in words and columns, at most 100 wide.

use crate::stats;
use crate::study::{LEVEL, Study};

impl Study {
    /// The printable report.
    pub fn lines(&self) -> Vec<String> {
        let number =
            |value: Option<f64>, digits: usize| value.map_or("n/a".into(), |v| format!("{v:.digits$}"));
        let mut lines = vec![format!(
            "{} turns of the sample, {} realisations; mirror images and folding are off",
            self.turns, self.realisations
        )];
        lines.push(format!("{:>9} {:>18} {:>9}", "theta_i", "anisotropy index", "+-"));
        for stop in &self.stops {
            let (index, se) = (stop.anisotropy_index, number(stop.anisotropy_index_se, 5));
            lines.push(format!("{:>9} {index:>18.5} {se:>9}", stop.theta_i_deg));
        }
        let (index, se) = (self.anisotropy_index, number(self.anisotropy_index_se, 5));
        lines.push(format!("{:>9} {index:>18.5} {se:>9}", "all"));
        lines.push(format!(
            "{:>9} {:>18} {:>9} {:>10} {:>10}",
            "harmonic", "amplitude", "+-", "crest, deg", "p"
        ));
        for harmonic in &self.harmonics {
            let (amplitude, se) = (harmonic.amplitude, number(harmonic.amplitude_se, 5));
            let p = harmonic.p_value.map_or("n/a".into(), |p| format!("{p:.2e}"));
            let (order, phase) = (harmonic.order, harmonic.phase_deg);
            let grid = if harmonic.counts { "" } else { "  the square grid's own, not counted" };
            lines.push(format!("{order:>9} {amplitude:>18.5} {se:>9} {phase:>10.2} {p:>10}{grid}"));
        }
        lines.push(self.verdict());
        lines.extend(self.worst.map(|worst| {
            format!(
                "isotropy costs most at theta_i {}, theta_r {}, phi_r {} from the light: {:.1} % of the mean there",
                worst.theta_i_deg,
                worst.theta_r_deg,
                worst.phi_r_deg,
                100.0 * worst.relative_deviation
            )
        }));
        lines.extend(self.fit_lines());
        lines
    }

    /// One roughness where isotropy stands, else two and their turn.
    fn fit_lines(&self) -> Vec<String> {
        let Some(((model, masking), t)) = self.model.zip(self.masking).zip(self.student_limit()) else {
            return Vec::new();
        };
        let x = |name| (name, self.alpha_x, self.alpha_x_se, 5);
        let parameters = match self.dimensions {
            Some(4) => vec![
                x("alpha_x"),
                ("alpha_y", self.alpha_y, self.alpha_y_se, 5),
                ("rotation_deg", self.rotation_deg, self.rotation_deg_se, 3),
            ],
            _ => vec![x("alpha")],
        };
        let mut lines = vec![format!("fit of {model} {masking}; +- one standard error by jackknife:")];
        for (name, value, se, digits) in parameters {
            let range = value.zip(se).map_or("n/a".into(), |(value, se)| {
                format!("{:.digits$} .. {:.digits$}", value - t * se, value + t * se)
            });
            let number = |value: Option<f64>| value.map_or("n/a".into(), |v| format!("{v:.digits$}"));
            lines.push(format!("{name:>14} {} +- {}; 95 %: {range}", number(value), number(se)));
        }
        lines
    }

    /// Student's t for intervals of 95 % from so many realisations.
    fn student_limit(&self) -> Option<f64> {
        (self.realisations > 1).then(|| stats::student_limit(0.05, self.realisations - 1))
    }

    fn verdict(&self) -> String {
        let level = 100.0 * LEVEL;
        match (self.p_value, self.dimensions) {
            (Some(p), Some(4)) => {
                format!("p = {p:.2e}: anisotropic at {level} %; the table needs 4 dimensions")
            }
            (Some(p), _) => format!("p = {p:.3}: isotropy stands at {level} %; 3 dimensions are enough"),
            (None, _) => "fewer than four realisations: no test, no errors, no fit".into(),
        }
    }
}
