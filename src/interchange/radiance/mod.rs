//! The XML of Radiance and WINDOW: Klems matrices and tensor trees.

pub(crate) mod colour;
pub mod klems;
pub(crate) mod tensor_cells;
pub(crate) mod tensor_function;
pub mod tensor_tree;
pub mod xml;
