//! One table on the grid of another by interpolation.

use std::borrow::Cow;

use super::totals::Totals;
use crate::error::Checked;
use crate::instrument::{Grid, GridKind};
use crate::interchange::content::imported::function_of;
use crate::interchange::resample::{resample_spectrum, thirds};
use crate::stats;
use crate::table::gaps::NOT_KNOWN;
use crate::table::{BrdfTable, RealisationPart, Realisations};

/// Which of two tables is interpolated, 0 or 1, and which where that one cannot be: bins that cover a side rather than single
/// directions, and of two such the one with more bins, which are averaged over the other's.
pub fn order(grids: [&Grid; 2]) -> Checked<Vec<usize>> {
    let covers = grids.map(|grid| matches!(grid.kind, GridKind::Hemisphere | GridKind::Patches));
    match covers {
        [true, false] => Ok(vec![0]),
        [false, true] => Ok(vec![1]),
        [false, false] => Err("no direction in common, and single directions are not interpolated".into()),
        [true, true] if grids[1].bins() > grids[0].bins() => Ok(vec![1, 0]),
        [true, true] => Ok(vec![0, 1]),
    }
}

/// A table's means over the bins of a grid, by the interpolant that keeps its own means. Errors are those of its realisations,
/// each interpolated by itself; without realisations there are none.
pub fn on(side: &Totals<'_>, grid: &Grid) -> Checked<Totals<'static>> {
    let table = &side.table;
    let mut found = totals(table, grid)?;
    let parts = side.parts.as_ref().filter(|parts| parts.parts.len() > 1);
    let parts = parts.map(|parts| -> Checked<Realisations> {
        let part = |part: &RealisationPart| {
            let total = of_part(table, part, grid)?;
            Ok(RealisationPart { total, ..RealisationPart::default() })
        };
        Ok(Realisations { parts: parts.parts.iter().map(part).collect::<Checked<_>>()? })
    });
    let parts = parts.transpose()?;
    for (k, colour) in found.colours.iter_mut().enumerate() {
        let Some(parts) = &parts else { break };
        let error = |at: usize| {
            let values = parts.parts.iter().map(|part| f64::from(part.total[k][at]));
            stats::mean_and_se(values).1.map_or(NOT_KNOWN, |se| se as f32)
        };
        colour.stderr = (0..colour.total.len()).map(error).collect();
    }
    let (campaign, patch_digest) = (table.campaign.clone(), table.patch_digest.clone());
    let found = BrdfTable { campaign, patch_digest, seed: table.seed, ..found };
    Ok(Totals { table: Cow::Owned(found), parts: parts.map(Cow::Owned), errors_are_bounds: false })
}

fn totals(table: &BrdfTable, grid: &Grid) -> Checked<BrdfTable> {
    let parts = thirds(table).into_iter().map(function_of).collect::<Checked<Vec<_>>>()?;
    resample_spectrum(parts.iter().map(|part| part.as_ref()), &table.wavelengths_nm(), grid)
}

fn of_part(table: &BrdfTable, part: &RealisationPart, grid: &Grid) -> Checked<Vec<Vec<f32>>> {
    let mut one = table.clone();
    one.colours.iter_mut().zip(&part.total).for_each(|(colour, total)| colour.total.clone_from(total));
    Ok(totals(&one, grid)?.colours.into_iter().map(|colour| colour.total).collect())
}
