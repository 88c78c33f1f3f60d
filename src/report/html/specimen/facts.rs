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
    /// Its corner at the smallest x and y, as large as any picture.
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
            corner: corner(field),
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

/// The corner that pictures show, open: a periodic patch may be smaller.
fn corner(field: &Heightfield) -> Heightfield {
    let [columns, rows] = [field.cells_x(), field.cells_y()].map(|cells| cells.min(MOST_CELLS));
    let height = |x: usize, y: usize| {
        let corners = field.corners(x.min(columns - 1), y.min(rows - 1));
        match (x == columns, y == rows) {
            (false, false) => corners.h00,
            (true, false) => corners.h10,
            (false, true) => corners.h01,
            (true, true) => corners.h11,
        }
    };
    let heights = (0..=rows).flat_map(|y| (0..=columns).map(move |x| height(x, y))).collect();
    Heightfield::new(columns, rows, false, heights)
}

/// Share of all facets by slope length; longer ones are in no bin. `alpha`: slope of one unit of height a cell.
fn histogram(field: &Heightfield, alpha: DVec2, longest: f64) -> Vec<f64> {
    let mut counts = vec![0u64; SLOPE_BINS];
    for y in 0..field.cells_y() {
        for x in 0..field.cells_x() {
            let corners = field.corners(x, y);
            for slope in [corners.lower_slope(), corners.upper_slope()] {
                if let Some(count) =
                    counts.get_mut(((slope * alpha).length() / longest * SLOPE_BINS as f64) as usize)
                {
                    *count += 1;
                }
            }
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

    #[test]
    fn the_corner_of_a_small_patch_is_all_of_it() {
        let field = Heightfield::new(5, 3, true, (0..15).map(|i| f64::from(i * i % 7)).collect());
        let corner = corner(&field);
        assert_eq!((corner.cells_x(), corner.cells_y()), (5, 3));
        for (x, y) in (0..3).flat_map(|y| (0..5).map(move |x| (x, y))) {
            assert_eq!(corner.corners(x, y), field.corners(x, y));
        }
    }
}
