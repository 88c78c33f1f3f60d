//! The tensor files of Mitsuba and the RGL database.

pub mod rgl;
pub mod tensor_file;
pub(crate) mod warp;
