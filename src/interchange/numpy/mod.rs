//! Arrays for NumPy: NPY and NPZ.

pub mod npy;
pub mod npz;
