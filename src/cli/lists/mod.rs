//! `gonio materials`, `presets`, `formats`: what names there are, and what each means.

pub mod formats;
pub mod materials;
pub mod presets;
