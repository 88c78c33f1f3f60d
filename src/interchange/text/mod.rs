//! Lists of directions and values as text: CSV, ASTM, SSDD, pab-opto, Zemax, OpenMATERIAL, BiRD, FRED,
//! Speos.

pub mod astm;
mod azimuths;
pub mod bird;
pub mod csv;
pub mod fred;
mod identity;
pub mod named_columns;
pub mod openmaterial;
pub mod pabopto;
pub mod samples;
pub(crate) mod seam;
mod spectral_rows;
pub mod speos;
pub mod ssdd;
pub mod zemax;
