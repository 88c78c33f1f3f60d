//! A patch as a mesh: binary glTF 2.0, every facet of the surface a triangle, for viewers and modellers.
//!
//! glTF has y up: (x, y, z) of the patch is (x, z, -y) of the file. Lengths are in the unit of the heights, a unit for a metre:
//! a patch has no size of its own, and viewers see nothing of one of a tenth of a millimetre. No normals are written; a reader
//! then shades each facet by itself, which is what is traced. Source: the specification of glTF 2.0, section 4.

use serde_json::json;

use super::export::{samples, to_f32};
use crate::error::{Error, Result};
use crate::surface::Heightfield;

/// 32-bit float, 32-bit index, as glTF numbers them.
const FLOAT: u32 = 5126;
const INDEX: u32 = 5125;
/// What a buffer is for: vertices, indices.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
/// The largest file, whose lengths are 32-bit numbers.
const LARGEST: u64 = u32::MAX as u64;
/// Bytes of a vertex, and of a triangle.
const BYTES: [u64; 2] = [12, 12];

/// The mesh of a patch whose cells are `pitch` long, in the unit of the heights. A periodic patch shows its first row and column
/// again at its end.
pub fn encode(field: &Heightfield, pitch: [f64; 2]) -> Result<Vec<u8>> {
    let (columns, rows) = (field.cells_x() + 1, field.cells_y() + 1);
    let (vertices, triangles) = ((columns * rows) as u64, 2 * (field.cells_x() * field.cells_y()) as u64);
    let size = BYTES[0] * vertices + BYTES[1] * triangles;
    if size + 4096 > LARGEST {
        return Err(Error::Refused(format!(
            "a mesh of {} x {} cells is {size} bytes long, and glTF ends at {LARGEST}: at most 10,000 x 10,000 cells",
            field.cells_x(),
            field.cells_y()
        )));
    }
    let (heights, (stored, stored_rows)) = (to_f32(field)?, samples(field));
    let mut binary = Vec::with_capacity(size as usize);
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for (column, row) in (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))) {
        // A periodic patch stores neither its last column nor its last row.
        let height = heights[(row % stored_rows) * stored + column % stored];
        let vertex = [(column as f64 * pitch[0]) as f32, height, (0.0 - row as f64 * pitch[1]) as f32];
        low = [0, 1, 2].map(|k| low[k].min(vertex[k]));
        high = [0, 1, 2].map(|k| high[k].max(vertex[k]));
        vertex.iter().for_each(|part| binary.extend(part.to_le_bytes()));
    }
    for (x, y) in (0..rows - 1).flat_map(|y| (0..columns - 1).map(move |x| (x, y))) {
        let at = |x: usize, y: usize| (y * columns + x) as u32;
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
        [a, b, c, d, c, b].iter().for_each(|corner| binary.extend(corner.to_le_bytes()));
    }
    let bytes = BYTES[0] * vertices;
    let document = json!({
        "asset": { "version": "2.0", "generator": concat!("gonio ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "patch" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": 1.0, "roughnessFactor": 0.25 }, "doubleSided": true }],
        "accessors": [
            { "bufferView": 0, "componentType": FLOAT, "count": vertices, "type": "VEC3", "min": low, "max": high },
            { "bufferView": 1, "componentType": INDEX, "count": 3 * triangles, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": bytes, "target": VERTICES },
            { "buffer": 0, "byteOffset": bytes, "byteLength": size - bytes, "target": INDICES },
        ],
        "buffers": [{ "byteLength": size }],
    });
    Ok(container(document.to_string().into_bytes(), &binary))
}

/// Header, document and numbers, each part filled up to four bytes.
fn container(mut document: Vec<u8>, binary: &[u8]) -> Vec<u8> {
    document.resize(document.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + document.len() + 8 + binary.len();
    let chunk = |kind: &[u8; 4], bytes: usize| [(bytes as u32).to_le_bytes(), *kind].concat();
    let head = [*b"glTF", 2u32.to_le_bytes(), (length as u32).to_le_bytes()].concat();
    [head, chunk(b"JSON", document.len()), document, chunk(b"BIN\0", binary.len()), binary.to_vec()].concat()
}
