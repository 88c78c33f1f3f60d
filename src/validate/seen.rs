//! Whether light arrived at all, and how much of it went where nothing is known of it.

use super::laws;
use crate::table::BrdfTable;
use crate::table::brdf_table::flux;

/// What a table says of the light itself.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SeenLight {
    /// Whether the table says how it was measured: an imported one does not.
    pub measured: bool,
    /// Incidences so far.
    pub incidences: usize,
    /// Those without a value above 0 in any bin and colour.
    pub dark: usize,
    /// What may be missing of the light at the incidence that lacks most compared with its noise, as a share of the incident flux.
    pub lost_light: f64,
    /// The standard error of that incidence's albedo without it, or a thousandth of the incident flux if that is more.
    pub lost_limit: f64,
}

/// Lost light below this share of the incident flux is never the larger error.
const NEGLIGIBLE: f64 = 1e-3;

impl SeenLight {
    /// Takes further incidences in.
    pub fn add(&mut self, band: &BrdfTable) {
        self.measured |= laws::is_measured(band);
        let bins = band.grid.bins();
        for incidence in 0..band.grid.incidences() {
            let here = incidence * bins..(incidence + 1) * bins;
            let lit = band.colours.iter().any(|colour| colour.total[here.clone()].iter().any(|&f| f > 0.0));
            self.incidences += 1;
            self.dark += usize::from(!lit);
            // Bounds are those of an open map: no other table needs the sizes of its bins here.
            if band.colours.iter().all(|colour| colour.left_map.is_empty()) {
                continue;
            }
            let sizes = band.grid.sizes(incidence);
            for colour in &band.colours {
                let lost = flux(&colour.left_map[here.clone()], &sizes);
                let se = colour.albedo_se.get(incidence).map_or(0.0, |&se| f64::from(se));
                let limit = se.max(NEGLIGIBLE);
                if lost - limit > self.lost_light - self.lost_limit || self.lost_limit == 0.0 {
                    (self.lost_light, self.lost_limit) = (lost, limit);
                }
            }
        }
    }
}
