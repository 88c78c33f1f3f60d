//! The members of an NPZ archive: arrays by name, checked before room is made for them.

use std::io::{self, Cursor, ErrorKind, Read, Seek};

use zip::ZipArchive;

use crate::error::{ContentError, wrong};
use crate::files::memory;
use crate::files::npy::{self, Array, NpyValues};
use crate::instrument::Grid;
use crate::interchange::Checked;

/// Deflate shrinks at most 1032-fold.
const MAX_RATIO: u64 = 1032;
/// More members than any table has.
const MOST_MEMBERS: usize = 128;
/// What each entry of an archive's directory begins with.
const ENTRY: &[u8] = b"PK\x01\x02";
/// Beginnings of entries that chance may put into the data besides.
const MOST_ENTRIES: usize = 1 << 12;
/// Copies of its largest array that a table takes besides all arrays: what the table adds to it, and conversions.
const COPIES: u64 = 8;
/// The array that names the colours of a spectral table.
pub const WAVELENGTHS: &str = "wavelength_nm";

/// What the system fails in has a number of the system's, or is a lack of memory; all else is the file's fault: data that do
/// not unpack, another checksum than the archive says, a kind of block that is not known.
fn damaged(error: io::Error) -> ContentError {
    match (error.raw_os_error(), error.kind()) {
        (Some(_), _) | (None, ErrorKind::OutOfMemory) => error.into(),
        (None, _) => wrong!("damaged data: {error}"),
    }
}

/// An archive while it is read.
pub struct Members<R> {
    zip: ZipArchive<R>,
    /// No member can hold more.
    limit: u64,
}

impl<R: Read + Seek> Members<R> {
    /// Of so many bytes.
    pub fn open(file: R, length: u64) -> Checked<Self> {
        if length == 0 {
            return Err("the file is empty".into());
        }
        let zip = ZipArchive::new(file).map_err(|e| format!("not an NPZ archive: {e}"))?;
        if zip.len() > MOST_MEMBERS {
            return Err(wrong!("{} members; a table has at most {MOST_MEMBERS}", zip.len()));
        }
        Ok(Members { zip, limit: MAX_RATIO.saturating_mul(length) })
    }

    /// An array, if it is there.
    pub fn array(&mut self, name: &str) -> Checked<Option<Array>> {
        let file = format!("{name}.npy");
        match self.zip.index_for_name(&file) {
            Some(index) => self.read(index).map(Some).map_err(|why| why.at(format_args!("array `{name}`"))),
            None => Ok(None),
        }
    }

    fn read(&mut self, index: usize) -> Checked<Array> {
        let mut member = self.zip.by_index(index).map_err(|e| e.to_string())?;
        let size = member.size();
        if size > self.limit {
            return Err(wrong!("claims {size} bytes, more than the file can hold"));
        }
        let mut head = Vec::new();
        member.by_ref().take(npy::LONGEST_HEAD as u64).read_to_end(&mut head).map_err(damaged)?;
        npy::check_length(&head, size)?;
        let mut bytes = memory::room(usize::try_from(size).unwrap_or(usize::MAX))?;
        bytes.append(&mut head);
        // What the archive says is not believed beyond what the data give.
        let rest = (size + 1).saturating_sub(bytes.len() as u64);
        member.by_ref().take(rest).read_to_end(&mut bytes).map_err(damaged)?;
        Ok(npy::decode(&bytes)?)
    }

    /// Bytes that a table of all arrays takes, by what the archive says of their sizes.
    fn bytes(&mut self) -> Checked<u64> {
        let (mut all, mut largest) = (0u64, 0u64);
        for index in 0..self.zip.len() {
            let size = self.zip.by_index_raw(index).map_err(|e| e.to_string())?.size();
            (all, largest) = (all.saturating_add(size), largest.max(size));
        }
        Ok(all.saturating_add(COPIES.saturating_mul(largest)))
    }

    /// An array that must be there.
    pub fn need(&mut self, name: &str) -> Checked<Array> {
        self.array(name)?.ok_or_else(|| wrong!("no array `{name}`"))
    }

