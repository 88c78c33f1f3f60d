//! A table as a function of any two directions.
//!
//! Along the sensor's angles `IncidenceValues`, between the incidences `Guided`. Last, the values of every
//! direction of the light are scaled such that their integral is the table's albedo, interpolated as the values are
//! (`Levels`).

use glam::DVec3;

use super::guide::Guide;
use super::guided::Guided;
use super::incidence_values::IncidenceValues;
use super::levels::Levels;
use super::lobe::Facets;
use crate::instrument::GridKind;
use crate::interchange::content::light::index_of;
use crate::interchange::{Brdf, Checked, Colour};
use crate::sphere;
use crate::table::BrdfTable;

/// The interpolant.
pub struct Lookup {
    guided: Guided,
    /// None where the bins have no sizes.
    levels: Option<Levels>,
}

impl Lookup {
    /// The interpolant of the totals of a table whose incidences and bins are products of polar angles and azimuths
    /// that go all the way round, or do with the mirror images that the law of the campaign's surface has.
    pub fn new(table: &BrdfTable) -> Checked<Self> {
        Self::of(table, Facets::Mirror)
    }

    /// The same of one side of a table: where light has gone `through` (as a mirror in the horizon shows it) and the table's
    /// index is known, its facets refract.
    // Tested by `light_through_follows_refraction_between_incidences` (tests/it/interchange/between_through.rs).
    pub fn of_side(half: &BrdfTable, through: bool) -> Checked<Self> {
        let eta = if through { index_of(half) } else { None };
        Self::of(half, eta.map_or(Facets::Mirror, |eta| Facets::Refract { eta }))
    }

    fn of(table: &BrdfTable, facets: Facets) -> Checked<Self> {
        let values = IncidenceValues::new(table)?;
        let guided = Guided::new(values, facets);
        // Single directions do not say how much light goes elsewhere.
        let sized = matches!(table.grid.kind, GridKind::Hemisphere | GridKind::Patches);
        let levels = sized.then(|| Levels::of(&guided));
        Ok(Lookup { guided, levels })
    }

    /// Polar angles of the light, increasing, rad.
    pub fn theta_i(&self) -> &[f64] {
        self.guided.values.theta_i()
    }

    /// Azimuths of the light, increasing in [0, 2 pi), rad; a single 0 where every azimuth is alike.
    pub fn phi_i(&self) -> &[f64] {
        self.guided.values.phi_i()
    }

    /// The last polar angle of the light, degrees.
    pub fn last_theta_i_deg(&self) -> f64 {
        self.theta_i().last().map_or(0.0, |last| last.to_degrees())
    }

    /// Whether every azimuth of the light is alike.
    pub fn is_isotropic(&self) -> bool {
        self.guided.values.is_isotropic()
    }

    /// The values at the table's own incidences.
    pub(crate) fn values(&self) -> &IncidenceValues {
        &self.guided.values
    }

    pub(crate) fn guide(&self) -> &Guide {
        &self.guided.guide
    }
}

impl Brdf for Lookup {
    fn colours(&self) -> usize {
        self.values().colours()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let (theta, phi) = (sphere::theta(wi), sphere::phi(wi));
        let value = self.guided.brdf(wi, (theta, phi), wo);
        let scales = self.levels.as_ref().map(|levels| levels.at(theta, phi));
        scales.map_or(value, |scales| std::array::from_fn(|c| value[c] * scales[c]))
    }
}
