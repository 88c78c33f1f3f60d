//! What pages show of a patch whatever the roughness of their table: small, and found while the patch is there.

use glam::DVec2;

use super::quantiles::{self, SlopeQuantiles};
use crate::campaign::{Campaign, SurfaceKind};
use crate::measure::{Patch, Patches};
use crate::surface::{Certificate, Heightfield, SlopeLaw};

/// Cells along the longer side of a picture at most.
pub(super) const MOST_CELLS: usize = 224;
/// Bins of the slope histogram, and their end in median slopes.
pub(super) const SLOPE_BINS: usize = 40;
const LONGEST: f64 = 4.0;

/// A patch without its heights, but those of a corner.
#[derive(Debug, Clone)]
pub struct PatchFacts {
    /// What the patch really has.
    pub certificate: Certificate,
    /// Whether slopes are ratios of lengths, as those of a measured map are, and heights in the map's unit.
    pub of_map: bool,
    /// Its cells at the smallest x and y, as many as any picture shows.
    pub(super) corner: Heightfield,
    /// World slope per canonical slope where the surface itself says so.
    pub(super) own_alpha: Option<DVec2>,
    /// What its slopes should follow.
    pub(super) law: Option<SlopeLaw>,
    /// Median slope length, without the plane of grains.
    pub(super) median: f64,
    /// Share of the facets in each of [`SLOPE_BINS`] bins up to the longest slope that is shown.
    pub(super) histogram: Vec<f64>,
    pub(super) longest: f64,
    pub(super) quantiles: Vec<SlopeQuantiles>,
}

impl PatchFacts {
    /// Of a patch of a campaign.
    pub fn of(patch: &Patch, campaign: &Campaign) -> Self {
        let Patch { field, own_alpha, .. } = patch;
        let grains = campaign.surface.kind.explicit_grains().and_then(|grains| grains.alphas[0].coverage);
        let law = grains.map(|coverage| SlopeLaw::Grains { coverage }).or_else(|| Patches::law(campaign));
        let of_map = matches!(campaign.surface.kind, SurfaceKind::File(_));
        // Slopes as they are shown.
        let shown = own_alpha.filter(|_| of_map).unwrap_or(DVec2::ONE);
        let certificate = match law {
            None if of_map => Certificate::of_map(field, shown),
            law => Certificate::of(field, law),
        };
        // Of grains, the median without the plane is that of half-spheres.
        let median = if grains.is_some() { 1.0 } else { certificate.median_slope };
        let longest = LONGEST * if median > 0.0 { median } else { 1.0 };
        PatchFacts {
            of_map,
            corner: field.crop(MOST_CELLS),
            own_alpha: *own_alpha,
            law,
            median,
            histogram: histogram(field, shown, longest),
            longest,
            quantiles: law.map_or(Vec::new(), |law| quantiles::of(field, law)),
            certificate,
        }
    }
}

/// Share of all facets by slope length; longer ones are in no bin. `alpha`: slope of one unit of height a cell.
fn histogram(field: &Heightfield, alpha: DVec2, longest: f64) -> Vec<f64> {
    let mut counts = vec![0u64; SLOPE_BINS];
    for slope in field.all_corners().flat_map(|corners| corners.slopes()) {
        let bin = ((slope * alpha).length() / longest * SLOPE_BINS as f64) as usize;
        if let Some(count) = counts.get_mut(bin) {
            *count += 1;
        }
    }
    let facets = 2.0 * (field.cells_x() * field.cells_y()) as f64;
    counts.into_iter().map(|count| count as f64 / facets).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ridges along y of slope +-1: every facet has slope length 1.
    #[test]
    fn the_histogram_counts_every_facet_once() {
        let field = Heightfield::new(8, 8, true, (0..64).map(|i| f64::from(i % 2)).collect());
        let shares = histogram(&field, DVec2::ONE, 4.0);
        // Slope 1 is the lower edge of bin 10 of 40 up to 4.
        assert_eq!((shares[10], shares.iter().sum::<f64>()), (1.0, 1.0));
    }
}
