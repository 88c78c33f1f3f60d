//! The samples of a height map's file, untouched: EXR, NPY, GSF or text, distinguished by their first bytes.

use std::io::Cursor;

use npyz::{DType, Deserialize, NpyFile, NpyHeader, Order, TypeChar};

use crate::error::Checked;
use crate::files::image;
use crate::files::image::Samples;
use crate::files::image_blocks::BlockReader;
use crate::files::{exr_header, memory, npy};
use crate::text_decoding::decode_text_or_latin1;

use super::samples::{MapSamples, Stored};
use super::{gsf, text};

const NPY_MAGIC: &[u8] = b"\x93NUMPY";

/// The most bytes of memory that reading these bytes may take, besides themselves: heights in f64, and a copy of them that
/// is sorted for outliers.
// Tested by tests/process/bombs.rs.
pub fn needed(bytes: &[u8]) -> Checked<u64> {
    let length = bytes.len() as u64;
    Ok(if exr_header::is_exr(bytes) {
        // Heights in f64 are four times as long as halves.
        BlockReader::open(Cursor::new(bytes))?.bytes().saturating_mul(8)
    } else if bytes.starts_with(NPY_MAGIC) {
        npy::check_header(bytes, 2)?;
        let header = NpyHeader::from_reader(&mut &*bytes).map_err(|e| format!("NPY header: {e}"))?;
        16 * (length / header.dtype().num_bytes().unwrap_or(1).max(1) as u64)
    } else if bytes.starts_with(gsf::MAGIC) {
        4 * length
    } else {
        // A text of another encoding, and a list of f64 that grows.
        2 * length + 3 * 8 * memory::words(bytes)
    })
}

/// Reads a map from the bytes of its file; the error is a reason, to be completed with the path.
pub fn read(bytes: &[u8]) -> Checked<MapSamples> {
    let map = if exr_header::is_exr(bytes) {
        read_exr(bytes)?
    } else if bytes.starts_with(NPY_MAGIC) {
        read_npy(bytes)?
    } else if bytes.starts_with(gsf::MAGIC) {
        gsf::read(bytes)?
    } else if bytes.is_empty() {
        return Err("the file is empty".into());
    } else {
        text::read(&decode_text_or_latin1(bytes)?).ok_or(
            "neither EXR, NPY, a Gwyddion simple field, an Arc grid, a matrix nor lines of x y z, the height maps that \
             are read",
        )??
    };
    match map.heights.iter().position(|height| !height.is_finite()) {
        Some(at) => {
            let (row, column, height) = (at / map.columns, at % map.columns, map.heights[at]);
            Err(format!("height at row {row}, column {column} is {height}; fill the gaps of the scan first")
                .into())
        }
        None => Ok(map),
    }
}

fn read_exr(bytes: &[u8]) -> Checked<MapSamples> {
    let mut parts = image::decode(bytes)?;
    let (Some(mut part), true) = (parts.pop(), parts.is_empty()) else {
        return Err("several parts; a height map has one".into());
    };
    let names: Vec<String> = part.channels.keys().cloned().collect();
    let samples = match (part.channels.remove("height"), names.as_slice()) {
        (Some(samples), _) => samples,
        (None, [only]) => part.channels.remove(only).ok_or("no channels")?,
        (None, _) => return Err(format!("no channel `height` among {}", names.join(", ")).into()),
    };
    let (heights, stored) = match samples {
        Samples::F32(values) => (values.into_iter().map(f64::from).collect(), Stored::Single),
        Samples::F16(values) => (values.into_iter().map(|v| v.to_f64()).collect(), Stored::Half),
        Samples::U32(values) => (values.into_iter().map(f64::from).collect(), Stored::Exact),
    };
    let pitch = [part.number("pitch_x"), part.number("pitch_y")];
    Ok(MapSamples { pitch, ..MapSamples::new(part.width, part.height, heights, stored) })
}

fn read_npy(bytes: &[u8]) -> Result<MapSamples, String> {
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
        assert!(reason(header("<f4", "False", "(2, 3, 4)"), &[0; 96]).to_string().contains("3 dimensions"));
        assert!(reason(header("<f4", "False", "(2, 3)"), &[0; 23]).to_string().contains("do not make 2 x 3"));
        assert!(
            reason(header("<f4", "False", "(999999, 999999)"), &[0; 8]).to_string().contains("do not make")
        );
        assert!(
            reason(header("<f4", "False", "(99999999999999, 9)"), &[0; 8])
                .to_string()
                .contains("999999 a side")
        );
        assert!(reason(header("<f2", "False", "(2, 2)"), &[0; 8]).to_string().contains("not read"));
        assert!(reason("(".repeat(4000), &[]).to_string().contains("2-D"));
        assert!(reason(header("<f4", "False", "(0, 0)"), &[]).to_string().contains("0 x 0"));
        assert!(read(b"").expect_err("empty").to_string().contains("empty"));
        assert!(read(b"GIF89a").expect_err("foreign").to_string().contains("neither"));
    }
}
