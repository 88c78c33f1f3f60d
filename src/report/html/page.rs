//! What a page is made of.

use super::specimen::ShownSpecimen;
use crate::appearance::Appearance;
use crate::bench::BenchAnswer;
use crate::campaign::Campaign;
use crate::fit::{self, FitData, NearestLaw};
use crate::instrument::{Grid, GridKind};
use crate::report::slices::Scene;
use crate::report::summary::Summary;
use crate::table::BrdfTable;
use crate::validate::{Prediction, expect};

/// Values of a table at most for which a law is fitted to be shown.
const MOST_FITTED: usize = 1 << 21;

/// What a page is made of.
pub struct Page<'a> {
    /// The table and the models of it; of a sensor that looks below the surface, those of one side.
    pub scene: Scene<'a>,
    /// The bins of the whole table.
    pub whole: &'a Grid,
    /// What it was measured by; an imported table has none.
    pub campaign: Option<&'a Campaign>,
    /// The masking that its surface is tested against: which model comes first.
    pub masking: Option<&'a str>,
    /// Its summary, as `measure` writes it.
    pub summary: &'a Summary,
    /// The law nearest to order 1 of the table, for its sphere; none where nothing can be fitted.
    pub best: Option<NearestLaw>,
    /// The first patch.
    pub specimen: ShownSpecimen,
    /// Answers of `gonio bench`, for the plots of error against samples.
    pub benches: &'a [BenchAnswer],
    /// Gloss, scatter and colour of light that comes back.
    pub appearance: Option<&'a Appearance>,
}

impl<'a> Page<'a> {
    /// The page of a table, alike for one just measured and for one from its file; without answers of `gonio bench` and the appearance.
    pub fn of(
        table: &'a BrdfTable,
        campaign: Option<&'a Campaign>,
        prediction: Option<&'a Prediction>,
        summary: &'a Summary,
        specimen: ShownSpecimen,
    ) -> Self {
        let realisations = campaign.map_or(0, |campaign| campaign.surface.realisations as usize);
        let scene = Scene { table, prediction, realisations };
        Page {
            scene,
            whole: &table.grid,
            campaign,
            masking: campaign.map(expect::masking),
            summary,
            best: best_fit(table, campaign),
            specimen,
            benches: &[],
            appearance: None,
        }
    }

    /// Place of the masking that the surface is tested against, 0 where there is none.
    pub fn masking_index(&self) -> usize {
        self.scene.prediction.map_or(0, |prediction| prediction.model.masking_index(self.masking))
    }
}

/// The law nearest to order 1 of a table, of those that `gonio fit` knows.
fn best_fit(table: &BrdfTable, campaign: Option<&Campaign>) -> Option<NearestLaw> {
    let values =
        table.grid.incidences().saturating_mul(table.grid.bins()).saturating_mul(table.colours.len());
    if values > MOST_FITTED || table.grid.kind == GridKind::HalfDifference {
        return None;
    }
    let data = FitData::new(table, campaign, None);
    fit::nearest(&data, &fit::models(&data, campaign))
}
