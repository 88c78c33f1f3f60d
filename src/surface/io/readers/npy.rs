//! NumPy arrays of two dimensions, [row, column], of any plain type of numbers.

use npyz::{DType, Deserialize, NpyFile, NpyHeader, Order, TypeChar};

use super::MapReader;
use crate::error::Checked;
use crate::files::{memory, npy};
use crate::surface::io::samples::{MapSamples, Stored};

const MAGIC: &[u8] = b"\x93NUMPY";

pub struct Npy;

impl MapReader for Npy {
    fn name(&self) -> &'static str {
        "NPY"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(MAGIC)
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        npy::check_header(bytes, 2)?;
        let header = NpyHeader::from_reader(&mut &*bytes).map_err(|e| format!("NPY header: {e}"))?;
        Ok(16 * (bytes.len() as u64 / header.dtype().num_bytes().unwrap_or(1).max(1) as u64))
    }

    fn read(&self, bytes: &[u8], _: Option<&str>) -> Checked<MapSamples> {
        Ok(read(bytes)?)
    }
}

fn read(bytes: &[u8]) -> Result<MapSamples, String> {
    npy::check_header(bytes, 2)?;
    let mut data = bytes;
    let header = NpyHeader::from_reader(&mut data).map_err(|e| format!("NPY header: {e}"))?;
    let &[rows, columns] = header.shape() else {
        return Err(format!("an array of {} dimensions; a height map has 2", header.shape().len()));
    };
    let DType::Plain(kind) = header.dtype() else {
        return Err("an array of records; a height map has plain numbers".into());
    };
    let expected = header.len().checked_mul(kind.size_field());
    if expected != Some(data.len() as u64) || rows == 0 || columns == 0 {
        return Err(format!("{} bytes of data do not make {rows} x {columns} of type {kind}", data.len()));
    }
    let (rows, columns, order) = (rows as usize, columns as usize, header.order());
    let npy = NpyFile::with_header(header, data);
    let heights = match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 4) => values(npy, |v: f32| f64::from(v)),
        (TypeChar::Float, 8) => values(npy, |v: f64| v),
        (TypeChar::Int, 1) => values(npy, |v: i8| f64::from(v)),
        (TypeChar::Int, 2) => values(npy, |v: i16| f64::from(v)),
        (TypeChar::Int, 4) => values(npy, |v: i32| f64::from(v)),
        (TypeChar::Uint, 1) => values(npy, |v: u8| f64::from(v)),
        (TypeChar::Uint, 2) => values(npy, |v: u16| f64::from(v)),
        (TypeChar::Uint, 4) => values(npy, |v: u32| f64::from(v)),
        (TypeChar::Int, 8) => values(npy, |v: i64| v as f64),
        (TypeChar::Uint, 8) => values(npy, |v: u64| v as f64),
        _ => return Err(format!("type {kind} is not read; save the array as f4, f8 or integers")),
    }?;
    let stored = match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 4) => Stored::Single,
        _ => Stored::Exact,
    };
    let heights = if order == Order::Fortran { transposed(&heights, rows) } else { heights };
    Ok(MapSamples::new(columns, rows, heights, stored))
}

fn values<T: Deserialize>(npy: NpyFile<&[u8]>, to_f64: impl Fn(T) -> f64) -> Result<Vec<f64>, String> {
    let data = npy.data::<T>().map_err(|e| e.to_string())?;
    let mut heights = memory::room(data.len() as usize)?;
    for value in data {
        heights.push(to_f64(value.map_err(|e| e.to_string())?));
    }
    Ok(heights)
}

/// Row-major from column-major.
fn transposed(columns_first: &[f64], rows: usize) -> Vec<f64> {
    (0..rows).flat_map(|row| columns_first.iter().skip(row).step_by(rows).copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn npy(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn header(kind: &str, fortran: &str, shape: &str) -> String {
        format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
    }

    #[test]
    fn every_number_type_and_order_reads_as_the_same_map() {
        let map = |kind: &str, fortran: &str, bytes: Vec<u8>| {
            read(&npy(&header(kind, fortran, "(2, 3)"), &bytes)).expect("readable").heights
        };
        let c = [1u8, 2, 3, 4, 5, 6];
        let f = [1u8, 4, 2, 5, 3, 6];
        let expected = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let le = |n: usize| c.iter().flat_map(|&v| u64::from(v).to_le_bytes()[..n].to_vec()).collect();
        for (kind, size) in
            [("|u1", 1), ("|i1", 1), ("<i2", 2), ("<u2", 2), ("<i4", 4), ("<u8", 8), ("<i8", 8)]
        {
            assert_eq!(map(kind, "False", le(size)), expected, "{kind}");
        }
        assert_eq!(map("|u1", "True", f.to_vec()), expected);
        assert_eq!(
            map(">f4", "False", c.iter().flat_map(|&v| f32::from(v).to_be_bytes()).collect()),
            expected
        );
        assert_eq!(
            map("<f8", "False", c.iter().flat_map(|&v| f64::from(v).to_le_bytes()).collect()),
            expected
        );
    }

    #[test]
    fn arrays_that_are_no_height_map_are_refused_with_a_reason() {
        let reason = |header: String, data: &[u8]| read(&npy(&header, data)).expect_err("must be refused");
        assert!(reason(header("<f4", "False", "(2, 3, 4)"), &[0; 96]).contains("3 dimensions"));
        assert!(reason(header("<f4", "False", "(2, 3)"), &[0; 23]).contains("do not make 2 x 3"));
        assert!(reason(header("<f4", "False", "(999999, 999999)"), &[0; 8]).contains("do not make"));
        assert!(reason(header("<f4", "False", "(99999999999999, 9)"), &[0; 8]).contains("999999 a side"));
        assert!(reason(header("<f2", "False", "(2, 2)"), &[0; 8]).contains("not read"));
        assert!(reason("(".repeat(4000), &[]).contains("2-D"));
        assert!(reason(header("<f4", "False", "(0, 0)"), &[]).contains("0 x 0"));
    }
}
