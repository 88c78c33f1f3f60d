//! Surface samples, where paths begin: points on the facets, in proportion to their projected area.

pub mod areas;
pub mod batched_starts;
pub mod cones;
pub(crate) mod half_sphere;
pub mod slope_index;
pub mod slope_order;
pub(crate) mod systematic_steps;
