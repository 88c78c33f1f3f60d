//! The summary of a measurement: what `measure` writes next to a table as JSON, and what page and card say of it.

mod incidence;

use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use incidence::{ErrorLook, IncidenceSummary};

use crate::campaign::Surface;
use crate::error::{Error, Result};
use crate::measure::{Cost, Measured, Plan, StoppedBy, stopping};
use crate::table::BrdfTable;
use crate::validate::compare::Comparison;
use crate::validate::laws::{Energy, Reciprocity};
use crate::validate::prediction::schlick_error::SchlickError;
use crate::validate::verdict::SCOPES;
use crate::validate::{GeometricOptics, Judgement, Verdict};

/// The schema that is written and read.
pub const SCHEMA: u64 = 1;

/// The document. What is not available is null; what summaries of earlier versions lack may be absent.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Summary {
    /// [`SCHEMA`].
    pub schema: u64,
    /// Name of the campaign.
    pub name: String,
    /// Its seed.
    pub seed: u64,
    /// Version of the program that measured.
    pub version: String,
    /// The campaign's surface; null for a table without a campaign.
    pub surface: Option<Value>,
    /// The plan as it was carried out.
    pub plan: Option<Value>,
    /// What ended the run.
    pub stopped_by: Option<StoppedBy>,
    /// Time and memory; null where the table is all there is.
    pub cost: Option<Cost>,
    /// Each incidence of the table.
    #[serde(rename = "stops")]
    pub incidences: Vec<IncidenceSummary>,
    /// The table against each named model.
    #[serde(default)]
    pub comparisons: Vec<Comparison>,
    /// Flux.
    pub energy: Option<Energy>,
    /// Arms exchanged.
    pub reciprocity: Option<Reciprocity>,
    /// The masking with the smallest discrepancy.
    pub nearest_masking: Option<String>,
    /// The probability of its lead over the second where both are as near.
    pub nearest_p: Option<f64>,
    /// SHA-256 of the patches.
    pub patch_digest: String,
    /// Whether no law is broken and every expectation met; null where nothing was judged.
    pub ok: Option<bool>,
    /// The same in words.
    pub verdict: Option<String>,
    /// Each law.
    #[serde(default)]
    pub judgements: Vec<Judgement>,
    /// One sentence for each failure.
    #[serde(default)]
    pub failures: Vec<String>,
    /// Where geometric optics holds; null for a table without a campaign.
    #[serde(default)]
    pub geometric_optics: Option<GeometricOptics>,
    /// What Schlick's formula costs, for a material whose index is known.
    pub fresnel: Option<SchlickError>,
    /// SHA-256 of the table.
    pub table_digest: Option<String>,
    /// Of how many incidences the lists have which part, where the table is larger than a page.
    #[serde(skip)]
    pub thinned: Option<[usize; 2]>,
}

/// What is read again of a plan.
#[derive(Deserialize)]
pub struct PlannedSamples {
    /// Surface samples per incidence and realisation.
    pub samples: u64,
    /// Realisations.
    pub realisations: u64,
}

impl Summary {
    /// The summary of a table that was just measured, with its digest.
    pub fn measured(
        measured: &Measured,
        (plan, cost): (&Plan, &Cost),
        verdict: &Verdict,
        fresnel: Option<SchlickError>,
        table_digest: String,
    ) -> Result<Self> {
        let Measured { campaign, table, incidences, .. } = measured;
        let of_incidence =
            |(incidence, result)| IncidenceSummary::of_result(result, table.grid.incidence_deg(incidence));
        let listed = incidences.iter().enumerate().map(of_incidence).collect();
        Ok(Summary {
            plan: Some(as_json(plan)?),
            stopped_by: Some(stopping::of_run(incidences.iter().map(|incidence| incidence.stopped_by))),
            cost: Some(cost.clone()),
            fresnel,
            table_digest: Some(table_digest),
            ..Summary::of_table(&campaign.name, table, Some(&campaign.surface), Some(verdict), listed)?
        })
    }

    /// What is known of a table without the document: from its header, its verdict and what its `incidences` say.
    pub fn of_table(
        name: &str,
        header: &BrdfTable,
        surface: Option<&Surface>,
        verdict: Option<&Verdict>,
        incidences: Vec<IncidenceSummary>,
    ) -> Result<Self> {
        let judged = verdict.is_some();
        let verdict = verdict.cloned().unwrap_or_default();
        Ok(Summary {
            schema: SCHEMA,
            name: name.into(),
            seed: header.seed,
            version: header.version.clone(),
            surface: surface.map(as_json).transpose()?,
            plan: None,
            stopped_by: None,
            cost: None,
            incidences,
            comparisons: verdict.comparisons,
            energy: judged.then_some(verdict.energy),
            reciprocity: verdict.reciprocity,
            nearest_masking: verdict.nearest_masking,
            nearest_p: verdict.nearest_p,
            patch_digest: header.patch_digest.clone(),
            ok: judged.then_some(verdict.ok),
            verdict: judged.then_some(verdict.verdict),
            judgements: verdict.judgements,
            failures: verdict.failures,
            geometric_optics: verdict.geometric_optics,
            fresnel: None,
            table_digest: None,
            thinned: None,
        })
    }

    /// The samples that were planned.
    pub fn planned(&self) -> Option<PlannedSamples> {
        PlannedSamples::deserialize(self.plan.as_ref()?).ok()
    }

    /// The comparison with the nearest masking.
    pub fn nearest(&self) -> Option<&Comparison> {
        let nearest = self.nearest_masking.as_ref()?;
        self.comparisons.iter().find(|comparison| comparison.masking == *nearest)
    }

    /// What it says of the light on one side of the surface; of light that has gone through as an albedo.
    pub fn half(&self, below: bool) -> Self {
        let scope = SCOPES[usize::from(below)];
        let comparisons = self.comparisons.iter().filter(|c| c.scope == scope).cloned().collect();
        let incidences = self
            .incidences
            .iter()
            .map(|incidence| if below { incidence.through() } else { incidence.clone() });
        Summary { comparisons, incidences: incidences.collect(), ..self.clone() }
    }

    /// The same with some of the incidences alone.
    pub fn thinned(mut self, incidences: &[usize]) -> Self {
        let all = self.incidences.len();
        if all > incidences.len() {
            self.thinned = Some([incidences.len(), all]);
            self.incidences =
                incidences.iter().map(|&incidence| self.incidences[incidence].clone()).collect();
            for comparison in &mut self.comparisons {
                comparison.incidences = incidences
                    .iter()
                    .filter_map(|&incidence| comparison.incidences.get(incidence).cloned())
                    .collect();
            }
        }
        self
    }
}

fn as_json(data: &impl Serialize) -> Result<Value> {
    serde_json::to_value(data).map_err(|e| Error::Internal(format!("building JSON: {e}")))
}
