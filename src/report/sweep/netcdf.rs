//! The figures of a sweep as NetCDF: one variable a column over the dimension `row`, with CF's attributes.
//!
//! The classic format (CDF-1; NetCDF User's Guide, "File Format Specifications"): big-endian; a header of lists of dimensions,
//! attributes and variables, each of which names where its values begin; everything padded to four bytes. Numbers are
//! doubles, n/a is `_FillValue`; words are characters over a dimension of their own length, padded with 0.

use super::ParameterSweep;
use super::columns::{Column, ColumnValues};
use crate::error::{Checked, wrong};

/// How a file begins, by which it is recognised as one of ours: the magic number and the dimension's name.
pub const NETCDF_MARK: &str = "gonio sweep";

/// Tags of lists and types.
const DIMENSION: u32 = 10;
const VARIABLE: u32 = 11;
const ATTRIBUTE: u32 = 12;
const CHAR: u32 = 2;
const DOUBLE: u32 = 6;

/// NetCDF's own fill value of doubles.
pub const FILL: f64 = 9.969_209_968_386_869e36;

/// A variable that is written: its dimensions, attributes and bytes.
struct Variable {
    name: String,
    dimensions: Vec<u32>,
    attributes: Vec<(&'static str, Attribute)>,
    kind: u32,
    values: Vec<u8>,
}

enum Attribute {
    Text(String),
    Double(f64),
}

impl ParameterSweep {
    /// The bytes of the file. Refused where they are more than the format's offsets reach, 2 GiB.
    // Tested by `a_sweep_is_read_back_as_netcdf` (tests/it/sweeps.rs), and with SciPy by tests/interop/check.py.
    pub fn netcdf(&self) -> Checked<Vec<u8>> {
        let columns = self.columns();
        let rows = columns.first().map_or(0, |column| match &column.values {
            ColumnValues::Numbers(all) => all.len(),
            ColumnValues::Texts(all) => all.len(),
        });
        let mut dimensions = vec![("row".to_string(), rows)];
        let variables: Vec<Variable> =
            columns.iter().map(|column| variable(column, &mut dimensions)).collect();
        let global = [
            ("Conventions", Attribute::Text("CF-1.11".into())),
            ("title", Attribute::Text(self.name.clone())),
            ("source", Attribute::Text(format!("{NETCDF_MARK}, version {}", env!("CARGO_PKG_VERSION")))),
        ];
        let header = |offsets: &[u32]| header(&dimensions, &global, &variables, offsets);
        let (mut begin, mut offsets) = (header(&vec![0; variables.len()]).len() as u64, Vec::new());
        for variable in &variables {
            let offset = u32::try_from(begin).ok().filter(|offset| *offset <= i32::MAX as u32);
            offsets
                .push(offset.ok_or_else(|| wrong!("{rows} rows do not fit NetCDF's classic format, 2 GiB"))?);
            begin += variable.values.len() as u64;
        }
        let mut out = header(&offsets);
        variables.iter().for_each(|variable| out.extend_from_slice(&variable.values));
        Ok(out)
    }
}

/// A column; the length of its words becomes a dimension.
fn variable(column: &Column, dimensions: &mut Vec<(String, usize)>) -> Variable {
    // A name of CF has letters, digits and underscores.
    let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = column.name.chars().map(letter).collect();
    let long_name = ("long_name", Attribute::Text(column.long_name.clone()));
    match &column.values {
        ColumnValues::Numbers(all) => Variable {
            attributes: vec![
                long_name,
                ("units", Attribute::Text(column.units.into())),
                ("_FillValue", Attribute::Double(FILL)),
            ],
            dimensions: vec![0],
            kind: DOUBLE,
            values: all.iter().flat_map(|value| value.unwrap_or(FILL).to_be_bytes()).collect(),
            name,
        },
        ColumnValues::Texts(all) => {
            let width = all.iter().map(String::len).max().unwrap_or(0).max(1);
            dimensions.push((format!("{name}_length"), width));
            let padded =
                |text: &String| text.bytes().chain(std::iter::repeat(0)).take(width).collect::<Vec<u8>>();
            let mut values: Vec<u8> = all.iter().flat_map(padded).collect();
            values.resize(values.len().next_multiple_of(4), 0);
            let attributes = vec![long_name];
            Variable {
                name,
                dimensions: vec![0, dimensions.len() as u32 - 1],
                attributes,
                kind: CHAR,
                values,
            }
        }
    }
}

fn header(
    dimensions: &[(String, usize)],
    global: &[(&'static str, Attribute)],
    variables: &[Variable],
    offsets: &[u32],
) -> Vec<u8> {
    let mut out = b"CDF\x01".to_vec();
    // No records: every dimension has its length.
    word(&mut out, 0);
    list(&mut out, DIMENSION, dimensions.len());
    for (name, length) in dimensions {
        text(&mut out, name);
        word(&mut out, *length as u32);
    }
    attributes(&mut out, global);
    list(&mut out, VARIABLE, variables.len());
    for (variable, offset) in variables.iter().zip(offsets) {
        text(&mut out, &variable.name);
        word(&mut out, variable.dimensions.len() as u32);
        variable.dimensions.iter().for_each(|&dimension| word(&mut out, dimension));
        attributes(&mut out, &variable.attributes);
        [variable.kind, variable.values.len() as u32, *offset].into_iter().for_each(|w| word(&mut out, w));
    }
    out
}

fn attributes(out: &mut Vec<u8>, all: &[(&'static str, Attribute)]) {
    list(out, ATTRIBUTE, all.len());
    for (name, value) in all {
        text(out, name);
        match value {
            Attribute::Text(words) => {
                word(out, CHAR);
                text(out, words);
            }
            Attribute::Double(value) => {
                word(out, DOUBLE);
                word(out, 1);
                out.extend(value.to_be_bytes());
            }
        }
    }
}

/// The head of a list; an empty one has no tag.
fn list(out: &mut Vec<u8>, tag: u32, length: usize) {
    word(out, if length == 0 { 0 } else { tag });
    word(out, length as u32);
}

fn word(out: &mut Vec<u8>, value: u32) {
    out.extend(value.to_be_bytes());
}

/// A name, or the value of an attribute: its length and its bytes.
fn text(out: &mut Vec<u8>, text: &str) {
    word(out, text.len() as u32);
    out.extend(text.as_bytes());
    out.resize(out.len().next_multiple_of(4), 0);
}
