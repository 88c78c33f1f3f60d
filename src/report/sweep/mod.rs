//! Several tables side by side, as those of a campaign with a list of roughnesses or materials: their figures as CSV and
//! NetCDF, and a page with joint plots.

mod columns;
mod csv;
mod fitted;
mod netcdf;
mod page;

pub use csv::CSV_MARK;
pub use netcdf::{FILL, NETCDF_MARK};

use crate::campaign::{Alpha, Campaign};
use crate::fit::Fit;
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
    /// Its correlation length in cells, of random heights.
    pub correlation_cells: Option<f64>,
    /// Its summary.
    pub summary: Summary,
    /// Its best fit, where one was made.
    pub fit: Option<Fit>,
}

impl SweptTable {
    /// Of a table's file and what it was measured by; an imported one has no campaign.
    pub fn new(stem: String, campaign: Option<&Campaign>, summary: Summary) -> Self {
        SweptTable {
            stem,
            alpha: campaign.and_then(|campaign| campaign.alphas().first().copied().flatten()),
            optics: campaign.map_or(String::new(), |campaign| campaign.optics.label()),
            correlation_cells: campaign
                .filter(|campaign| campaign.surface.kind.is_random_heights())
                .map(|campaign| campaign.surface.correlation_cells),
            summary,
            fit: None,
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
