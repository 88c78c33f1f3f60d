//! Tables that other people's programs open, and theirs read: one file a format.
//!
//! Enters: a [`BrdfTable`] or the bytes of a foreign file. Leaves: the other. A format whose directions are not the
//! table's is written through [`Lookup`], an interpolant that keeps the table's bin means; a foreign file whose
//! directions are no list of stops and bins is a [`Brdf`] and is averaged over bins by [`resample()`].

pub mod albedo;
mod by_rows;
pub mod export;
pub mod exr_parts;
pub mod format;
pub mod half_difference;
pub mod import;
pub mod maps;
pub mod merl;
pub mod mitsuba;
mod needed;
pub mod numpy;
pub mod radiance;
pub mod read_back;
pub mod resample;
pub mod text;
pub mod utia;

pub use albedo::AlbedoCurve;
pub use by_rows::export_rows;
pub use export::{Export, Exported, export};
pub use format::{Format, Options};
pub use import::{Imported, decode, import};
pub use read_back::{ReadBack, read_back};
pub use resample::lookup::Lookup;
pub use resample::resample;

use std::io;

use glam::DVec3;

use crate::instrument::Grid;
use crate::table::{BrdfTable, ColourChannels};

/// Weights of linear R, G, B in the luminance (ITU-R BT.709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// The luminance of a table, for formats of one channel: totals only, and the campaign, which says what is symmetric.
pub fn luminance(table: &BrdfTable) -> Reason<BrdfTable> {
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

/// Values of one pair of directions by colour; a table of one colour uses the first.
pub type Colour = [f64; 3];

/// A BRDF that answers for any pair of directions.
pub trait Brdf: Sync {
    /// 1 or 3.
    fn colours(&self) -> usize;

    /// f(wi, wo) in 1/sr without cosine, unit vectors above the horizon of the stage's frame.
    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour;
}

/// A reason, to be completed with the file's path.
pub type Reason<T> = Result<T, String>;

/// Why a format was not written.
#[derive(Debug)]
pub enum Fail {
    /// The format cannot hold the table.
    Refused(String),
    /// The system said no.
    Io(io::Error),
}

impl From<io::Error> for Fail {
    fn from(error: io::Error) -> Self {
        Fail::Io(error)
    }
}

impl From<String> for Fail {
    fn from(reason: String) -> Self {
        Fail::Refused(reason)
    }
}

/// Why a table with gaps is not what was asked for.
fn not_measured(table: &BrdfTable) -> String {
    format!(
        "{} of {} pairs of directions were not measured; npz, csv, astm, exr_parts and pabopto keep such gaps, import \
         --like TABLE.exr fills them in",
        table.gaps(),
        table.grid.stops() * table.grid.bins()
    )
}

/// A table of foreign values: no error bars, no orders, no campaign. `total[colour]` is row-major.
///
/// Order 1 is taken to be all there is; every value counts as one arrival, as 0 would mean "not seen".
/// Negative and non-finite values are refused with their place. Held by: `nan_and_negative_values_are_refused`.
pub fn foreign_table(grid: Grid, total: Vec<Vec<f32>>) -> Reason<BrdfTable> {
    spectral_table(grid, total, &[])
}

/// The same with a wavelength for each colour, where there are any.
pub fn spectral_table(grid: Grid, total: Vec<Vec<f32>>, wavelengths_nm: &[f64]) -> Reason<BrdfTable> {
    let (stops, bins) = (grid.stops(), grid.bins());
    let pixels = stops.checked_mul(bins).ok_or("more values than a table can hold")?;
    let told_apart = if wavelengths_nm.is_empty() {
        matches!(total.len(), 1 | 3)
    } else {
        wavelengths_nm.len() == total.len()
    };
    if !told_apart || total.iter().any(|values| values.len() != pixels) || pixels == 0 {
        return Err(format!("{} colours do not make {stops} stops of {bins} bins", total.len()));
    }
    for values in &total {
        if let Some(at) = values.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
            let (stop, bin) = (at / bins, at % bins);
            return Err(format!(
                "stop {stop}, bin {bin}: {} is no BRDF value (finite, not negative)",
                values[at]
            ));
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