    /// The angles of an axis; none where the array is not there.
    pub fn axis(&mut self, name: &str) -> Checked<Vec<f64>> {
        let Some(array) = self.array(name)? else { return Ok(vec![]) };
        match array.values {
            NpyValues::F64(values) => Ok(values),
            NpyValues::F32(values) => Ok(values.into_iter().map(f64::from).collect()),
            _ => Err(wrong!("array `{name}`: floats needed")),
        }
    }

    /// A text; empty where the array is not there.
    pub fn text(&mut self, name: &str) -> Checked<String> {
        let Some(array) = self.array(name)? else { return Ok(String::new()) };
        match array.values {
            NpyValues::Text(texts) => match <[String; 1]>::try_from(texts) {
                Ok([text]) => Ok(text),
                Err(texts) => Err(wrong!("array `{name}`: {} texts, one needed", texts.len())),
            },
            NpyValues::U8(bytes) => {
                String::from_utf8(bytes).map_err(|_| wrong!("array `{name}`: bytes that are not UTF-8"))
            }
            _ => Err(wrong!("array `{name}`: a text (str) needed")),
        }
    }

    /// The geometry: `grid`, or the axes.
    pub fn grid(&mut self) -> Checked<Grid> {
        let text = self.text("grid")?;
        if !text.is_empty() {
            return serde_json::from_str(&text).map_err(|e| wrong!("array `grid`: {e}"));
        }
        let mut grid = Grid {
            theta_i_deg: self.axis("theta_i_deg")?,
            phi_i_deg: self.axis("phi_i_deg")?,
            theta_r_edges_deg: self.axis("theta_r_edges_deg")?,
            phi_r_edges_deg: self.axis("phi_r_edges_deg")?,
            ..Grid::default()
        };
        grid.phi_r_relative = match self.array("phi_r_relative")?.map(|array| array.values) {
            Some(NpyValues::U8(values)) => values.first() == Some(&1),
            Some(_) => return Err("array `phi_r_relative`: u1 or bool needed".into()),
            // An azimuth that is not there tells nothing apart; a single one is where the light stood.
            None => grid.phi_i_deg.is_empty(),
        };
        if grid.phi_i_deg.is_empty() {
            grid.phi_i_deg = vec![0.0];
        }
        Ok(grid)
    }

    /// The wavelengths of so many colours; none for Y and R, G, B.
    pub fn wavelengths(&mut self, colours: usize) -> Checked<Vec<f64>> {
        let nm = self.axis(WAVELENGTHS)?;
        let sound =
            nm.iter().all(|nm| *nm > 0.0 && nm.is_finite()) && nm.windows(2).all(|pair| pair[0] < pair[1]);
        if !nm.is_empty() && (!sound || nm.len() != colours) {
            return Err(wrong!("array `{WAVELENGTHS}`: {colours} increasing positive numbers needed"));
        }
        Ok(nm)
    }

    /// A channel with one value per pixel and colour; of f8 arrays the nearest f4.
    pub fn channel(&mut self, name: &str, shape: &[usize]) -> Checked<Option<Vec<f32>>> {
        let Some(array) = self.array(name)? else { return Ok(None) };
        if array.shape != shape {
            return Err(wrong!("array `{name}` has shape {:?}, the axes make {shape:?}", array.shape));
        }
        let values = match array.values {
            NpyValues::F32(values) => values,
            NpyValues::F64(values) => values.into_iter().map(|v| v as f32).collect(),
            _ => return Err(wrong!("array `{name}`: f4 or f8 needed")),
        };
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(wrong!("array `{name}`, value {at}: {} is not a finite number", values[at])),
            None => Ok(Some(values)),
        }
    }
}

/// Bytes that the table of an archive takes in memory, by what the archive says; nothing is unpacked.
pub fn needed(bytes: &[u8]) -> Checked<u64> {
    // The directory is in memory as a whole, some hundred bytes an entry.
    let entries = bytes.windows(ENTRY.len()).filter(|here| *here == ENTRY).take(MOST_ENTRIES + 1).count();
    if entries > MOST_ENTRIES {
        return Err(wrong!("more than {MOST_ENTRIES} entries; a table has at most {MOST_MEMBERS} members"));
    }
    Members::open(Cursor::new(bytes), bytes.len() as u64)?.bytes()
}
