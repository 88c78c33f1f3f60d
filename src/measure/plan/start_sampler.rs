//! Where paths start: decided here, once for a campaign, before anything is made.

use glam::DVec3;
use serde::{Serialize, Serializer};

use crate::campaign::{Alpha, Campaign, SurfaceKind};
use crate::instrument::{Grid, Region, Sensor};
use crate::sphere;
use crate::surface::grains;

/// Surface samples of an incidence on a patch for each of its cells from which on sorting the facets by slope pays.
const FEWEST_SAMPLES_PER_CELL: f64 = 1.0 / 64.0;
/// Share of the samples on grains that the light sees, below which rays from above are better: where both take the same
/// time for the same error (`cargo bench -p gonio-benches --bench grains`: 1.4 to 0.9 between shares of 0.55 and 0.42).
const FEWEST_SEEN: f64 = 0.45;
/// Apertures that cover more than this fraction of the hemisphere are not worth an index.
const MOST_OF_HEMISPHERE: f64 = 0.25;

/// How the surface samples of a block are chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum StartSampler {
    /// By a law without heights: a path draws its own facets.
    Law,
    /// From grain to grain, normals evenly, or where rays from above first meet them or the plane between.
    Grains {
        /// Which of both it is: \[table of a roughness\]\[incidence\].
        from_above: Vec<Vec<bool>>,
    },
    /// Along all facets, row by row.
    ByPlace,
    /// Along all facets in the order of their slopes.
    BySlope,
    /// On those facets alone that can send light into the apertures.
    IntoApertures(Apertures),
}

/// The apertures of an arm: cones about their axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Apertures {
    /// Unit vectors in the frame of the bins.
    pub axes: Vec<DVec3>,
    /// rad, with a margin for rounding.
    pub half_angle: f64,
}

impl StartSampler {
    /// The sampler for `samples` surface samples of each incidence and patch. `folded` says of each incidence whether
    /// mirrored arrivals count; `apertures_only`, whether nothing but light into apertures does.
    pub(crate) fn decided(
        campaign: &Campaign,
        grid: &Grid,
        folded: &[bool],
        (samples, apertures_only): (u64, bool),
    ) -> Self {
        if matches!(campaign.surface.kind, SurfaceKind::Smith(_)) {
            return StartSampler::Law;
        }
        if campaign.surface.kind.explicit_grains().is_some() {
            let may = campaign.trace.visibility && !apertures_only;
            let of_table = |alpha: Option<Alpha>| {
                let pays = |incidence| {
                    alpha.is_some_and(|alpha| pays_from_above(campaign, alpha, grid.wi(incidence)))
                };
                (0..grid.incidences()).map(|incidence| may && pays(incidence)).collect()
            };
            let from_above = campaign.alphas().into_iter().map(of_table).collect();
            return StartSampler::Grains { from_above };
        }
        if !campaign.surface.kind.is_random_heights() {
            return StartSampler::ByPlace;
        }
        match Apertures::of(grid) {
            Some(apertures) if apertures_only && are_few(grid, folded) => {
                StartSampler::IntoApertures(apertures)
            }
            _ if pays_by_slope(campaign, samples) => StartSampler::BySlope,
            _ => StartSampler::ByPlace,
        }
    }

    /// Whether it needs an index of all facets by slope.
    pub(crate) fn is_indexed(&self) -> bool {
        matches!(self, StartSampler::BySlope | StartSampler::IntoApertures(_))
    }

    /// The same for some of the incidences.
    pub(crate) fn of_incidences(&self, incidences: &[usize]) -> Self {
        let StartSampler::Grains { from_above } = self else { return self.clone() };
        let some = |table: &Vec<bool>| incidences.iter().map(|&incidence| table[incidence]).collect();
        StartSampler::Grains { from_above: from_above.iter().map(some).collect() }
    }

    /// At how many incidences of all tables samples on grains come from above, and how many there are.
    pub(crate) fn count_from_above(&self) -> (usize, usize) {
        let StartSampler::Grains { from_above } = self else { return (0, 0) };
        let all = from_above.iter().flatten();
        (all.clone().filter(|&&above| above).count(), all.count())
    }

    /// Its name in plans.
    pub fn name(&self) -> &'static str {
        match self {
            StartSampler::Law => "law",
            StartSampler::Grains { .. } => match self.count_from_above() {
                (0, _) => "on_grains",
                (some, all) if some == all => "from_above",
                _ => "on_grains_or_from_above",
            },
            StartSampler::ByPlace => "by_place",
            StartSampler::BySlope => "by_slope",
            StartSampler::IntoApertures(_) => "into_apertures",
        }
    }
}

impl Serialize for StartSampler {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Apertures {
    /// Those of an arm; `None` for bins of another shape.
    fn of(grid: &Grid) -> Option<Self> {
        let sensor = Sensor::new(grid);
        let (axes, half_angle) = sensor.cones()?;
        Some(Apertures { axes: axes.collect(), half_angle })
    }
}

/// Whether an index of the facets is worth its making: whether at every incidence the apertures, mirrored ones included,
/// cover little enough of the hemisphere.
///
/// Estimated break-even: see `MOST_OF_HEMISPHERE` (`cargo bench -p gonio-benches --bench index`).
// Tested by `the_facet_index_changes_nothing_but_noise`.
fn are_few(grid: &Grid, folded: &[bool]) -> bool {
    folded.iter().enumerate().all(|(incidence, &folded)| {
        let fraction = aperture_fraction(&grid.regions(incidence));
        fraction * if folded { 2.0 } else { 1.0 } <= MOST_OF_HEMISPHERE
    })
}

/// The fraction of the hemisphere's solid angle that apertures cover, overlaps counted as often as they are covered.
pub(crate) fn aperture_fraction(regions: &[Region]) -> f64 {
    let of = |region: &Region| match region {
        Region::Cap { half_angle, .. } => 2.0 * (0.5 * half_angle).sin().powi(2),
        Region::Rectangle { .. } => 1.0,
    };
    regions.iter().map(of).sum()
}

/// Whether rays from above find the parts of grains that the light sees in less time than samples on all of them, most of
/// which are buried or hidden. A property of one roughness and incidence: further ones leave its bytes as they are.
// Tested by `both_ways_of_starting_on_grains_agree`.
fn pays_from_above(campaign: &Campaign, alpha: Alpha, wi: DVec3) -> bool {
    let w = sphere::turned(wi, sphere::sin_cos_deg(-campaign.surface.rotation_deg));
    let light = DVec3::new(alpha.x * w.x, alpha.y * w.y, w.z);
    grains::share_seen(light, alpha.coverage.unwrap_or(0.0)) < FEWEST_SEEN
}

/// Whether sorting the facets of a patch by slope pays, for so many samples of an incidence on it. A property of the
/// incidence alone: further ones and roughnesses, which share the sort, leave its bytes as they are.
///
/// The sort takes 25 ns a cell. At alpha 0.2, six incidences from 0 to 75 degrees, samples row by row take 5.1 times the
/// 0.39 us of one by slope for the same error (`gonio bench configs/ggx_isotropic.toml --against rays`): 1.6 us are saved
/// for each, which pays for the sort from a 64th of a sample a cell on.
// Tested by `starts_by_slope_change_nothing_but_noise`.
fn pays_by_slope(campaign: &Campaign, samples: u64) -> bool {
    samples as f64 >= FEWEST_SAMPLES_PER_CELL * f64::from(campaign.surface.cells).powi(2)
}
