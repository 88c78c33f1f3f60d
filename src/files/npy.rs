//! NPY arrays in memory: plain numbers of any shape, and texts; little-endian, C order when written.
//!
//! Input and output: bytes. Headers are looked at before the general parser sees them, as that recurses and
//! multiplies unchecked.

use std::io::{self, Write};

use npyz::{
    AutoSerialize, DType, Deserialize, Endianness, NpyFile, NpyHeader, NpyWriter, Order, TypeChar,
    WriterBuilder,
};

use super::memory;

const MAGIC: &[u8] = b"\x93NUMPY";
/// Longest header that a plain array needs, with room to spare.
const MAX_HEADER: usize = 4096;

/// Bytes of a file within which its header ends.
pub const LONGEST_HEAD: usize = 12 + MAX_HEADER;
/// More texts than any array of a table has.
const MOST_TEXTS: usize = 1 << 12;

/// An array as its file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Lengths along the axes; none for a single number.
    pub shape: Vec<usize>,
    /// The values in C order.
    pub values: NpyValues,
}

/// The values of an array.
#[derive(Debug, Clone, PartialEq)]
pub enum NpyValues {
    /// f4.
    F32(Vec<f32>),
    /// f8, and integers of up to 53 bits that are none of the others.
    F64(Vec<f64>),
    /// u1 and b1.
    U8(Vec<u8>),
    /// u4.
    U32(Vec<u32>),
    /// U: texts of code points.
    Text(Vec<String>),
}

impl Array {
    /// Number of values.
    pub fn len(&self) -> usize {
        match &self.values {
            NpyValues::F32(v) => v.len(),
            NpyValues::F64(v) => v.len(),
            NpyValues::U8(v) => v.len(),
            NpyValues::U32(v) => v.len(),
            NpyValues::Text(v) => v.len(),
        }
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Lets only headers through that a plain array of at most `dimensions` can have.
pub fn check_header(bytes: &[u8], dimensions: usize) -> Result<(), String> {
    let (start, length) = match bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([*a, *b]))),
        [_, _, _, _, _, _, _, _, a, b, c, d, ..] => (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize),
        _ => return Err("the NPY header is cut off".into()),
    };
    if length > MAX_HEADER {
        return Err(format!("an NPY header of {length} bytes is not that of a {dimensions}-D array"));
    }
    let text = bytes.get(start..start + length).ok_or("the NPY header is cut off")?;
    let numbers = text.split(|b| !b.is_ascii_digit()).filter(|run| !run.is_empty());
    let count = |wanted: &[u8]| text.iter().filter(|b| wanted.contains(b)).count();
    let (numbers, longest) = numbers.fold((0, 0), |(n, most), run| (n + 1, most.max(run.len())));
    let longest_side = if dimensions <= 2 { 6 } else { 9 };
    if numbers > dimensions + 2
        || longest > longest_side
        || count(b"(") > 1
        || count(b"{") > 1
        || count(b"[") > 0
    {
        let side = "9".repeat(longest_side);
        return Err(format!(
            "the NPY header is not that of a {dimensions}-D array of numbers, at most {side} a side"
        ));
    }
    Ok(())
}

/// Whether a file that begins with `head` and has so many bytes is as long as its header says.
pub fn check_length(head: &[u8], length: u64) -> Result<(), String> {
    let (header, data) = header(head)?;
    let before = (head.len() - data.len()) as u64;
    let values = header.shape().iter().try_fold(1u64, |count, &side| count.checked_mul(side));
    let (kind, shape) = (header.dtype().descr(), header.shape());
    let size = header.dtype().num_bytes().map(|size| size as u64);
    let wanted = size.zip(values).and_then(|(size, values)| size.checked_mul(values)?.checked_add(before));
    if wanted == Some(length) {
        return Ok(());
    }
    Err(format!("{} bytes of data do not make {shape:?} of type {kind}", length.saturating_sub(before)))
}

/// The header of a file, and what follows it.
fn header(bytes: &[u8]) -> Result<(NpyHeader, &[u8]), String> {
    if !bytes.starts_with(MAGIC) {
        return Err(if bytes.is_empty() { "the file is empty" } else { "not an NPY array" }.into());
    }
    check_header(bytes, 5)?;
    let mut data = bytes;
    let header = NpyHeader::from_reader(&mut data).map_err(|e| format!("NPY header: {e}"))?;
    Ok((header, data))
}

