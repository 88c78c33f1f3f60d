//! Where paths start: points on the facets, in proportion to the area that the light sees.

pub mod areas;
pub mod cones;
pub mod slope_index;
pub mod slope_order;
pub(crate) mod systematic_steps;
