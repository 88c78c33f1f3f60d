//! The tensor files of Mitsuba and the RGL database.

mod direction_map;
mod read;
pub mod rgl;
pub mod tensor_file;
pub(crate) mod warp;
mod write;
