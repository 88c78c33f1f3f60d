//! A stored table read by rows: its header first, then the incidences that are asked for, from a file of any size.
//!
//! Input: a table's file. Output: bands of it, each a table of its own with a list of incidences.

use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Checked, ContentError, Error, Result};
use crate::files::image::{self, ImagePart};
use crate::files::image_blocks::BlockReader;
use crate::files::{self, Input};
use crate::instrument::Grid;

use super::channels::{self, ColourName, DIGEST};
use super::content_digest::ContentDigest;
use super::header::{TableHeader, header};
use super::{BrdfTable, store};

/// An open table.
pub struct TableRows {
    path: PathBuf,
    blocks: BlockReader<BufReader<Input>>,
    /// Channels that are a table's, without values.
    outline: ImagePart,
    empty: BrdfTable,
    names: Vec<ColourName>,
    warnings: Vec<String>,
}

impl TableRows {
    /// Reads the header of a table's file.
    pub fn open(path: &Path) -> Result<Self> {
        let wrong = |why: ContentError| Error::format(path, why);
        let blocks = BlockReader::open(BufReader::new(files::open(path)?)).map_err(wrong)?;
        let [outline] = blocks.outlines() else {
            return Err(store::several(path, blocks.outlines().len()));
        };
        let mut outline = outline.clone();
        let TableHeader { empty, names, mut warnings } = header(&mut outline).map_err(wrong)?;
        if outline.text(DIGEST).is_none() {
            warnings.push(channels::no_digest());
        }
        Ok(TableRows { path: path.into(), blocks, outline, empty, names, warnings })
    }

    /// The table without its values.
    pub fn header(&self) -> &BrdfTable {
        &self.empty
    }

    /// Its geometry.
    pub fn grid(&self) -> &Grid {
        &self.empty.grid
    }

    /// How many colours it has.
    pub fn colours(&self) -> usize {
        self.names.len()
    }

    /// The digest that the file carries.
    pub fn digest(&self) -> Option<&str> {
        self.outline.text(DIGEST)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is missing or odd, without being wrong.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Bytes of all values, as they are in memory.
    pub fn bytes(&self) -> u64 {
        self.row_bytes() * self.outline.height as u64
    }

    /// Bytes that reading all values at once takes.
    pub fn reading_bytes(&self) -> u64 {
        self.blocks.bytes()
    }

    /// Bytes of one incidence's values.
    pub fn row_bytes(&self) -> u64 {
        4 * (self.outline.channels.len() * self.outline.width) as u64
    }

    /// Bands of whole blocks, as many incidences each as `bytes` hold when an incidence takes `row_bytes`, at least
    /// one block.
    ///
    /// Whole blocks: each is decoded once.
    pub fn bands(&self, bytes: u64, row_bytes: u64) -> Vec<Range<usize>> {
        bands(self.outline.height, self.blocks.rows(0), bytes, row_bytes)
    }

    /// Holds the content to the file's digest, block by block. Without digest there is nothing to hold it to.
    pub fn verify(&mut self) -> Result<()> {
        let Some(stored) = self.outline.text(DIGEST).map(str::to_string) else { return Ok(()) };
        let mut content = ContentDigest::default();
        for number in 0..self.blocks.count(0) {
            let block = self.blocks.read(0, number).map_err(|why| Error::format(&self.path, why))?;
            for (name, _, values) in block.lines() {
                if let Some(kind) = self.outline.channels.get(name) {
                    content.add(name, kind, values);
                }
            }
        }
        channels::same_digest(&stored, &content, &self.outline, &self.empty.patch_digest)
            .map_err(|why| Error::format(&self.path, why))
    }

    /// The rows of some incidences, in increasing order, as a table of these incidences.
    // Tested by `bands_of_a_table_are_its_rows` (tests/it/table/large_tables.rs).
    pub fn take(&mut self, incidences: &[usize]) -> Result<BrdfTable> {
        let path = self.path.clone();
        self.rows_of(incidences).map_err(|why| Error::format(&path, why))
    }

    fn rows_of(&mut self, incidences: &[usize]) -> Checked<BrdfTable> {
        let whole = incidences.len() == self.outline.height;
        let grid = if whole {
            Some(self.grid().clone())
        } else {
            self.grid().of_incidences(incidences.iter().copied())
        };
        let grid = grid.ok_or("half/difference angles are not read by rows")?;
        let mut part = ImagePart { height: incidences.len(), ..self.outline.clone() };
        image::reserve(&mut part)?;
        let rows = self.blocks.rows(0);
        for wanted in incidences.chunk_by(|a, b| a / rows == b / rows) {
            let block = self.blocks.read(0, wanted[0] / rows)?;
            for (name, row, values) in block.lines() {
                if let (true, Some(samples)) = (wanted.contains(&row), part.channels.get_mut(name)) {
                    samples.extend(values);
                }
            }
        }
        let of = self.outline.height;
        store::filled(BrdfTable { grid, ..self.empty.clone() }, &mut part, &self.names, (incidences, of))
    }
}

/// Ranges of `incidences` that hold `bytes` when an incidence takes `row_bytes`, in multiples of `together`.
pub fn bands(incidences: usize, together: usize, bytes: u64, row_bytes: u64) -> Vec<Range<usize>> {
    let fit = usize::try_from(bytes / row_bytes.max(1)).unwrap_or(usize::MAX);
    let step = (fit / together * together).max(together);
    (0..incidences).step_by(step).map(|first| first..first.saturating_add(step).min(incidences)).collect()
}
