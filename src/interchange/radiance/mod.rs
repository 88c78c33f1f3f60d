//! The XML of Radiance and WINDOW: Klems matrices and tensor trees.

pub(crate) mod colour;
pub mod klems;
pub(crate) mod patch_means;
pub(crate) mod patchwise;
pub mod sample_side;
pub(crate) mod sides;
pub(crate) mod tensor_cells;
pub(crate) mod tensor_function;
pub(crate) mod tensor_square;
pub mod tensor_tree;
pub mod xml;
pub mod xml_writer;
