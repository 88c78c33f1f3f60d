//! CSV: comment lines that begin with `#`, a heading, and a line a cell: axes, then value and error of each quantity, then
//! value and error of its average, which is the same for every mu. An error that is not available is `n/a`.

use std::io::{self, Write};

use crate::albedo::table::{AlbedoTable, Cell};
use crate::error::Checked;

pub(super) fn write(table: &AlbedoTable, out: &mut dyn Write) -> Checked<()> {
    for (name, text) in table.texts() {
        for line in text.lines() {
            writeln!(out, "# {name}: {line}")?;
        }
    }
    for quantity in &table.quantities {
        writeln!(out, "# {}: {}", quantity.name, quantity.about)?;
    }
    let mut writer = csv::Writer::from_writer(out);
    let axes = table.axes.named();
    let names = table.quantities.iter().map(|quantity| &quantity.name);
    let columns =
        names.flat_map(|name| ["", "_error", "_avg", "_avg_error"].map(|end| format!("{name}{end}")));
    let heading: Vec<String> = axes.iter().map(|(name, _)| name.to_string()).chain(columns).collect();
    writer.write_record(&heading).map_err(io::Error::from)?;
    let words =
        |cell: &Cell| [cell.value.to_string(), cell.error.map_or("n/a".into(), |error| format!("{error:e}"))];
    let mus = table.axes.mu.len();
    for cell in 0..table.axes.cells() {
        let mut rest = cell;
        let mut place: Vec<String> = Vec::new();
        for (_, nodes) in axes.iter().rev() {
            place.insert(0, nodes[rest % nodes.len()].to_string());
            rest /= nodes.len();
        }
        let values = table.quantities.iter().flat_map(|quantity| {
            [words(&quantity.cells[cell]), words(&quantity.averages[cell / mus])].concat()
        });
        writer.write_record(place.into_iter().chain(values)).map_err(io::Error::from)?;
    }
    Ok(writer.flush()?)
}
