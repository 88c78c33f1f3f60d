//! The table of another Schlick material from the sums that a table holds: no path is traced again.
//!
//! Input: a table with `SchlickSums`, its realisations where they are there, F0 of the new material. Output: both as
//! they would have been measured with it.

use super::brdf_table::HITS_OF_AN_EMPTY_BIN;
use super::gaps::NOT_KNOWN;
use super::{BrdfTable, ColourChannels, RealisationPart, Realisations, SchlickSums};
use crate::error::Checked;
use crate::optics::parts;

/// The table for another F0 of R, G and B, and its realisations.
///
/// f = F0 unit + (1 - F0) schlick for order 1, sum_m parts_m F0^(N-m) (1-F0)^m for the orders above.
/// Values and errors are means and spreads over the realisations, as `measure` forms them; without realisations (or
/// with some that hold no sums) values follow from the table's own sums and errors are not available (-1), but
/// for empty bins. `campaign` is the new text of the table's campaign.
///
/// - Errors: the reason, where the table holds no sums for the orders that it has.
/// - Numerics: within f32 rounding of the table traced with the material: 1e-6 for order 1, 1e-5 for up to 8 orders.
// Tested by `a_recoloured_table_is_the_traced_one`, `orders_follow_from_their_parts` (tests/it/measure/materials.rs).
pub fn recolour(
    table: &BrdfTable,
    realisations: Option<&Realisations>,
    f0: [f64; 3],
    campaign: String,
) -> Checked<(BrdfTable, Option<Realisations>)> {
    let sums = usable(table)?;
    let parts: Option<Vec<RealisationPart>> =
        realisations.and_then(|all| all.parts.iter().map(|part| recoloured(part, f0)).collect());
    let empty = empty_bin_errors(table, sums);
    let channels = |(colour, f0): (usize, f64)| {
        let channels = match &parts {
            Some(parts) => ColourChannels::of_realisations(parts, colour, &table.hits, &empty),
            None => without_errors(table, sums, f0),
        };
        let by_order = if table.is_by_order() { &sums.further[..] } else { &[] };
        let orders = by_order.iter().map(|group| narrow(entries(table).map(|at| of_group(group, f0, at))));
        ColourChannels { orders: orders.collect(), ..channels }
    };
    let colours = f0.into_iter().enumerate().map(channels).collect();
    let new = BrdfTable { campaign, colours, ..table.clone() };
    let new = match &parts {
        Some(parts) => new.with_albedo_errors(parts),
        None => new,
    };
    Ok((new, parts.map(|parts| Realisations { parts })))
}

/// The sums of a table that hold for all of its orders.
fn usable(table: &BrdfTable) -> Checked<&SchlickSums> {
    let Some(sums) = &table.schlick else {
        return Err(
            "holds no `schlick` sums, which another material follows from: it was measured with F = 1, with \
                    more than 8 orders, or by another program; measure it with [optics] f0 = 1"
                .into(),
        );
    };
    if sums.unit.is_empty() {
        return Err("holds `schlick` but not `unit`: written by an older version; measure it again".into());
    }
    if table.colours.iter().flat_map(|colour| &colour.left_map).any(|&bound| bound > 0.0) {
        return Err(
            "light left the map by its edge, and what that may have added is known for the table's own \
                    material alone; measure it with [optics] materials = [...]"
                .into(),
        );
    }
    let multiple = table.colours.iter().any(|colour| colour.multiple.iter().any(|&value| value > 0.0));
    if multiple && sums.further.is_empty() {
        return Err("holds no sums of its orders above 1, only their values for its own material".into());
    }
    Ok(sums)
}

fn entries(table: &BrdfTable) -> std::ops::Range<usize> {
    0..table.hits.len()
}

fn narrow(values: impl Iterator<Item = f64>) -> Vec<f32> {
    values.map(|value| value as f32).collect()
}

fn of_single(sums: &SchlickSums, f0: f64, at: usize) -> f64 {
    f0 * f64::from(sums.unit[at]) + (1.0 - f0) * f64::from(sums.first[at])
}

fn of_group(group: &[Vec<f32>], f0: f64, at: usize) -> f64 {
    parts::at_f0(group.iter().map(|part| f64::from(part[at])), f0)
}

fn of_total(sums: &SchlickSums, f0: f64, at: usize) -> f64 {
    of_single(sums, f0, at) + sums.further.iter().map(|group| of_group(group, f0, at)).sum::<f64>()
}

fn recoloured(part: &RealisationPart, f0: [f64; 3]) -> Option<RealisationPart> {
    let sums = part.schlick.as_ref().filter(|sums| !sums.unit.is_empty())?;
    let all = |of: fn(&SchlickSums, f64, usize) -> f64| {
        f0.map(|f0| narrow((0..sums.first.len()).map(|at| of(sums, f0, at)))).to_vec()
    };
    Some(RealisationPart { total: all(of_total), single: all(of_single), schlick: part.schlick.clone() })
}

fn without_errors(table: &BrdfTable, sums: &SchlickSums, f0: f64) -> ColourChannels {
    let of = |value: &dyn Fn(usize) -> f64| narrow(entries(table).map(value));
    let old = &table.colours[0];
    let error = |old: &[f32]| {
        let known = old.iter().zip(&table.hits).map(|(&old, &hits)| if hits == 0 { old } else { NOT_KNOWN });
        known.collect::<Vec<f32>>()
    };
    ColourChannels {
        total: of(&|at| of_total(sums, f0, at)),
        single: of(&|at| of_single(sums, f0, at)),
        multiple: of(&|at| of_total(sums, f0, at) - of_single(sums, f0, at)),
        stderr: error(&old.stderr),
        stderr_single: error(&old.stderr_single),
        ..ColourChannels::default()
    }
}

/// The errors of bins without light: as they are where nothing arrived, 1.5 arrivals where all was absorbed. An arrival
/// carries what those of its incidence carry in the mean, as `measure` has it.
fn empty_bin_errors(table: &BrdfTable, sums: &SchlickSums) -> Vec<f32> {
    let bins = table.grid.bins();
    let of_incidence = |incidence: usize| {
        let regions = table.grid.regions(incidence);
        let sizes: Vec<f64> = regions.iter().map(|region| region.projected_solid_angle()).collect();
        let first = incidence * bins;
        let flux: f64 = sizes.iter().zip(first..).map(|(size, at)| size * of_total(sums, 1.0, at)).sum();
        let hits: f64 = table.hits[first..first + bins].iter().map(|&hits| f64::from(hits)).sum();
        let error = move |(size, at): (f64, usize)| match table.hits[at] {
            0 => table.colours[0].stderr[at],
            _ => (HITS_OF_AN_EMPTY_BIN * flux / hits / size) as f32,
        };
        sizes.into_iter().zip(first..).map(error)
    };
    (0..table.grid.incidences()).flat_map(of_incidence).collect()
}
