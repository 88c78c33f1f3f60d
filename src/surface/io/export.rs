//! Patches as files: EXR with pitches, or NPY; f32, row 0 at y = 0, the same bytes from every run.
// Tested by `exported_heights_come_back_bit_for_bit`.

use crate::error::{Error, Result};
use crate::files::image::{Attribute, ImagePart, Samples};
use crate::files::{image, npy};
use crate::surface::Heightfield;

/// An EXR image with the channel `height` and the attributes `pitch_x` and `pitch_y` (doubles, in the unit of
/// the heights).
pub fn encode_exr(field: &Heightfield, pitch_x: f64, pitch_y: f64) -> Result<Vec<u8>> {
    let (width, height) = samples(field);
    let mut part = ImagePart { width, height, ..ImagePart::default() };
    part.channels.insert("height".into(), Samples::F32(to_f32(field)?));
    part.attributes.insert("pitch_x".into(), Attribute::Number(pitch_x));
    part.attributes.insert("pitch_y".into(), Attribute::Number(pitch_y));
    image::encode(vec![part]).map_err(|why| Error::Internal(format!("encoding a patch: {why}")))
}

/// A 2-D NPY array of little-endian f32, C order, [row, column].
pub fn encode_npy(field: &Heightfield) -> Result<Vec<u8>> {
    let (columns, rows) = samples(field);
    let mut bytes = Vec::new();
    npy::encode(&mut bytes, &[rows, columns], to_f32(field)?.into_iter())
        .map_err(|why| Error::Internal(format!("encoding a patch: {why}")))?;
    Ok(bytes)
}

/// Samples in a row, and rows.
pub(super) fn samples(field: &Heightfield) -> (usize, usize) {
    let extra = usize::from(!field.is_periodic());
    (field.cells_x() + extra, field.cells_y() + extra)
}

/// The heights as f32: exact for synthesised ones, which are f32 values already.
pub(super) fn to_f32(field: &Heightfield) -> Result<Vec<f32>> {
    let (columns, _) = samples(field);
    let convert = |(at, &height): (usize, &f64)| {
        let value = height as f32;
        if value.is_finite() {
            return Ok(value);
        }
        let (row, column) = (at / columns, at % columns);
        Err(Error::Refused(format!("height at row {row}, column {column} is {height}: no finite f32")))
    };
    field.heights().iter().enumerate().map(convert).collect()
}
