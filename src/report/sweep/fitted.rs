//! The fits of a sweep: when they are made, and the roughness that comes out against that of the campaign.

use super::page::chart_of;
use super::{ParameterSweep, SweptTable};
use crate::campaign::Campaign;
use crate::fit::{self, Fit, FitData};
use crate::report::plot::style::ratio_style;
use crate::report::plot::{Chart, ChartAxis, Series, model_style};
use crate::table::{BrdfTable, Realisations};

/// Surface samples for each value of a table from which on a fit of all models takes less than a tenth of the measuring:
/// 0.6 ms a value against 1.75 us a sample (three incidences, 684 bins, 16 realisations), for which 3,400 would do.
const SAMPLES_PER_VALUE: f64 = 4000.0;

impl SweptTable {
    /// Whether a fit of a table of so many values is cheap next to its measuring; not where this is not known.
    pub fn fit_is_cheap(&self, values: usize) -> bool {
        self.summary.planned().is_some_and(|plan| {
            let samples =
                plan.samples as f64 * plan.realisations as f64 * self.summary.incidences.len() as f64;
            samples >= SAMPLES_PER_VALUE * values as f64
        })
    }

    /// The same with the best fit of its table, where there is one.
    pub fn fitted(
        self,
        table: &BrdfTable,
        campaign: Option<&Campaign>,
        parts: Option<&Realisations>,
    ) -> Self {
        let data = FitData::new(table, campaign, parts);
        let laws = fit::models(&data, campaign);
        let best = (!data.is_dark() && !laws.is_empty()).then(|| fit::best(&data, &laws));
        SweptTable { fit: best.filter(|fit| fit.did_not_fit.is_none()), ..self }
    }
}

impl ParameterSweep {
    /// The fitted roughness against that of the campaign, a row of points for each model, and the line where both are equal.
    pub(super) fn fitted_alpha(&self) -> Option<Chart> {
        let mut rows: Vec<Series> = Vec::new();
        for table in &self.tables {
            let Some((name, point, half)) = point(table) else { continue };
            let at = rows.iter().position(|row| row.label == name).unwrap_or_else(|| {
                rows.push(Series::new(name, Vec::new(), ratio_style(rows.len())));
                rows.len() - 1
            });
            rows[at].points.push(point);
            rows[at].error.push(half);
        }
        let ends = rows.iter().flat_map(|row| row.points.iter().map(|point| point[0]));
        let (low, high) = ends.fold((f64::INFINITY, 0.0f64), |(low, high), x| (low.min(x), high.max(x)));
        if low >= high {
            return None;
        }
        // Room for the outermost points.
        let room = 0.05 * (high - low);
        let (low, high) = ((low - room).max(0.0), high + room);
        let equal = Series::new("fitted = the campaign's", vec![[low, low], [high, high]], model_style(5));
        let series = std::iter::once(equal).chain(rows).collect();
        let axis = ChartAxis::linear("alpha of the campaign (along x)", [low, high]);
        chart_of("Fitted roughness".into(), axis, "alpha of the best fit", series)
    }
}

/// The best model's name, its roughness against the campaign's, and half of its 95 % interval.
fn point(table: &SweptTable) -> Option<(String, [f64; 2], f64)> {
    let (fit, alpha): (&Fit, f64) = (table.fit.as_ref()?, table.alpha?.x);
    let name = ["alpha", "alpha_x"].into_iter().find(|name| fit.parameters.get(name).is_some())?;
    let [low, high] = fit.intervals_95.as_ref()?.get(name)?;
    Some((fit.name(), [alpha, fit.parameters.get(name)?], 0.5 * (high - low)))
}
