//! gonio: a virtual gonioreflectometer.
//!
//! A lamp arm and a sensor arm sweep over an explicit random microsurface, light is traced over its facets, and
//! the flux into each sensor bin becomes a BRDF table with error bars. The way of the data:
//!
//! ```text
//! campaign      TOML text -> a checked Campaign, or all its faults
//!    |
//! surface       Campaign -> heights, synthesised or measured
//! instrument    Campaign -> incidences and sensor bins
//! optics        material -> what a facet reflects
//!    |
//! trace         heights, an incidence -> paths from facet to facet and out
//!    |
//! measure       paths -> tallies, block by block; plan, checkpoints, shards
//!    |
//! table         tallies -> BRDF with error bars, in an EXR file
//!    |
//!    +-- interchange             other programs' formats, written and read
//!    +-- render                  a sphere of the material in a sky
//!    +-- appearance              gloss, haze, scatter, colour
//!    +-- report, cli             for people
//!    +-- validate, fit, study    <-- theory (D, Lambda, G: formulas alone)
//!    +-- bench                   run time against error
//!    +-- albedo                  tables of albedos, by formula and measured
//!    +-- budget                  uncertainty of single values, JCGM 100 and 101
//! ```
//!
//! Frame: macro-normal +z, x the tangent (the axis of `alpha_x`), right-handed. All directions are unit vectors
//! that point away from the surface: `wi` to the light, `wo` to the sensor (the arm whose angles are `theta_r`,
//! `phi_r`). Angles are radians unless a name ends in `_deg`. BRDF values are 1/sr without cosine.
//!
//! The measuring side (`surface`, `instrument`, `optics`, `trace`, `measure`, `table`) never imports `theory`;
//! the two meet in `validate`, `fit`, `study` and `albedo`. A test keeps it so.

// What all modules may use.
pub mod error;
pub mod files;
pub mod lanes;
pub mod psd;
pub mod rng;
pub mod sphere;
pub mod stats;
pub mod text_decoding;

// In the order of the data; each imports only earlier ones.
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

pub mod albedo;

pub mod render;

pub mod appearance;

pub mod budget;

pub mod report;

pub mod bench;

pub mod job;

pub mod cli;
