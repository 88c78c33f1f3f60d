//! gonio: a virtual gonioreflectometer.
//!
//! A lamp arm and a sensor arm sweep over an explicit random microsurface, light is traced over its facets, and
//! the flux into each sensor bin becomes a BRDF table with error bars.
//!
//! ```text
//! campaign -> surface -> instrument -> trace -> measure -> table -> validate -> cli
//!  (TOML)    (heights)   (arms, bins)  (walk)   (tallies)  (EXR)   (against theory)
//!                                                            |
//!                                                       interchange (other programs' formats)
//! ```
//!
//! Frame: macro-normal +z, x the tangent (the axis of `alpha_x`), right-handed. All directions are unit vectors
//! that point away from the surface: `wi` to the light, `wo` to the sensor (the arm whose angles are `theta_r`,
//! `phi_r`). Angles are radians unless a name ends in `_deg`. BRDF values are 1/sr without cosine.
//!
//! The measuring side (`surface`, `instrument`, `optics`, `trace`, `measure`, `table`) never imports `theory`;
//! the two meet in `validate`, `fit` and `study`. A test keeps it so.

// What every stage may use.
pub mod error;
pub mod files;
pub mod rng;
pub mod sphere;
pub mod stats;
pub mod text_decoding;

// The stages, in the order of the data. Each imports only earlier ones.
pub mod campaign;

pub mod surface;

pub mod instrument;

pub mod optics;

pub mod trace;

pub mod table;

pub mod interchange;

pub mod measure;

pub mod theory;

pub mod validate;

pub mod fit;

pub mod study;

pub mod report;

pub mod bench;

pub mod job;

pub mod cli;
