//! The summary of a measurement as JSON.

use serde_json::{Value, json};

use crate::measure::{Cost, Measured, Plan, StopResult, stopping};
use crate::stats;
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
        "patch_digest": measured.table.patch_digest,
        "ok": verdict.ok,
        "failures": verdict.failures,
    })
}

fn stop_summary(result: &StopResult, (theta_i_deg, phi_i_deg): (f64, f64)) -> Value {
    let (single, single_se) = result.single();
    let (total, total_se) = result.total();
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
        "orders": result.orders,
        "cut": result.cut,
        "hidden": result.hidden,
        "left_map": result.left_map,
        "outside": result.outside,
        "lost": 0,
        "samples": result.samples,
        "stopped_by": result.stopped_by,
        "relative_error": result.relative_error,
        "realisations_needed": result.realisations_needed,
        "closure": closure,
        "closure_se": closure_se,
    })
}

impl StopResult {
    /// Albedo of order 1 and its standard error, where they are known.
    pub fn single(&self) -> (Option<f64>, Option<f64>) {
        known(self.albedo_by_order[0].iter().copied())
    }

    /// Albedo of all orders and its standard error, where they are known.
    pub fn total(&self) -> (Option<f64>, Option<f64>) {
        let of = |realisation: usize| self.albedo_by_order.iter().map(|order| order[realisation]).sum();
        known((0..self.closure.len()).map(of))
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
