//! Arrays of a scene: `.npy`, f32, row by row.

use std::fs;
use std::path::Path;

use npyz::{NpyFile, Order};

/// Reads the f32 array of `path`; each side that `shape` names must be as it says.
pub fn read(path: &Path, shape: &[Option<usize>]) -> Result<Vec<f32>, String> {
    let at = |what: String| format!("{}: {what}", path.display());
    let bytes = fs::read(path).map_err(|why| at(why.to_string()))?;
    let npy = NpyFile::new(&*bytes).map_err(|why| at(why.to_string()))?;
    let found = npy.shape().to_vec();
    let fits = found.len() == shape.len()
        && found.iter().zip(shape).all(|(&side, wanted)| wanted.is_none_or(|wanted| wanted as u64 == side));
    if !fits || npy.order() != Order::C {
        return Err(at(format!("an array of {found:?}; {shape:?}, row by row, is needed")));
    }
    let values = npy.data::<f32>().map_err(|why| at(why.to_string()))?;
    values.collect::<Result<_, _>>().map_err(|why| at(why.to_string()))
}
