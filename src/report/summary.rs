//! The summary of a measurement as JSON.

use serde_json::{Value, json};

use crate::measure::{Cost, Measured, Plan};
use crate::validate::Verdict;

/// The summary document of one table.
pub fn summary(measured: &Measured, plan: &Plan, cost: &Cost, verdict: &Verdict) -> Value {
    json!({ "schema": 1, "name": measured.campaign.name, "plan": plan, "cost": cost, "comparisons": verdict.comparisons })
}
