//! Tables that other people's programs open, and theirs read: one file a format.
//!
//! Input: a [`BrdfTable`](crate::table::BrdfTable) or the bytes of a foreign file. Output: the other. A format is a
//! [`codec::Codec`], listed in [`format`](Format). One whose directions are not the table's is written through
//! [`Lookup`], an interpolant that keeps the table's bin means; a foreign file whose directions are no list of
//! incidences and bins is a [`Brdf`] and is averaged over bins by [`resample()`].

pub mod albedo;
pub mod codec;
pub mod content;
pub mod export;
pub mod exr_parts;
pub mod format;
pub mod import;
pub mod maps;
pub mod merl;
pub mod mitsuba;
mod needed;
pub mod numpy;
mod options;
pub mod radiance;
pub mod read_back;
pub mod resample;
pub mod text;
pub mod utia;

pub use crate::error::Checked;
pub use albedo::AlbedoCurve;
pub use content::bands::Bands;
pub use content::brdf::{Brdf, COMES_BACK, Colour, GONE_THROUGH, TwoSided, in_mirror};
pub use content::foreign_table::{foreign_table, luminance, spectral_table};
pub use content::imported::Imported;
pub use export::{Export, export, export_rows, export_to};
pub use format::Format;
pub use import::{decode, import};
pub use options::{Options, Sampling};
pub use read_back::{ReadBack, read_back};
pub use resample::lookup::Lookup;
pub use resample::resample;
