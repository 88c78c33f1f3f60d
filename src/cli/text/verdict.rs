//! The verdict in words and columns, at most 100 wide.

use crate::validate::compare;
use crate::validate::compare::Comparison;
use crate::validate::verdict::Verdict;

impl Verdict {
    /// The table of the comparisons, where there are any; of a verdict the laws have a line each besides
    /// ([`Judgement::line`](crate::validate::Judgement::line)).
    pub fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(first) = self.comparisons.first() {
            lines.push(format!(
                "order 1 against {}, flux-weighted L1 of bin means, noise taken off:",
                formula(&first.model)
            ));
            lines.extend(self.comparison_lines(first));
        }
        lines
    }

    fn comparison_lines(&self, first: &Comparison) -> Vec<String> {
        let short = |masking: &str| masking.replace("_correlated", "").replace("direction", "direct.");
        let mut head = format!("{:>8} {:>7} {:>8}", "theta_i", "phi_i", "noise");
        for comparison in &self.comparisons {
            head += &format!(" {:>10}", short(&comparison.masking));
        }
        let several = self.comparisons.len() > 1;
        let mut lines = vec![head + if several { "  nearest" } else { "" }];
        let number = |value: Option<f64>| value.map_or("n/a".into(), |v| format!("{v:.4}"));
        for (k, stop) in first.stops.iter().enumerate() {
            let mut line =
                format!("{:>8} {:>7} {:>8}", stop.theta_i_deg, stop.phi_i_deg, number(stop.figures.l1_noise));
            for comparison in &self.comparisons {
                let figures = comparison.stops[k].figures;
                line += &format!(" {:>10}", figures.shown());
            }
            if self.comparisons.len() > 1 {
                line += &format!("  {}", self.nearest_at(k));
            }
            lines.push(line);
        }
        let mut line = format!("{:>8} {:>7} {:>8}", "mean", "", number(first.figures.l1_noise));
        for comparison in &self.comparisons {
            line += &format!(" {:>10}", comparison.figures.shown());
        }
        lines.push(
            line + &self
                .nearest_masking
                .as_ref()
                .filter(|_| self.comparisons.len() > 1)
                .map_or(String::new(), |m| format!("  {m}")),
        );
        lines
    }

    /// The nearest masking at a stop; `alike` where all are below their floors, the two nearest are not told apart by the
    /// paired test at the 5 % level, or all differ by less than a hundredth of the noise.
    fn nearest_at(&self, stop: usize) -> String {
        let figures = |c: &Comparison| c.stops[stop].figures;
        let l1: Vec<f64> = self.comparisons.iter().filter_map(|c| figures(c).l1).collect();
        let noise = figures(&self.comparisons[0]).l1_noise.unwrap_or(0.0);
        let spread =
            l1.iter().copied().fold(0.0, f64::max) - l1.iter().copied().fold(f64::INFINITY, f64::min);
        if spread <= 0.01 * noise {
            return "alike".into();
        }
        let models: Vec<_> = self.comparisons.iter().map(|c| &c.stops[stop]).collect();
        let models: Vec<_> = models.iter().map(|stop| (&stop.figures, &stop.by_part[..])).collect();
        let told = |nearest: &compare::Nearest| nearest.p.is_none_or(|p| p < 0.05);
        match compare::nearest(&models).filter(told) {
            Some(nearest) => self.comparisons[nearest.index].masking.clone(),
            None => "alike".into(),
        }
    }
}

/// The model as a formula where it has one for every pair of directions.
fn formula(model: &str) -> String {
    match model {
        "mirror" | "torrance_sparrow" => format!("the {model} model"),
        ndf => format!("{ndf} D F G2/(4 |n.l||n.v|)"),
    }
}
