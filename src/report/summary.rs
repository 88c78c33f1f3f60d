//! The summary of a measurement as JSON.

use serde_json::{Value, json};

use crate::campaign::Surface;
use crate::measure::accumulate::lost_light;
use crate::measure::stopping::Look;
use crate::measure::{Cost, Measured, Plan, StopResult, stopping};
use crate::stats;
use crate::table::{BrdfTable, ColourChannels};
use crate::validate::Verdict;

/// The summary document of one table. What is not available is null.
pub fn summary(measured: &Measured, plan: &Plan, cost: &Cost, verdict: &Verdict) -> Value {
    let campaign = &measured.campaign;
    let stops: Vec<Value> = measured
        .stops
        .iter()
        .enumerate()
        .map(|(stop, result)| stop_summary(result, measured.table.grid.stop_deg(stop)))
        .collect();
    json!({
        "schema": 1,
        "name": campaign.name,
        "seed": campaign.seed,
        "version": measured.table.version,
        "surface": campaign.surface,
        "plan": plan,
        "stopped_by": stopping::of_run(measured.stops.iter().map(|stop| stop.stopped_by)),
        "cost": cost,
        "stops": stops,
        "comparisons": verdict.comparisons,
        "energy": verdict.energy,
        "reciprocity": verdict.reciprocity,
        "nearest_masking": verdict.nearest_masking,
        "nearest_p": verdict.nearest_p,
        "patch_digest": measured.table.patch_digest,
        "ok": verdict.ok,
        "verdict": verdict.verdict,
        "judgements": verdict.judgements,
        "failures": verdict.failures,
    })
}

/// What a summary says of a table whose own summary is not at hand: no cost, albedos from the bins, their errors null.
pub fn of_table(
    name: &str,
    table: &BrdfTable,
    surface: Option<&Surface>,
    verdict: Option<&Verdict>,
) -> Value {
    of_stops(name, table, surface, verdict, stops_of(table))
}

/// The stops of a table, or of a band of it, as its summary has them.
pub fn stops_of(table: &BrdfTable) -> Vec<Value> {
    (0..table.grid.stops()).map(|stop| table_stop(table, stop)).collect()
}

/// The same from the heading of a table and what its stops say.
pub fn of_stops(
    name: &str,
    table: &BrdfTable,
    surface: Option<&Surface>,
    verdict: Option<&Verdict>,
    stops: Vec<Value>,
) -> Value {
    json!({
        "name": name,
        "seed": table.seed,
        "version": table.version,
        "surface": surface,
        "stops": stops,
        "comparisons": verdict.map(|verdict| &verdict.comparisons),
        "energy": verdict.map(|verdict| &verdict.energy),
        "reciprocity": verdict.map(|verdict| &verdict.reciprocity),
        "nearest_masking": verdict.and_then(|verdict| verdict.nearest_masking.as_ref()),
        "nearest_p": verdict.and_then(|verdict| verdict.nearest_p),
        "patch_digest": table.patch_digest,
        "ok": verdict.map(|verdict| verdict.ok),
        "verdict": verdict.map(|verdict| &verdict.verdict),
        "judgements": verdict.map(|verdict| &verdict.judgements),
        "failures": verdict.map(|verdict| &verdict.failures),
    })
}

/// Flux over all bins, mean of the colours; an arm does not gather all flux.
fn table_stop(table: &BrdfTable, stop: usize) -> Value {
    let (theta_i_deg, phi_i_deg) = table.grid.stop_deg(stop);
    let (bins, regions) = (table.grid.bins(), table.grid.regions(stop));
    let flux = |values: &[f32]| {
        let here = values[stop * bins..].iter().zip(&regions);
        here.map(|(&value, region)| f64::from(value) * region.projected_solid_angle()).sum::<f64>()
    };
    let mean = |pick: fn(&ColourChannels) -> &Vec<f32>| {
        // Bins that fill the hemisphere, up to the rounding of their edges.
        let size: f64 = regions.iter().map(|region| region.projected_solid_angle()).sum();
        let whole = (size - std::f64::consts::PI).abs() < 1e-6 && table.gaps() == 0;
        whole.then(|| stats::mean(&table.colours.iter().map(|colour| flux(pick(colour))).collect::<Vec<_>>()))
    };
    let (single, total) = (mean(|colour| &colour.single), mean(|colour| &colour.total));
    json!({
        "theta_i_deg": theta_i_deg,
        "phi_i_deg": phi_i_deg,
        "albedo_single": single,
        "albedo_single_se": null,
        "albedo_total": total,
        "albedo_total_se": null,
        "albedo_by_order": null,
    })
}

