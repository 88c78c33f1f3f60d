//! Several tables side by side, as those of a campaign with a list of roughnesses or materials: their figures as CSV, and a
//! page with joint plots.

mod csv;
mod page;

pub use csv::CSV_MARK;

use crate::campaign::{Alpha, Campaign};
use crate::report::Summary;
use crate::report::summary::PlannedSamples;
use crate::stats;

/// A table of a sweep.
pub struct SweptTable {
    /// The stem of its file.
    pub stem: String,
    /// Its roughness, where there is one.
    pub alpha: Option<Alpha>,
    /// Its material and, of clear facets, the side of the light.
    pub optics: String,
    /// Its summary.
    pub summary: Summary,
}

impl SweptTable {
    /// Of a table's file and what it was measured by; an imported one has no campaign.
    pub fn new(stem: String, campaign: Option<&Campaign>, summary: Summary) -> Self {
        SweptTable {
            stem,
            alpha: campaign.and_then(|campaign| campaign.alphas().first().copied().flatten()),
            optics: campaign.map_or(String::new(), |campaign| campaign.optics.label()),
            summary,
        }
    }

    /// What half of a 95 % interval is of a standard error: Student's limit for its realisations; `None` where it is
    /// not known how many there are.
    fn interval(&self) -> Option<f64> {
        let plan: PlannedSamples = serde_json::from_value(self.summary.plan.clone()?).ok()?;
        (plan.realisations > 1).then(|| stats::student_limit(0.05, plan.realisations as usize - 1))
    }
}

/// Tables that differ in something, in the order of their campaign.
pub struct ParameterSweep {
    /// What they have in common: the campaign's name, or that of the output.
    pub name: String,
    /// All tables.
    pub tables: Vec<SweptTable>,
}
