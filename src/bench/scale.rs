//! Cost against size: the same incidences on patches of several sizes, one start for each cell.
//!
//! Input: a campaign of one roughness on a random surface, and sides in cells. Output: for each side and incidence, and for
//! all incidences together, processor time for each start; for each side the bytes for each cell that tracing and the making
//! of a patch take. Cost that grows with the facets and with the incidences, and no faster, shows as equal times in all rows.

use glam::DVec3;
use serde::Serialize;

use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::{self, CELLS_PER_START, Patches, cost};
use crate::surface::Heightfield;
use crate::trace::{
    AreaSampler, BLOCK, BatchedStarts, GridTraversal, Kernel, MaxPyramid, SimdTraversal, SlopeIndex, Window,
};

/// One incidence, or all of them, on a patch of one size.
#[derive(Debug, Clone, Serialize)]
pub struct ScaleRow {
    /// Cells a side.
    pub cells: u32,
    /// Incidences measured, by their polar angles.
    pub theta_i_deg: Vec<f64>,
    /// Starts of all of them.
    pub starts: u64,
    /// Processor seconds.
    pub cpu_s: f64,
}

impl ScaleRow {
    /// Processor nanoseconds for each start.
    pub fn nanoseconds(&self) -> f64 {
        1e9 * self.cpu_s / self.starts as f64
    }
}

/// A patch of one size.
#[derive(Debug, Clone, Serialize)]
pub struct ScalePatch {
    /// Cells a side.
    pub cells: u32,
    /// Processor seconds of its making.
    pub synthesis_cpu_s: f64,
    /// Bytes for each cell: heights, and what tracing lays out of them.
    pub tracing_bytes: f64,
    /// Bytes for each cell while it is made: what the process grew by, at its peak. It holds the plans and filters of
    /// the size as well; null where the system does not tell.
    pub synthesis_bytes: Option<f64>,
}

/// The rows of a campaign.
#[derive(Debug, Clone, Serialize)]
pub struct Scale {
    /// Each size.
    pub patches: Vec<ScalePatch>,
    /// Each incidence of each size, then all of them.
    pub rows: Vec<ScaleRow>,
}

/// Measures every incidence of `campaign` by itself and all together on one patch of each of `sides` cells, in ascending
/// order. Errors: `Usage` for a surface that is not random heights; those of planning and measuring.
// Tested by `tests/it/bench.rs`.
pub fn scale(campaign: &Campaign, sides: &[u32], progress: &(dyn Fn(u64) + Sync)) -> Result<Scale> {
    if !campaign.surface.kind.is_random_heights() {
        let why = "--cells is for random surfaces (ggx, beckmann)";
        return Err(Error::Usage(format!("{}: {why}", campaign.name)));
    }
    let mut scale = Scale { patches: Vec::new(), rows: Vec::new() };
    for &cells in sides {
        let mut campaign = campaign.clone();
        (campaign.surface.cells, campaign.surface.realisations) = (cells, 1);
        campaign.stop.samples = starts(cells);
        let (patch, patches) = made(&campaign)?;
        scale.patches.push(patch);
        let thetas = campaign.light.theta_i_deg.clone();
        let alone = thetas.iter().map(|&theta| vec![theta]);
        let together = (thetas.len() > 1).then(|| thetas.clone());
        for theta_i_deg in alone.chain(together) {
            campaign.light.theta_i_deg.clone_from(&theta_i_deg);
            let plan = measure::plan(&campaign)?;
            let (_, cost) = measure::measure(&campaign, &plan, &patches, progress)?;
            scale.rows.push(ScaleRow { cells, theta_i_deg, starts: cost.samples, cpu_s: cost.tracing_cpu_s });
        }
    }
    Ok(scale)
}

/// Starts of one incidence on a patch: one for each cell, in whole blocks.
pub fn starts(cells: u32) -> u64 {
    u64::from(cells).pow(2).next_multiple_of(BLOCK)
}

/// Makes the patch, and looks at what that takes.
fn made(campaign: &Campaign) -> Result<(ScalePatch, Patches)> {
    cost::reset_peak();
    let (before, cpu) = (cost::resident_bytes(), cost::cpu_seconds());
    let patches = Patches::held(campaign)?;
    let synthesis_cpu_s = cost::cpu_seconds() - cpu;
    let count = f64::from(campaign.surface.cells).powi(2);
    let grown = cost::peak_bytes().checked_sub(before).filter(|&grown| grown > 0);
    let tracing_bytes = match &patches {
        Patches::Held(fields) => fields.first().map_or(0.0, |field| tracing_bytes(field) as f64 / count),
        _ => 0.0,
    };
    let patch = ScalePatch {
        cells: campaign.surface.cells,
        synthesis_cpu_s,
        tracing_bytes,
        synthesis_bytes: grown.map(|grown| grown as f64 / count),
    };
    Ok((patch, patches))
}

/// Bytes that the tracing of `field` may hold at most: its heights, the lanes' copy of them, and the larger of what only
/// one sampler needs (the sums along the facets; the index by slope with the samples that are followed together).
// Tested by `tracing_takes_at_most_40_bytes_for_each_cell`.
pub fn tracing_bytes(field: &Heightfield) -> usize {
    let in_lanes =
        |lanes: MaxPyramid| SimdTraversal::new(GridTraversal::new(field), &lanes, Kernel::Scalar).bytes();
    let lanes = MaxPyramid::new(field).map_or(0, in_lanes);
    let light = DVec3::new(0.1, 0.0, 1.0);
    let starts = AreaSampler::new(field, Window::all(field), light).bytes();
    let together = field.cells_x() * field.cells_y() / CELLS_PER_START as usize * BatchedStarts::BYTES;
    let index = SlopeIndex::new(field).map_or(0, |index| index.bytes() + together);
    size_of_val(field.heights()) + lanes + starts.max(index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tracing_takes_at_most_40_bytes_for_each_cell() {
        let side = 512;
        let height = |k: usize| f64::from((0.37 * k as f32).sin());
        let field = Heightfield::new(side, side, true, (0..side * side).map(height).collect());
        let bytes = tracing_bytes(&field) as f64 / (side * side) as f64;
        // Heights 8, lanes 4 + 8, index 8 (and its 65,537 firsts and sums), starts 4.
        assert!((32.0..=40.0).contains(&bytes), "{bytes}");
    }
}
