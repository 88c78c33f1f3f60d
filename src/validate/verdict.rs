//! The verdict on a table: every comparison, every law, and what failed.

use serde::Serialize;

use super::compare::{self, Comparison, IncidenceComparison};
use super::expect::{self, Bar};
use super::geometric::GeometricOptics;
use super::judgement::{self, Judgement, Ruling};
use super::laws::{Energy, Reciprocity};
use super::pairs::PairValues;
use super::parts::Parts;
use super::prediction::Prediction;
use super::seen::SeenLight;
use super::words;
use crate::campaign::{Campaign, GrainShape};
use crate::error::Result;
use crate::instrument::{Grid, GridKind};
use crate::surface::grains::mean_count;
use crate::table::{BrdfTable, Realisations, TableRows};

/// Why a table of random heights without shadowing and masking misses its bar, and where to look.
const OWN_SLOPES: &str = "; without shadowing and masking only the patches' own slopes differ from the model's: \
                          `gonio surface` prints how far they are off, `expect.l1_model` sets another bar";

/// Everything that validation finds.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Verdict {
    /// Whether no law is broken and every expectation met, as far as they could be judged.
    pub ok: bool,
    /// The same in words: which laws passed, which failed, which were not judged.
    pub verdict: String,
    /// Each law.
    pub judgements: Vec<Judgement>,
    /// One sentence for each failure.
    pub failures: Vec<String>,
    /// The table against each named model.
    pub comparisons: Vec<Comparison>,
    /// Flux.
    pub energy: Energy,
    /// Arms exchanged; null where no two incidences see each other.
    pub reciprocity: Option<Reciprocity>,
    /// The masking with the smallest discrepancy; null where none can be distinguished from 0.
    pub nearest_masking: Option<String>,
    /// The probability of its lead over the second where both are as near (`compare::nearest`).
    pub nearest_p: Option<f64>,
    /// What the table was tested against.
    pub bar: Option<Bar>,
    /// Where geometric optics holds; null without a campaign.
    pub geometric_optics: Option<GeometricOptics>,
}

/// What a comparison of light that comes back is of, and of light that has gone through.
pub const SCOPES: [&str; 2] = ["single", "single_through"];

/// Tests a table against the laws, and against the models of its campaign; an imported one has no campaign.
///
/// ```no_run
/// let table = gonio::table::store::load("out/quickstart/quickstart.exr".as_ref())?.table;
/// // Without its campaign and realisations: energy and reciprocity alone, as far as they can be judged.
/// println!("{}", gonio::validate::examine(&table, None, None).verdict);
/// # Ok::<(), gonio::error::Error>(())
/// ```
// Tested by `an_imported_table_is_held_to_the_laws` (tests/it/cli.rs).
pub fn examine<'a>(
    table: &BrdfTable,
    campaign: impl Into<Option<&'a Campaign>>,
    realisations: Option<&Realisations>,
) -> Verdict {
    let campaign = campaign.into();
    let prediction = campaign.and_then(|campaign| Prediction::of(campaign, &table.grid));
    examine_against(table, campaign, realisations, prediction.as_ref())
}

/// The same against a prediction that is at hand: bin means are the expensive part of a verdict.
pub fn examine_against<'a>(
    table: &BrdfTable,
    campaign: impl Into<Option<&'a Campaign>>,
    realisations: Option<&Realisations>,
    prediction: Option<&Prediction>,
) -> Verdict {
    let mut examination = Examination::new(campaign.into(), &table.grid);
    examination.add(table, 0, realisations.map(|all| Parts { all, first_incidence: 0 }), prediction);
    examination.verdict()
}

