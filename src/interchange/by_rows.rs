//! The way out for tables larger than memory: NPY and CSV, a band of stops after the other, and read back the same way.
//!
//! Enters: an open table. Leaves: the very file of the whole table.

use std::fs::File;
use std::io::{self, BufReader, Write};
use std::ops::Range;
use std::path::Path;

use super::numpy::{npy, npz};
use super::read_back::{BandErrors, Listing};
use super::text::{csv, named_columns, samples};
use super::{Export, Fail, Format, Reason};
use crate::error::{Error, Result};
use crate::files;
use crate::files::npy as npy_file;
use crate::table::{BrdfTable, TableRows};

/// Writes an open table to `path`, whole or not at all, and reads it back; no band is larger than `bytes`.
///
/// Errors: [`Error::Refused`] for formats that need the whole table; those of the table's file; [`Error::Io`].
/// Held by: `a_table_exported_by_rows_is_the_file_of_the_whole` (tests/it/table/large_tables.rs).
pub fn export_rows(rows: &mut TableRows, format: Format, path: &Path, bytes: u64) -> Result<Export> {
    let refused = |why: String| Error::Refused(format!("{}: {}: {why}", path.display(), format.name()));
    rows.verify()?;
    let bands = rows.bands(bytes, rows.row_bytes());
    let first = rows.take(&[0])?;
    if first.is_spectral() && !format.holds_wavelengths() {
        return Err(refused("holds Y or R G B, the table has wavelengths; npy and csv hold them".into()));
    }
    // What ends the writing early, where it is not the system.
    let mut cause = None;
    let mut stop = |error: Error| {
        cause = Some(error);
        io::Error::other("the table cannot be read")
    };
    let written = files::write_atomically_with(path, |out| match format {
        Format::Npy => write_npy(rows, &first, &bands, out, &mut stop),
        Format::Csv => write_csv(rows, &first, &bands, out, &mut stop),
        _ => Err(stop(refused("needs the whole table in memory".into()))),
    });
    if let Some(cause) = cause {
        return Err(cause);
    }
    written?;
    let file = File::open(path).map(BufReader::new).map_err(|e| Error::io(path, e))?;
    let (convention, held) = match format {
        Format::Npy => (npy::CONVENTION, npy_back(rows, &first, &bands, file)),
        _ => (csv::CONVENTION, csv_back(rows, &bands, file)),
    };
    let internal = |why: String| Error::Internal(format!("{} does not read back: {why}", path.display()));
    let read_back = held.map_err(internal)?.read_back();
    Ok(Export { convention: convention.into(), notes: vec![], read_back, albedo: None })
}

fn take(rows: &mut TableRows, band: &Range<usize>) -> Result<BrdfTable> {
    rows.take(&band.clone().collect::<Vec<_>>())
}

fn totals(band: &BrdfTable) -> Vec<&[f32]> {
    band.colours.iter().map(|colour| colour.total.as_slice()).collect()
}

fn write_npy(
    rows: &mut TableRows,
    first: &BrdfTable,
    bands: &[Range<usize>],
    out: &mut dyn Write,
    stop: &mut dyn FnMut(Error) -> io::Error,
) -> io::Result<()> {
    let shape = npz::shape(rows.grid(), first.colours.len());
    let mut failure = None;
    let values = bands.iter().map_while(|band| match take(rows, band) {
        Ok(band) => Some(npz::interleaved(&totals(&band)).collect::<Vec<f32>>()),
        Err(error) => {
            failure = Some(error);
            None
        }
    });
    let written = npy_file::encode(out, &shape, values.flatten());
    match failure {
        Some(error) => Err(stop(error)),
        None => written,
    }
}

fn write_csv(
    rows: &mut TableRows,
    first: &BrdfTable,
    bands: &[Range<usize>],
    out: &mut dyn Write,
    stop: &mut dyn FnMut(Error) -> io::Error,
) -> io::Result<()> {
    let plain = |fail: Fail| match fail {
        Fail::Io(error) => error,
        Fail::Refused(why) => io::Error::other(why),
    };
    let mut writer = ::csv::Writer::from_writer(out);
    let isotropic = rows.grid().is_isotropic();
    csv::write_heading(&named_columns::names_of(first), isotropic, &mut writer).map_err(plain)?;
    for band in bands {
        let band = take(rows, band).map_err(&mut *stop)?;
        csv::write_lines(&band, isotropic, &mut writer).map_err(plain)?;
    }
    writer.flush()
}

fn npy_back(
    rows: &mut TableRows,
    first: &BrdfTable,
    bands: &[Range<usize>],
    file: BufReader<File>,
) -> Reason<BandErrors> {
    let (mut held, colours) = (BandErrors::default(), first.colours.len());
    let mut values = npy_file::values_of(file, &npz::shape(rows.grid(), colours))?;
    for band in bands {
        let band = take(rows, band).map_err(|e| e.to_string())?;
        let (mut listing, bins) = (Listing::new(&band), band.grid.bins());
        for (at, value) in values.by_ref().take(band.hits.len() * colours).enumerate() {
            let (entry, colour) = (at / colours, at % colours);
            listing.add(entry / bins, entry % bins, colour, value.map_err(|e| e.to_string())?);
        }
        held.join(listing)?;
    }
    Ok(held)
}

fn csv_back(rows: &mut TableRows, bands: &[Range<usize>], file: BufReader<File>) -> Reason<BandErrors> {
    let (mut held, mut lines) = (BandErrors::default(), csv::SampleLines::open(file)?);
    for band in bands {
        let band = take(rows, band).map_err(|e| e.to_string())?;
        let listing = samples::listed(&band, 0.0, |each| {
            lines.by_ref().take(band.hits.len() - band.gaps()).try_for_each(|sample| each(sample?))
        })?;
        held.join(listing)?;
    }
    Ok(held)
}
