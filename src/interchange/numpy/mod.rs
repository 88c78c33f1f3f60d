//! Arrays for NumPy: NPY and NPZ.

pub(crate) mod arrays;
mod members;
pub mod npy;
pub mod npz;