fn stop_summary(result: &StopResult, (theta_i_deg, phi_i_deg): (f64, f64)) -> Value {
    let (single, single_se) = result.single();
    let (total, total_se) = result.total();
    let (beyond, beyond_se) = result.beyond_order_1();
    let (closure, closure_se) = known(result.closure.iter().copied());
    let by_order: Option<Vec<f64>> =
        result.albedo_by_order.iter().map(|order| known(order.iter().copied()).0).collect();
    json!({
        "theta_i_deg": theta_i_deg,
        "phi_i_deg": phi_i_deg,
        "albedo_single": single,
        "albedo_single_se": single_se,
        "albedo_total": total,
        "albedo_total_se": total_se,
        "albedo_by_order": by_order,
        "beyond_order_1": beyond,
        "beyond_order_1_se": beyond_se,
        "orders": result.orders,
        "cut": result.cut,
        "hidden": result.hidden,
        "left_map": result.left_map,
        "left_map_flux": result.lost_light[1],
        "outside": result.outside,
        "lost": 0,
        "samples": result.samples,
        "stopped_by": result.stopped_by,
        "relative_error": result.relative_error,
        "realisations_needed": result.realisations_needed,
        "looks": looks(result),
        "seen_by_slope": result.seen_by_slope,
        "closure": closure,
        "closure_se": closure_se,
    })
}

/// Error against samples, as far as the run looked at it.
fn looks(result: &StopResult) -> Vec<Value> {
    // Samples of a block follow from what the stop had in the end.
    let last = result.looks.last().map_or(1, |look| look.blocks);
    let block = result.samples / last.max(1);
    let look = |look: &Look| json!({ "samples": look.blocks * block, "relative_error": look.relative_error });
    result.looks.iter().map(look).collect()
}

impl StopResult {
    /// Albedo of order 1 and its standard error, where they are known.
    pub fn single(&self) -> (Option<f64>, Option<f64>) {
        self.covered(known(self.albedo_by_order[0].iter().copied()), self.lost_light[0])
    }

    /// Whether the light saw no start: then nothing is known of the albedo.
    pub fn is_dark(&self) -> bool {
        self.orders.iter().sum::<u64>() + self.cut + self.left_map + self.outside == 0
    }

    /// An albedo whose error covers what light over the edge of an open map may have added.
    fn covered(&self, (mean, se): (Option<f64>, Option<f64>), bound: f64) -> (Option<f64>, Option<f64>) {
        if self.is_dark() { (None, None) } else { (mean, se.map(|se| lost_light::with_bound(se, bound))) }
    }

    /// Albedo of all orders and its standard error, where they are known.
    pub fn total(&self) -> (Option<f64>, Option<f64>) {
        let of = |realisation: usize| self.albedo_by_order.iter().map(|order| order[realisation]).sum();
        self.covered(known((0..self.closure.len()).map(of)), self.lost_light[1])
    }
}

impl StopResult {
    /// What a model of single scattering misses, and its standard error: with F = 1 the share of the incident light that
    /// leaves later than after one bounce or is still on its way after the last order; with a material the share of the
    /// reflected light above order 1, where such orders are followed.
    ///
    /// Held by: `single_scattering_misses_three_tenths_of_a_rough_mirror` (tests/it/measure/energy.rs).
    pub fn beyond_order_1(&self) -> (Option<f64>, Option<f64>) {
        let orders = &self.albedo_by_order;
        let of = |realisation: usize| {
            let single = orders[0][realisation];
            if self.perfect {
                return self.closure[realisation] - single;
            }
            let total: f64 = orders.iter().map(|order| order[realisation]).sum();
            if total > 0.0 { (total - single) / total } else { 0.0 }
        };
        let seen = if self.perfect || orders.len() > 1 { self.closure.len() } else { 0 };
        self.covered(known((0..seen).map(of)), self.lost_light[1])
    }
}

/// Mean and standard error, if there are values at all.
fn known(values: impl Iterator<Item = f64> + Clone) -> (Option<f64>, Option<f64>) {
    if values.clone().next().is_none() {
        return (None, None);
    }
    let (mean, se) = stats::mean_and_se(values);
    (Some(mean), se)
}