/// Tests a stored table, a band of incidences after the other: none is larger than `bytes` with its prediction. The figures
/// are those of the whole table.
// Tested by `a_table_examined_by_rows_has_the_verdict_of_the_whole` (tests/it/table/large_tables.rs).
pub fn examine_rows(
    rows: &mut TableRows,
    campaign: Option<&Campaign>,
    realisations: Option<&Realisations>,
    bytes: u64,
) -> Result<Verdict> {
    rows.verify()?;
    let mut examination = Examination::new(campaign, &rows.grid().clone());
    for incidences in rows.bands(bytes, row_bytes(rows)) {
        let first_incidence = incidences.start;
        let band = rows.take(&incidences.collect::<Vec<_>>())?;
        let prediction = campaign.and_then(|campaign| Prediction::of(campaign, &band.grid));
        let parts = realisations.map(|all| Parts { all, first_incidence });
        examination.add(&band, first_incidence, parts, prediction.as_ref());
    }
    Ok(examination.verdict())
}

/// Bytes of an incidence and of what theory predicts for it: f64 means of each colour with each of three maskings.
pub fn row_bytes(rows: &TableRows) -> u64 {
    rows.row_bytes() + predicted_bytes(rows.grid().bins(), rows.colours())
}

/// Bytes of the prediction for an incidence.
pub fn predicted_bytes(bins: usize, colours: usize) -> u64 {
    8 * 3 * (bins * colours) as u64
}

/// An examination under way: the incidences come in their order, in bands.
pub struct Examination {
    campaign: Option<Campaign>,
    grid: Grid,
    /// Name of the model, and for each masking its name and the incidences so far.
    model: String,
    /// By scope and masking.
    compared: Vec<(&'static str, String, Vec<IncidenceComparison>)>,
    energy: Energy,
    seen: SeenLight,
    pairs: Option<PairValues>,
}

impl Examination {
    /// Of a table of all incidences of `grid`; without a campaign it is tested against the laws alone.
    pub fn new(campaign: Option<&Campaign>, grid: &Grid) -> Self {
        let visibility = campaign.is_none_or(|campaign| campaign.trace.visibility);
        let exact = match campaign {
            Some(campaign) => {
                grid.kind == GridKind::Arm && grid.aperture_deg == Some(campaign.light.aperture_deg)
            }
            // Values at directions are the same thing both ways round; means over bins of different shape are not.
            None => grid.kind == GridKind::Points || grid.aperture_deg == Some(0.0),
        };
        Examination {
            campaign: campaign.cloned(),
            grid: grid.clone(),
            model: String::new(),
            compared: Vec::new(),
            energy: Energy::default(),
            seen: SeenLight::default(),
            // What goes through comes back from the other side, in another table.
            pairs: above(grid)
                .filter(|_| visibility)
                .map(|above| PairValues::new(&above, exact, campaign.and_then(independent_facets))),
        }
    }

    /// Takes the next incidences; `realisations` and `prediction` are theirs.
    pub fn add(
        &mut self,
        band: &BrdfTable,
        first_incidence: usize,
        realisations: Option<Parts>,
        prediction: Option<&Prediction>,
    ) {
        let visibility = self.campaign.as_ref().is_none_or(|campaign| campaign.trace.visibility);
        self.energy.join(Energy::of(band, visibility));
        self.seen.add(band);
        if !band.grid.looks_below() {
            return self.add_side(SCOPES[0], (band, first_incidence), realisations, prediction);
        }
        for (scope, below) in SCOPES.into_iter().zip([false, true]) {
            let Some(half) = band.half(below) else { continue };
            let all = realisations.and_then(|parts| parts.all.half(&band.grid, parts.first_incidence, below));
            let parts = all.as_ref().map(|all| Parts { all, first_incidence: 0 });
            let prediction = prediction.and_then(|prediction| prediction.half(&band.grid, below));
            self.add_side(scope, (&half, first_incidence), parts, prediction.as_ref());
        }
    }

