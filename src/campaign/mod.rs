//! The campaign: TOML in, a checked `Campaign` or the list of *all* faults out.

use std::io::Read;
use std::path::Path;

use toml::de::DeTable;

use crate::error::{Error, Fault, Result};
use crate::files::{self, exr_header, memory};
use crate::text_decoding::decode_text;

mod difference;
pub mod key_tables;
pub mod materials;
mod optical_constants;
pub mod parse;
pub mod presets;
mod runs;
pub mod schema;
mod to_toml;

pub use difference::{KeyDifference, differences};
pub use presets::Preset;
pub use runs::{CampaignRun, CampaignRuns, read_runs};
pub use schema::*;
pub use to_toml::{to_toml, uncertainty_to_toml};

pub(crate) use parse::faults::quoted;

use parse::campaign::CampaignFile;
use parse::faults::Report;
use parse::lists::run_lists::RunLists;
use parse::reader::TableReader;

/// Largest campaign file, bytes: two axes of 100,000 angles with room to spare.
const LARGEST_FILE: u64 = 16 << 20;
/// Commas, points, equals signs and brackets of a campaign at most.
const MOST_MARKS: usize = 1 << 21;

/// A campaign file that can be run.
#[derive(Debug, Clone, PartialEq)]
pub struct Parsed {
    /// What the file says, checked and with its defaults.
    pub campaign: Campaign,
    /// Warnings for stderr, one line each, in the shape of a fault: the file can be run, but the user should know.
    pub notes: Vec<String>,
    /// The instrument that the arms are taken from, where a `[preset]` names one; the campaign holds those arms.
    pub preset: Option<Preset>,
    /// `[uncertainty]`, which a budget is made of; what is measured does not depend on it.
    pub uncertainty: Option<Uncertainty>,
}

impl Parsed {
    /// What the instrument is known to; the error says what to add to the campaign in `file`.
    pub fn required_uncertainty(&self, file: &str) -> Result<&Uncertainty> {
        self.uncertainty.as_ref().ok_or_else(|| {
            Error::Usage(format!(
                "{file}: uncertainty: required; say what the instrument is known to, such as [uncertainty] with \
                 reading = {{ u = 0.002 }}"
            ))
        })
    }
}

/// Reads the campaign file at `path`, or stdin for `-`; height maps it names are looked for in its folder, or the current.
///
/// A file that cannot be read is [`Error::Io`], as is one that is no regular file: pipes and devices might never end,
/// or never begin. One that cannot be understood is [`Error::Campaign`] with all its faults.
pub fn read(path: &Path) -> Result<Parsed> {
    let folder = path.parent().unwrap_or(Path::new(""));
    parse(read_bytes(path)?, &name_for_messages(path), folder)
}

fn name_for_messages(path: &Path) -> String {
    if path == Path::new(files::STANDARD) { "stdin".into() } else { path.display().to_string() }
}

/// The bytes of a campaign file.
fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // One byte more than allowed is enough to know.
    files::open_within(path, LARGEST_FILE)?
        .take(LARGEST_FILE + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| Error::io(path, e))?;
    memory::check_file(path, needed(&bytes))?;
    Ok(bytes)
}

/// Bytes of memory that a text may come to take: measured, 105 a mark (lists of lists) to 790 (tables of one key).
// Tested by the rows `little memory` of `tests/process/bad_inputs/commands.rs`.
fn needed(bytes: &[u8]) -> u64 {
    4 * bytes.len() as u64 + 800 * marks(bytes) as u64
}

/// What keys and values of a text are made with: as many as it has, or more.
fn marks(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| matches!(byte, b',' | b'=' | b'.' | b'[' | b'{')).count()
}

/// Reads a campaign from its text, in UTF-8 or, with a byte order mark, UTF-16.
///
/// - `name_for_messages`: the file in faults and notes.
/// - `folder`: where the height maps it names are looked for.
///
/// Every fault of the text is in the [`Error::Campaign`], in the order of the text; those of keys in tables that
/// are not there come last, without a line. Nothing is opened.
///
/// ```
/// use gonio::campaign;
///
/// let text = "name = \"a\"\n[surface.ggx]\nalpha = 3000\n[light]\ntheta_i_deg = [0]\n[sensor.hemisphere]\n";
/// let faults = campaign::parse(text, "a.toml", ".".as_ref()).unwrap_err().to_string();
/// assert!(faults.contains("surface.ggx.alpha = 3000"), "{faults}");
/// ```
pub fn parse(text: impl AsRef<[u8]>, name_for_messages: &str, folder: &Path) -> Result<Parsed> {
    parse_with(text.as_ref(), name_for_messages, folder, &RunLists::refused())
}

