//! What files hold: tables of incidences and bins, of half and difference angles, or functions of two directions.

pub(crate) mod bands;
pub(crate) mod brdf;
pub mod foreign_table;
pub mod half_difference;
pub(crate) mod imported;
pub(crate) mod light;
pub(crate) mod sides;