    /// The same of the bins on one side of the surface.
    fn add_side(
        &mut self,
        scope: &'static str,
        (band, first_incidence): (&BrdfTable, usize),
        realisations: Option<Parts>,
        prediction: Option<&Prediction>,
    ) {
        if let Some(pairs) = self.pairs.as_mut().filter(|_| scope == SCOPES[0]) {
            pairs.add(
                band,
                first_incidence,
                realisations,
                prediction.map(|prediction| &prediction.means[..]),
            );
        }
        let (Some(campaign), Some(prediction)) = (&self.campaign, prediction) else { return };
        self.model = prediction.model.name();
        for comparison in compare::compare(band, campaign, realisations, prediction) {
            let same =
                |(of, masking, _): &&mut (&str, String, _)| *of == scope && *masking == comparison.masking;
            match self.compared.iter_mut().find(same) {
                Some((.., incidences)) => incidences.extend(comparison.incidences),
                None => self.compared.push((scope, comparison.masking, comparison.incidences)),
            }
        }
    }

    /// What is to be said of a failure of random heights without shadowing and masking.
    fn own_slopes(&self) -> &'static str {
        let own =
            |campaign: &Campaign| !campaign.trace.visibility && campaign.surface.kind.is_random_heights();
        if self.campaign.as_ref().is_some_and(own) { OWN_SLOPES } else { "" }
    }

    /// What all incidences together show.
    pub fn verdict(self) -> Verdict {
        let own_slopes = self.own_slopes();
        let visibility = self.campaign.as_ref().is_none_or(|campaign| campaign.trace.visibility);
        let comparisons: Vec<Comparison> = self
            .compared
            .into_iter()
            .map(|(scope, masking, incidences)| Comparison {
                scope: scope.into(),
                ..Comparison::new(&self.model, &masking, incidences)
            })
            .collect();
        let first = comparisons.first().map_or("", |c| c.scope.as_str());
        let models: Vec<_> =
            comparisons.iter().filter(|c| c.scope == first).map(|c| (&c.figures, &c.by_part[..])).collect();
        let nearest = compare::nearest(&models);
        let reciprocity = self.pairs.as_ref().and_then(Reciprocity::of_pairs);
        let bar = self.campaign.as_ref().and_then(|campaign| expect::bar(campaign, &self.grid));
        let mut judgements = vec![
            judgement::light(&self.seen),
            judgement::energy(&self.energy),
            judgement::reciprocity(reciprocity.as_ref(), visibility),
        ];
        let [back, through]: [Vec<&Comparison>; 2] =
            SCOPES.map(|scope| comparisons.iter().filter(|c| c.scope == scope).collect());
        if self.grid.looks_above() {
            judgements.push(judgement::model(judgement::MODEL, bar, &back, own_slopes));
        }
        if self.grid.looks_below() {
            let bar = self.campaign.as_ref().and_then(expect::bar_through);
            judgements.push(judgement::model(judgement::TRANSMISSION, bar, &through, own_slopes));
        }
        let failed = judgements.iter().filter(|judgement| judgement.ruling == Ruling::Failed);
        let failures: Vec<String> = failed.map(|j| format!("{}: {}", j.law, j.reason)).collect();
        Verdict {
            ok: failures.is_empty(),
            verdict: words::overall(&judgements),
            judgements,
            failures,
            nearest_masking: nearest.map(|nearest| comparisons[nearest.index].masking.clone()),
            nearest_p: nearest.and_then(|nearest| nearest.p),
            comparisons,
            energy: self.energy,
            reciprocity,
            bar,
            geometric_optics: self
                .campaign
                .as_ref()
                .map(|campaign| GeometricOptics::of(campaign, &self.grid)),
        }
    }
}

/// The sensor above the horizon, where it looks there.
fn above(grid: &Grid) -> Option<Grid> {
    if grid.looks_below() { grid.half(false).map(|half| half.grid) } else { Some(grid.clone()) }
}

/// Squares of the correlation length in a patch of random heights, pits in one of those; `None` where every start meets its
/// own facet, and on grains, whose law is exact.
fn independent_facets(campaign: &Campaign) -> Option<f64> {
    let surface = &campaign.surface;
    if let Some(pits) = surface.kind.explicit_grains().filter(|grains| grains.shape == GrainShape::Pits) {
        let coverage = pits.alphas[0].coverage?;
        return Some(mean_count(pits.side, coverage));
    }
    let along = f64::from(surface.cells) / surface.correlation_cells;
    surface.kind.is_random_heights().then_some(along * along)
}
