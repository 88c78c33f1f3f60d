//! A table written by rows: bands of incidences one after the other, never more than a band in memory.
//!
//! Input: bands, in the order of the incidences. Output: the very file of the whole table.

use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use crate::error::{ContentError, Error, Result};
use crate::files::image::ImagePart;
use crate::files::row_writer::RowWriter;
use crate::files::{Destination, NewFile};
use crate::instrument::Grid;

use super::channels::{self, DIGEST};
use super::content_digest::ContentDigest;
use super::{BrdfTable, header};

/// A table's unfinished file.
pub struct TableWriter<W> {
    rows: RowWriter<W>,
    content: ContentDigest,
    /// The texts.
    outline: ImagePart,
    patch_digest: String,
    /// Errors of the albedos by colour.
    albedo_se: Vec<Vec<f32>>,
    /// Incidences taken so far.
    incidences: usize,
    path: PathBuf,
}

impl TableWriter<NewFile> {
    /// Begins the file at `path`: it takes its name when the file that [`TableWriter::finish`] hands back is committed.
    pub fn create(path: impl Into<Destination>, like: &BrdfTable, grid: &Grid) -> Result<Self> {
        let path = path.into();
        Self::new(NewFile::create(&path)?, &path, like, grid)
    }
}

impl<W: Write + Seek> TableWriter<W> {
    /// Begins a table of all incidences of `grid`, with the channels and texts of `like`; `path` is for messages.
    pub fn new(out: W, path: &Path, like: &BrdfTable, grid: &Grid) -> Result<Self> {
        let begin = || header::outline(like, grid, &channels::planes(like, 0)?);
        let outline = begin().map_err(refused)?;
        let rows = RowWriter::new(out, outline.clone()).map_err(|e| Error::io(path, e))?;
        let (content, patch_digest) = (ContentDigest::default(), like.patch_digest.clone());
        let albedo_se = vec![Vec::new(); like.colours.len()];
        Ok(TableWriter { rows, content, outline, patch_digest, albedo_se, incidences: 0, path: path.into() })
    }

    /// Adds the rows of the next incidences. NaN and infinite values are refused.
    pub fn append(&mut self, band: &BrdfTable) -> Result<()> {
        let planes = channels::planes(band, self.incidences).map_err(refused)?;
        if band.patch_digest != self.patch_digest {
            return Err(Error::Internal("bands of different patches do not make a table".into()));
        }
        let bins = band.grid.bins();
        for incidence in 0..band.grid.incidences() {
            let content = &mut self.content;
            let fill = |name: &str, out: &mut Vec<u8>| {
                let Some(plane) = planes.get(name) else { return };
                let before = out.len();
                plane.bytes(incidence * bins..(incidence + 1) * bins, out);
                content.add(name, &plane.kind(), &out[before..]);
            };
            self.rows.row(fill).map_err(|e| Error::io(&self.path, e))?;
        }
        for (all, colour) in self.albedo_se.iter_mut().zip(&band.colours) {
            all.extend(&colour.albedo_se);
        }
        self.incidences += band.grid.incidences();
        Ok(())
    }

    /// Completes the header, and hands back the file and the table's digest.
    pub fn finish(mut self) -> Result<(W, String)> {
        channels::set_albedo_errors(&mut self.outline, &self.albedo_se, self.incidences);
        let digest = self.content.finish(&self.outline);
        self.outline.set_text(DIGEST, &digest);
        let out = self.rows.finish(&self.outline).map_err(|e| Error::io(&self.path, e))?;
        Ok((out, digest))
    }
}

fn refused(why: ContentError) -> Error {
    Error::Refused(format!("the table cannot be stored: {why}"))
}
