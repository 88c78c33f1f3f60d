//! Quantiles of a patch's slopes against those of their law: where tails are too short or too long.

use crate::report::plot::{Chart, ChartAxis, MEASURED, Marker, Series, SeriesStyle, model_style};
use crate::surface::{Heightfield, SlopeLaw};

/// Facets that are sorted at most, evenly picked.
const MOST_FACETS: usize = 1 << 20;
/// Fewest facets beyond the last quantile.
const BEYOND: f64 = 20.0;
/// Quantiles to either side of the median.
const HALF: usize = 24;

/// The same share of the slopes, of the law and of the patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlopeQuantiles {
    /// Length of the law, units of alpha.
    pub law: f64,
    /// Length of the patch.
    pub patch: f64,
}

/// Quantiles at shares evenly spread in log(share/(1 - share)), as far as 20 facets lie beyond; without those where the law
/// has none but 0.
// Tested by `quantiles_of_the_laws_own_slopes_lie_on_the_line`.
pub fn of(field: &Heightfield, law: SlopeLaw) -> Vec<SlopeQuantiles> {
    let cells = field.cells_x() * field.cells_y();
    let step = (2 * cells).div_ceil(MOST_FACETS);
    // A part in 1e7 of a length is not seen.
    let mut lengths: Vec<f32> = (0..2 * cells)
        .step_by(step)
        .map(|facet| {
            let cell = facet / 2;
            field.corners(cell % field.cells_x(), cell / field.cells_x()).slope(facet % 2 == 1).length()
                as f32
        })
        .collect();
    radsort::sort(&mut lengths);
    let lengths: Vec<f64> = lengths.into_iter().map(f64::from).collect();
    of_lengths(&lengths, law)
}

/// The same of sorted lengths (one at least) in units of alpha.
pub fn of_lengths(sorted: &[f64], law: SlopeLaw) -> Vec<SlopeQuantiles> {
    let count = sorted.len() as f64;
    let last = (count / BEYOND - 1.0).max(1.0).ln();
    let share = |k: usize| 1.0 / (1.0 + (-last * (k as f64 / HALF as f64 - 1.0)).exp());
    let at = |share: f64| SlopeQuantiles {
        law: law.length_quantile(share),
        // Half a facet: the middle of a step.
        patch: sorted[((share * count) as usize).min(sorted.len() - 1)],
    };
    (0..=2 * HALF).map(share).map(at).filter(|both| both.law > 0.0 && both.patch > 0.0).collect()
}

/// The chart, with the line of equal quantiles; `None` without any.
pub fn chart(all: &[SlopeQuantiles]) -> Option<Chart> {
    let ends = all.iter().flat_map(|both| [both.law, both.patch]);
    let [low, high] =
        ends.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], length| [low.min(length), high.max(length)]);
    if all.is_empty() || high <= low {
        return None;
    }
    let points = all.iter().map(|both| [both.law, both.patch]).collect();
    let style = SeriesStyle { marker: Marker::Ring, line: false, ..MEASURED };
    let axis = |label: &str| {
        let ChartAxis { range: [first, last], .. } = ChartAxis::decades(label, [low, high]);
        // The first numbers of both axes would stand upon each other in the corner.
        ChartAxis { range: [0.6 * first, last], ..ChartAxis::decades(label, [low, high]) }
    };
    let x = axis("slope of the law at the same share");
    let line = vec![[x.range[0]; 2], [x.range[1]; 2]];
    Some(Chart {
        title: "Quantiles of the slopes".into(),
        y: axis("slope of the patch"),
        x,
        series: vec![
            Series::new("equal", line, SeriesStyle { dashes: "", ..model_style(1) }),
            Series::new("quantiles of patch 0, units of alpha", points, style),
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_the_laws_own_slopes_lie_on_the_line() {
        let count = 20_000;
        for law in [SlopeLaw::Ggx, SlopeLaw::Beckmann] {
            let slopes: Vec<f64> =
                (0..count).map(|k| law.length_quantile((f64::from(k) + 0.5) / f64::from(count))).collect();
            let found = of_lengths(&slopes, law);
            assert_eq!(found.len(), 2 * HALF + 1);
            for both in found {
                // A share is a step of 1/20,000 off at most, 1/20 of what lies beyond the last quantile; lengths follow with no
                // more than half of that (GGX, by the root).
                assert!((both.patch / both.law - 1.0).abs() < 0.03, "{law:?}: {both:?}");
            }
        }
    }
}
