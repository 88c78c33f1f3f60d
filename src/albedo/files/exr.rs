//! EXR: a part for each quantity and eta; x = mu, y = alpha, FLOAT. Channels: `Y` the value, `error` (-1: not available),
//! `average` and `average_error`, the same along a row. Nodes and texts are attributes of the first part.

use std::io::Write;

use crate::albedo::table::{AlbedoTable, Cell, Quantity};
use crate::error::Checked;
use crate::files::image::{self, Attribute, ImagePart, Samples};

pub(super) fn write(table: &AlbedoTable, out: &mut dyn Write) -> Checked<()> {
    let slabs = 0..table.axes.slabs();
    let each = slabs.flat_map(|slab| table.quantities.iter().map(move |quantity| (slab, quantity)));
    let mut parts: Vec<ImagePart> = each.map(|(slab, quantity)| part(table, slab, quantity)).collect();
    for (name, nodes) in table.axes.named() {
        let nodes: Vec<String> = nodes.iter().map(f64::to_string).collect();
        parts[0].set_text(&format!("gonio.{name}"), &nodes.join(", "));
    }
    for (name, text) in table.texts() {
        parts[0].set_text(&format!("gonio.{name}"), &text);
    }
    Ok(out.write_all(&image::encode(parts)?)?)
}

fn part(table: &AlbedoTable, slab: usize, quantity: &Quantity) -> ImagePart {
    let (width, height) = (table.axes.mu.len(), table.axes.alpha.len());
    let cells = &quantity.cells[slab * width * height..(slab + 1) * width * height];
    let averages = &quantity.averages[slab * height..(slab + 1) * height];
    let value = |cell: &Cell| cell.value as f32;
    let error = |cell: &Cell| cell.error.map_or(-1.0, |error| error as f32);
    let each = |of: &dyn Fn(&Cell) -> f32| Samples::F32(cells.iter().map(of).collect());
    let along = |of: &dyn Fn(&Cell) -> f32| {
        Samples::F32(averages.iter().flat_map(|cell| std::iter::repeat_n(of(cell), width)).collect())
    };
    let channels = [
        ("Y", each(&value)),
        ("error", each(&error)),
        ("average", along(&value)),
        ("average_error", along(&error)),
    ];
    let eta = table.axes.eta.get(slab);
    let mut part = ImagePart { width, height, ..ImagePart::default() };
    part.name = Some(eta.map_or(quantity.name.clone(), |eta| format!("{}.eta{eta}", quantity.name)));
    part.channels = channels.map(|(name, samples)| (name.to_string(), samples)).into();
    part.set_text("gonio.quantity", &quantity.name);
    part.set_text("gonio.about", &quantity.about);
    if let Some(&eta) = eta {
        part.attributes.insert("gonio.eta_of_part".into(), Attribute::Number(eta));
    }
    part
}
