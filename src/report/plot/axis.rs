//! Axes: where values lie between their ends, and which of them get a tick.

/// One axis.
#[derive(Debug, Clone)]
pub struct ChartAxis {
    /// Quantity and unit.
    pub label: String,
    /// Lowest and highest value shown.
    pub range: [f64; 2],
    /// Whether it is logarithmic.
    pub log: bool,
    /// Distance of the ticks; `None`: a round number that suits.
    pub step: Option<f64>,
}

impl ChartAxis {
    /// A linear axis.
    pub fn linear(label: &str, range: [f64; 2]) -> Self {
        ChartAxis { label: label.into(), range, log: false, step: None }
    }

    /// An axis of angles, ticks at multiples of 15, 30 or 60 degrees.
    pub fn degrees(label: &str, range: [f64; 2]) -> Self {
        let width = range[1] - range[0];
        let step = [15.0, 30.0, 60.0].into_iter().find(|step| width / step <= 6.0).unwrap_or(90.0);
        ChartAxis { step: Some(step), ..ChartAxis::linear(label, range) }
    }

    /// A logarithmic axis from the decade at or below to that at or above.
    pub fn decades(label: &str, [low, high]: [f64; 2]) -> Self {
        let first = low.log10().floor();
        let last = high.log10().ceil().max(first + 1.0);
        ChartAxis { label: label.into(), range: [10f64.powf(first), 10f64.powf(last)], log: true, step: None }
    }

    /// Where a value lies between the ends, 0 to 1 inside.
    pub(super) fn place(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if self.log { (value / low).log10() / (high / low).log10() } else { (value - low) / (high - low) }
    }

    /// The values that get a tick and a number.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.range;
        if self.log {
            let (first, last) = (low.log10().round() as i32, high.log10().round() as i32);
            let step = ((last - first) as usize).div_ceil(6).max(1);
            return (first..=last).step_by(step).map(|k| (10f64.powi(k), decade(k))).collect();
        }
        let step = self.step.unwrap_or_else(|| nice_step((high - low) / 5.0));
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        (first..=last).map(|k| (k as f64 * step, format!("{:.decimals$}", k as f64 * step))).collect()
    }
}

/// 10^k as SVG text.
fn decade(k: i32) -> String {
    match k {
        0 => "1".into(),
        1 => "10".into(),
        -1 => "0.1".into(),
        _ => format!("10<tspan dy=\"-6\" font-size=\"11\">{k}</tspan>"),
    }
}

/// 1, 2, 3 or 5 (as degrees like it) times a power of ten, at least `rough`.
fn nice_step(rough: f64) -> f64 {
    let unit = 10f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 3.0, 5.0, 10.0];
    unit * steps.into_iter().find(|step| step * unit >= rough * 0.999).unwrap_or(10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |axis: ChartAxis| axis.ticks().into_iter().map(|tick| tick.1).collect::<Vec<_>>();
        assert_eq!(
            labels(ChartAxis::degrees("", [-90.0, 90.0])),
            ["-90", "-60", "-30", "0", "30", "60", "90"]
        );
        assert_eq!(labels(ChartAxis::linear("", [0.0, 1.0])), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(ChartAxis::decades("", [0.02, 30.0]).range, [0.01, 100.0]);
        assert_eq!(labels(ChartAxis::decades("", [0.2, 3.0])), ["0.1", "1", "10"]);
    }
}
