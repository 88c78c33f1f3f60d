//! An EXR image written row by row: one part, its header completed at the end, never more than some blocks in memory.
//!
//! Input: an outline, then rows. Output: the bytes of [`super::image::encode`] for the same content.

use std::io::{self, Cursor, Seek, SeekFrom, Write};

use exr::block::chunk::Chunk;
use exr::block::{self, BlockIndex, UncompressedBlock};
use exr::meta::Headers;
use exr::prelude::Vec2;
use rayon::prelude::*;

use super::exr_header;
use super::image_part::ImagePart;
use super::image_rows;

/// An unfinished file.
pub struct RowWriter<W> {
    out: W,
    part: ImagePart,
    headers: Headers,
    /// Blocks that wait to be compressed together.
    waiting: Vec<UncompressedBlock>,
    /// Rows of a block that is not full.
    rows: Vec<u8>,
    /// Rows taken so far.
    taken: usize,
    offsets: Vec<u64>,
    position: u64,
}

impl<W: Write + Seek> RowWriter<W> {
    /// Begins a file with the channels and attributes of `part`; its channels name types only.
    pub fn new(mut out: W, part: ImagePart) -> io::Result<Self> {
        let (head, headers) = head(&part).map_err(io::Error::other)?;
        let blocks = headers[0].chunk_count;
        let table = vec![0; 8 * blocks];
        out.write_all(&head).and_then(|()| out.write_all(&table))?;
        let position = (head.len() + table.len()) as u64;
        let (waiting, rows, offsets) = (Vec::new(), Vec::new(), Vec::with_capacity(blocks));
        Ok(RowWriter { out, part, headers, waiting, rows, taken: 0, offsets, position })
    }

    /// Takes the next row: `fill` adds the bytes of a channel, in the machine's order, to what it is given.
    pub fn row(&mut self, mut fill: impl FnMut(&str, &mut Vec<u8>)) -> io::Result<()> {
        let before = self.rows.len();
        self.part.channels.keys().for_each(|name| fill(name, &mut self.rows));
        let wanted = self.headers[0].channels.bytes_per_pixel * self.part.width;
        if self.rows.len() - before != wanted || self.taken == self.part.height {
            return Err(io::Error::other(format!("row {} does not fit the image", self.taken)));
        }
        self.taken += 1;
        let rows_per_block = self.headers[0].compression.scan_lines_per_block();
        if self.taken.is_multiple_of(rows_per_block) || self.taken == self.part.height {
            let first = (self.taken - 1) / rows_per_block * rows_per_block;
            let index = BlockIndex {
                layer: 0,
                pixel_position: Vec2(0, first),
                pixel_size: Vec2(self.part.width, self.taken - first),
                level: Vec2(0, 0),
            };
            let data = std::mem::take(&mut self.rows);
            self.waiting.push(UncompressedBlock { index, data });
        }
        // A block for every thread, small ones by the dozen.
        let bytes: usize = self.waiting.iter().map(|block| block.data.len()).sum();
        let enough = self.waiting.len() >= rayon::current_num_threads() && bytes >= 1 << 20;
        if enough || self.taken == self.part.height { self.compress() } else { Ok(()) }
    }

    fn compress(&mut self) -> io::Result<()> {
        let headers = &self.headers;
        let blocks = std::mem::take(&mut self.waiting);
        let chunks: Result<Vec<Chunk>, _> =
            blocks.into_par_iter().map(|block| block.compress_to_chunk(headers)).collect();
        for chunk in chunks.map_err(io::Error::other)? {
            let mut bytes = Vec::new();
            chunk.write(&mut bytes, 1).map_err(io::Error::other)?;
            self.out.write_all(&bytes)?;
            self.offsets.push(self.position);
            self.position += bytes.len() as u64;
        }
        Ok(())
    }

    /// Completes the header with texts of the lengths that the outline gave them, and hands the file back.
    // Tested by `a_table_written_by_rows_has_the_bytes_of_one_written_at_once` (tests/it/table/large_tables.rs).
    pub fn finish(mut self, completed: &ImagePart) -> io::Result<W> {
        if self.taken != self.part.height {
            let why = format!("{} of {} rows were written", self.taken, self.part.height);
            return Err(io::Error::other(why));
        }
        let begun = head(&self.part).map_err(io::Error::other)?.0.len();
        self.part.attributes.clone_from(&completed.attributes);
        let (mut bytes, _) = head(&self.part).map_err(io::Error::other)?;
        if bytes.len() != begun {
            return Err(io::Error::other(format!(
                "a header of {} bytes has no room in {begun}",
                bytes.len()
            )));
        }
        bytes.extend(self.offsets.iter().flat_map(|offset| offset.to_le_bytes()));
        self.out.rewind()?;
        self.out.write_all(&bytes)?;
        self.out.seek(SeekFrom::Start(self.position))?;
        Ok(self.out)
    }
}

/// The bytes of a part's header, and the header as the codec has it.
fn head(part: &ImagePart) -> Result<(Vec<u8>, Headers), String> {
    let mut out = Cursor::new(Vec::new());
    let mut headers = None;
    // The codec writes headers only at the head of a file; what would follow is called off.
    let stopped =
        block::write(&mut out, image_rows::headers(std::slice::from_ref(part))?, true, |meta, _| {
            headers = Some(meta.headers);
            Err(exr::error::Error::Aborted)
        });
    let Some(headers) = headers else {
        return Err(stopped.err().map_or("no header".into(), |e| e.to_string()));
    };
    let mut bytes = out.into_inner();
    bytes.truncate(exr_header::end(&bytes)?);
    exr_header::sort_attributes(&mut bytes)?;
    Ok((bytes, headers))
}
