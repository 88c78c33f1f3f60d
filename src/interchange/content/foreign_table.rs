//! Tables of values that this program did not measure: no error bars, no orders, no campaign.

use crate::error::{Checked, wrong};
use crate::instrument::Grid;
use crate::table::{BrdfTable, ColourChannels};

/// Weights of linear R, G, B in the luminance (ITU-R BT.709).
pub(crate) const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// A table of foreign values; `total[colour]` is row-major.
///
/// Order 1 is taken to be all there is; every value counts as one arrival, as 0 would mean "not seen".
/// Negative and non-finite values are refused with their place.
// Tested by `nan_and_negative_values_are_refused`.
pub fn foreign_table(grid: Grid, total: Vec<Vec<f32>>) -> Checked<BrdfTable> {
    spectral_table(grid, total, &[])
}

/// The same with a wavelength for each colour, where there are any.
pub fn spectral_table(grid: Grid, total: Vec<Vec<f32>>, wavelengths_nm: &[f64]) -> Checked<BrdfTable> {
    let (incidences, bins) = (grid.incidences(), grid.bins());
    let pixels = incidences.checked_mul(bins).ok_or("more values than a table can hold")?;
    let are_distinguished = if wavelengths_nm.is_empty() {
        matches!(total.len(), 1 | 3)
    } else {
        wavelengths_nm.len() == total.len()
    };
    if !are_distinguished || total.iter().any(|values| values.len() != pixels) || pixels == 0 {
        return Err(wrong!("{} colours do not make {incidences} incidences of {bins} bins", total.len()));
    }
    for values in &total {
        if let Some(at) = values.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
            let (incidence, bin, value) = (at / bins, at % bins, values[at]);
            let what =
                format!("incidence {incidence}, bin {bin}: {value} is no BRDF value (finite, not negative)");
            return Err(what.into());
        }
    }
    let colours = total.into_iter().enumerate().map(|(k, total)| ColourChannels {
        wavelength_nm: wavelengths_nm.get(k).copied(),
        single: total.clone(),
        multiple: vec![0.0; pixels],
        stderr: vec![-1.0; pixels],
        stderr_single: vec![-1.0; pixels],
        total,
        ..ColourChannels::default()
    });
    Ok(BrdfTable {
        grid,
        campaign: String::new(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: 0,
        patch_digest: String::new(),
        colours: colours.collect(),
        hits: vec![1; pixels],
        schlick: None,
    })
}

/// The luminance of a table, for formats of one channel: totals only, and the campaign, which says what is symmetric.
pub fn luminance(table: &BrdfTable) -> Checked<BrdfTable> {
    let total = match &table.colours[..] {
        [r, g, b] => {
            let weighted =
                |k: usize| LUMINANCE[0] * r.total[k] + LUMINANCE[1] * g.total[k] + LUMINANCE[2] * b.total[k];
            (0..r.total.len()).map(weighted).collect()
        }
        colours => colours[0].total.clone(),
    };
    let mut luminance = foreign_table(table.grid.clone(), vec![total])?;
    (0..table.hits.len()).filter(|&entry| table.is_gap(entry)).for_each(|gap| luminance.set_gap(gap));
    Ok(BrdfTable { campaign: table.campaign.clone(), ..luminance })
}
