//! What the models say of a table: their means over its bins, and what apertures and Schlick's formula do to them.

pub mod aperture;
pub mod bin_mean;
pub mod bin_mean_diffuse;
pub mod bin_mean_through;
mod by_colour;
mod chart;
mod critical;
pub mod formulas;
mod layered;
mod lobes;
pub mod model;
pub mod quadrature;
pub mod schlick_error;
