//! NPZ: `mu`, `alpha` and `eta` f8; each quantity f8 [eta, alpha, mu], `name_error` alike (-1: not available), `name_avg`
//! and `name_avg_error` [eta, alpha]; without eta, [alpha, mu] and [alpha]. Texts as `str`.

use std::io::Write;

use crate::albedo::table::{AlbedoTable, Cell};
use crate::error::Checked;
use crate::interchange::numpy::npz::Archive;

pub(super) fn write(table: &AlbedoTable, out: &mut dyn Write) -> Checked<()> {
    let mut archive = Archive::new(out);
    let axes = table.axes.named();
    for (name, nodes) in &axes {
        archive.axis(name, nodes)?;
    }
    let shape: Vec<usize> = axes.iter().map(|(_, nodes)| nodes.len()).collect();
    for quantity in &table.quantities {
        let both =
            [("", &quantity.cells, &shape[..]), ("_avg", &quantity.averages, &shape[..shape.len() - 1])];
        for (suffix, cells, shape) in both {
            let name = format!("{}{suffix}", quantity.name);
            archive.array(&name, shape, cells.iter().map(|cell| cell.value))?;
            let error = |cell: &Cell| cell.error.unwrap_or(-1.0);
            archive.array(&format!("{name}_error"), shape, cells.iter().map(error))?;
        }
    }
    for (name, text) in table.texts() {
        archive.text(name, &text)?;
    }
    archive.finish()
}
