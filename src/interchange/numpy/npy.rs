//! NPY: the totals alone, `[theta_i, phi_i, theta_r, phi_r(, colour)]` as `brdf` of the NPZ. Written only: an array
//! without axes is no table.

use std::io::Write;

use super::npz;
use crate::files::npy;
use crate::files::npy::NpyValues;
use crate::interchange::{Fail, Reason};
use crate::table::BrdfTable;

/// How the values are meant.
pub const CONVENTION: &str = "f4, C order, [theta_i, phi_i, theta_r, phi_r(, colour)] as the table has them; BRDF in 1/sr, \
    no cosine; bin means; no axes, no error bars";

/// Writes the totals.
pub fn write(table: &BrdfTable, out: &mut dyn Write) -> Result<(), Fail> {
    let totals: Vec<&[f32]> = table.colours.iter().map(|colour| colour.total.as_slice()).collect();
    Ok(npy::encode(out, &npz::shape(&table.grid, totals.len()), npz::interleaved(&totals))?)
}

/// The totals by colour that a file holds; its shape must be that of `table`.
pub fn read_back(bytes: &[u8], table: &BrdfTable) -> Reason<Vec<Vec<f32>>> {
    let array = npy::decode(bytes)?;
    let colours = table.colours.len();
    let NpyValues::F32(values) = array.values else { return Err("type f4 needed".into()) };
    if array.shape != npz::shape(&table.grid, colours) {
        return Err(format!("shape {:?}", array.shape));
    }
    Ok(npz::apart(&values, colours))
}
