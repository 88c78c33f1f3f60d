//! Arrays of a scene: `.npy`, f32, row by row.

use std::path::Path;

use npyz::{DType, NpyFile, Order, TypeChar};

use crate::error::{Error, Result};
use crate::files::{self, npy};

/// Reads the f32 array of `path`; each side that `shape` names must be as it says.
pub(super) fn read(path: &Path, shape: &[Option<usize>]) -> Result<Vec<f32>> {
    let bytes = files::read(path)?;
    parse(&bytes, shape).map_err(|what| Error::format(path, what))
}

fn parse(bytes: &[u8], wanted: &[Option<usize>]) -> std::result::Result<Vec<f32>, String> {
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err("not an NPY file".into());
    }
    npy::check_header(bytes, 5)?;
    let npy = NpyFile::new(bytes).map_err(|e| e.to_string())?;
    let shape: Vec<u64> = npy.shape().to_vec();
    let said = |shape: &[String]| shape.join(" x ");
    let fits = shape.len() == wanted.len()
        && shape.iter().zip(wanted).all(|(&side, wanted)| wanted.is_none_or(|wanted| wanted as u64 == side));
    if !fits || shape.contains(&0) {
        let found: Vec<String> = shape.iter().map(u64::to_string).collect();
        let needed: Vec<String> =
            wanted.iter().map(|side| side.map_or("any".into(), |side| side.to_string())).collect();
        return Err(format!("an array of {}; {} is needed", said(&found), said(&needed)));
    }
    let is_f32 = matches!(npy.dtype(), DType::Plain(kind)
        if kind.type_char() == TypeChar::Float && kind.size_field() == 4);
    if !is_f32 || npy.order() != Order::C {
        return Err("must be of type f4, row by row (C order)".into());
    }
    let count = shape.iter().try_fold(1u64, |count, &side| count.checked_mul(side));
    let values = npy.data::<f32>().map_err(|e| e.to_string())?;
    let values: std::result::Result<Vec<f32>, _> = values.collect();
    let values = values.map_err(|_| "shorter than its header says".to_string())?;
    if Some(values.len() as u64) != count {
        return Err("shorter than its header says".into());
    }
    match values.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(format!("value {at} is {}; all must be finite", values[at])),
        None => Ok(values),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn npy(kind: &str, fortran: &str, shape: &str, values: usize) -> Vec<u8> {
        let header =
            format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n").into_bytes();
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header);
        bytes.extend([0u8; 4].repeat(values));
        bytes
    }

    #[test]
    fn only_the_wanted_array_is_read() {
        let wanted = [None, Some(6)];
        assert_eq!(parse(&npy("<f4", "False", "(2, 6)", 12), &wanted), Ok(vec![0.0; 12]));
        let mut nan = npy("<f4", "False", "(1, 6)", 5);
        nan.extend(f32::NAN.to_le_bytes());
        for (bytes, reason) in [
            (b"GIF89a".to_vec(), "not an NPY file"),
            (Vec::new(), "not an NPY file"),
            (npy("<f4", "False", "(2, 5)", 10), "an array of 2 x 5; any x 6 is needed"),
            (npy("<f4", "False", "(12,)", 12), "any x 6 is needed"),
            (npy("<f4", "False", "(0, 6)", 0), "an array of 0 x 6"),
            (npy("<f8", "False", "(2, 6)", 24), "type f4"),
            (npy("<f4", "True", "(2, 6)", 12), "type f4, row by row"),
            (npy("<f4", "False", "(2, 6)", 11), "shorter than its header says"),
            (npy("<f4", "False", "(99999999999, 6)", 11), "at most 999999999 a side"),
            (npy("<f4", "False", "(999999999, 6)", 11), "shorter than its header says"),
            (nan, "value 5 is NaN"),
        ] {
            let found = parse(&bytes, &wanted).expect_err(reason);
            assert!(found.contains(reason), "{reason}: {found}");
        }
    }
}