fn parse_with(bytes: &[u8], name_for_messages: &str, folder: &Path, lists: &RunLists) -> Result<Parsed> {
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(whole_file_fault(
            name_for_messages,
            None,
            "larger than 16 MiB; this is no campaign".into(),
        ));
    }
    let marks = marks(bytes);
    if marks > MOST_MARKS {
        let why = format!("{marks} keys and values, at most {MOST_MARKS} are read; this is no campaign");
        return Err(whole_file_fault(name_for_messages, None, why));
    }
    // Without the mark, so that the first line's columns count from the first key.
    let text = &*decode_text(bytes).map_err(|why| no_text(name_for_messages, bytes, why))?;
    let report = Report::new(name_for_messages, text);
    let campaign = match DeTable::parse(text) {
        Ok(root) => parse::campaign::campaign(TableReader::root(&report, root.get_ref()), folder, lists),
        Err(error) => {
            syntax_fault(&report, text, &error);
            None
        }
    };
    if let Some(file) = &campaign {
        parse::warnings::note(&report, &file.campaign);
    }
    let (faults, notes) = report.into_parts();
    match campaign {
        Some(file) if faults.is_empty() => {
            let CampaignFile { campaign, preset, uncertainty } = file;
            Ok(Parsed { campaign, notes, preset, uncertainty })
        }
        None if faults.is_empty() => Err(Error::Internal("a campaign was refused without a fault".into())),
        _ => Err(Error::Campaign(faults)),
    }
}

/// A fault of the text before it is TOML, at the key that its line seems to set.
fn syntax_fault(report: &Report<'_>, text: &str, error: &toml::de::Error) {
    let said = quoted(error.message());
    let advice = if said.starts_with("duplicate") {
        "each key and each table once"
    } else {
        "numbers are written 0.5 or 1e-3, strings \"in quotes\", lists [1, 2]"
    };
    let at = error.span().map(|span| span.start.min(text.len()));
    let (key, value) = at.and_then(|at| assignment_at(text, at)).unzip();
    let key = key.unwrap_or_else(|| "TOML".into());
    report.fault(&key, at, value, format!("{said}; {advice}"));
}

/// Key and value of the line of byte `at`, where it looks like `key = value`. A guess for messages only: the text
/// is not TOML.
fn assignment_at(text: &str, at: usize) -> Option<(String, String)> {
    let mut heading = "";
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        if start + line.len() > at || start + line.len() == text.len() {
            let (key, value) = line.split_once('=').map(|(key, value)| (key.trim(), value.trim()))?;
            let separator = if heading.is_empty() { "" } else { "." };
            let named = is_bare_key(key).then(|| format!("{heading}{separator}{key}"))?;
            return Some((named, quoted(value)));
        }
        let inner = line.trim().strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        heading = inner.filter(|inner| is_bare_key(inner)).unwrap_or(heading);
        start += line.len();
    }
    None
}

fn is_bare_key(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.'))
}

/// The fault of bytes that are no text, at the line of the first that is not UTF-8.
fn no_text(name: &str, bytes: &[u8], why: String) -> Error {
    if bytes.starts_with(&exr_header::MAGIC) {
        let why = "an EXR file, as tables are; a campaign, a TOML file, is needed";
        return whole_file_fault(name, None, why.into());
    }
    let good = std::str::from_utf8(bytes).map_or_else(|e| e.valid_up_to(), str::len);
    let line = bytes[..good].iter().filter(|b| **b == b'\n').count() + 1;
    whole_file_fault(name, Some(line), why)
}

fn whole_file_fault(name: &str, line: Option<usize>, allowed: String) -> Error {
    let path = name.to_string();
    let key = "file".into();
    Error::Campaign(vec![Fault { path, line, column: None, key, value: None, allowed, too_large: false }])
}
