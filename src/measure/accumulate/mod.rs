//! Sums of paths, and tables out of them.

mod albedos;
pub mod assemble;
pub mod fresnel_sums;
pub mod lost_light;
pub mod slopes;
pub(crate) mod table_source;
pub mod tally;
pub mod tally_flux;