/// The array in the bytes of a file, at most five axes, as many values as the bytes hold.
pub fn decode(bytes: &[u8]) -> Result<Array, String> {
    let (header, data) = header(bytes)?;
    let shape: Vec<usize> = header.shape().iter().map(|&side| side as usize).collect();
    let DType::Plain(kind) = header.dtype() else {
        return Err("an array of records, plain numbers needed".into());
    };
    let wanted =
        kind.num_bytes().and_then(|size| shape.iter().try_fold(size, |size, &side| size.checked_mul(side)));
    if wanted != Some(data.len()) {
        return Err(format!("{} bytes of data do not make {shape:?} of type {kind}", data.len()));
    }
    if header.order() == Order::Fortran && shape.len() > 1 {
        return Err("column-major (Fortran) order; save the array with numpy.ascontiguousarray".into());
    }
    if kind.type_char() == TypeChar::UnicodeStr {
        let big = kind.endianness() == Endianness::Big;
        return Ok(Array { shape, values: NpyValues::Text(texts(data, kind.size_field() as usize, big)?) });
    }
    let npy = NpyFile::with_header(header, data);
    let values = match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 4) => NpyValues::F32(read(npy)?),
        (TypeChar::Float, 8) => NpyValues::F64(read(npy)?),
        (TypeChar::Uint, 1) => NpyValues::U8(read(npy)?),
        (TypeChar::Bool, 1) => NpyValues::U8(read::<bool>(npy)?.into_iter().map(u8::from).collect()),
        (TypeChar::Uint, 4) => NpyValues::U32(read(npy)?),
        (TypeChar::Int, 4) => NpyValues::F64(read::<i32>(npy)?.into_iter().map(f64::from).collect()),
        (TypeChar::Int, 8) => NpyValues::F64(read::<i64>(npy)?.into_iter().map(|v| v as f64).collect()),
        (TypeChar::Uint, 8) => NpyValues::F64(read::<u64>(npy)?.into_iter().map(|v| v as f64).collect()),
        _ => return Err(format!("type {kind} is not read; save the array as f4, f8, u1, u4 or integers")),
    };
    Ok(Array { shape, values })
}

/// Texts of `length` code points each, without the zeros that fill them up.
fn texts(data: &[u8], length: usize, big: bool) -> Result<Vec<String>, String> {
    let point = |bytes: &[u8; 4]| if big { u32::from_be_bytes(*bytes) } else { u32::from_le_bytes(*bytes) };
    let text = |points: &[[u8; 4]]| -> Result<String, String> {
        let all: Option<String> = points.iter().map(|bytes| char::from_u32(point(bytes))).collect();
        let all = all.ok_or("a number that is no character (Unicode code point)")?;
        Ok(all.trim_end_matches('\0').to_string())
    };
    let texts = data.as_chunks::<4>().0.chunks(length.max(1));
    if texts.len() > MOST_TEXTS {
        return Err(format!("{} texts, at most {MOST_TEXTS} are read", texts.len()));
    }
    texts.map(text).collect()
}

/// Writes one text, which NumPy reads as `str` (`<U`), without an axis.
// Tested by `the_texts_of_an_npz_are_strings` (tests/it/interchange/interchange_arrays.rs).
pub fn encode_text(mut out: impl Write, text: &str) -> io::Result<()> {
    // NumPy makes no type of length 0.
    let points = text.chars().count().max(1);
    let header = format!("{{'descr': '<U{points}', 'fortran_order': False, 'shape': (), }}");
    // Magic, version and length are 10 bytes; the data begin at a multiple of 64, behind a line feed.
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&(length as u16).to_le_bytes())?;
    writeln!(out, "{header:<0$}", length - 1)?;
    let filled = text.chars().chain(text.is_empty().then_some('\0'));
    filled.map(u32::from).try_for_each(|point| out.write_all(&point.to_le_bytes()))
}

fn read<T: Deserialize>(npy: NpyFile<&[u8]>) -> Result<Vec<T>, String> {
    let data = npy.data::<T>().map_err(|e| e.to_string())?;
    let mut values = memory::room(data.len() as usize)?;
    for value in data {
        values.push(value.map_err(|e| e.to_string())?);
    }
    Ok(values)
}

/// The f4 values of an array of this shape, one after the other, from a file that this program has written.
pub fn values_of<R: io::Read>(
    mut file: R,
    shape: &[usize],
) -> Result<impl Iterator<Item = io::Result<f32>> + use<R>, String> {
    let header = NpyHeader::from_reader(&mut file).map_err(|e| format!("NPY header: {e}"))?;
    if !header.shape().iter().map(|&side| side as usize).eq(shape.iter().copied()) {
        return Err(format!("shape {:?}, {shape:?} needed", header.shape()));
    }
    NpyFile::with_header(header, file).data::<f32>().map_err(|e| e.to_string())
}

/// Writes an array, the values streamed.
pub fn encode<T: AutoSerialize>(
    out: impl Write,
    shape: &[usize],
    values: impl Iterator<Item = T>,
) -> io::Result<()> {
    let mut array = writer(out, shape)?;
    array.extend(values)?;
    array.finish()
}

/// Begins an array of this shape.
pub fn writer<T: AutoSerialize, W: Write>(out: W, shape: &[usize]) -> io::Result<NpyWriter<T, W>> {
    let shape: Vec<u64> = shape.iter().map(|&side| side as u64).collect();
    npyz::WriteOptions::new().default_dtype().shape(&shape).writer(out).begin_nd()
}
