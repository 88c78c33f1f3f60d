//! TOML to checked data, with every fault of the file: one file for each table of a campaign.

pub(crate) mod angles;
pub(crate) mod arms;
pub(crate) mod artist;
pub(crate) mod bounds;
pub(crate) mod campaign;
pub(crate) mod faults;
pub(crate) mod grains;
pub(crate) mod height_map;
pub(crate) mod index_file;
pub(crate) mod lists;
pub(crate) mod optics;
pub(crate) mod psd;
pub(crate) mod reader;
pub(crate) mod roughness;
mod short_text;
pub(crate) mod surface;
pub(crate) mod uncertainty;
pub(crate) mod warnings;
