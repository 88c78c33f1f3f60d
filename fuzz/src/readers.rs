//! What every target asks of a reader: an answer or a reason, never a panic; a reason is one line for a terminal. What is read
//! as a campaign or a table must come back from its own text or bytes.
//!
//! The program's tests are built with this file too (`tests/it/fuzzed.rs`), so that it knows the readers of today.

use std::path::Path;
use std::sync::{LazyLock, Mutex};

use gonio::campaign::{self, Campaign};
use gonio::error::{ContentError, Error, is_unseen};
use gonio::files::sealed;
use gonio::interchange::{self, Format, Options, merl, utia};
use gonio::measure::persist::header::KIND;
use gonio::measure::{self, Plan, StoredRun};
use gonio::surface::io::map_file;
use gonio::table::{realisations, store};
use tempfile::TempDir;

use super::{scans, traced};

/// Memory that a map may take here, bytes.
const MOST_OF_A_MAP: u64 = 1 << 29;
/// The one size of a MERL file, bytes.
const MERL: usize = 12 + 3 * 8 * 90 * 90 * 180;
/// The one size of a `.bin` of UTIA, bytes.
const UTIA: usize = 3 * 8 * 288 * 288;

/// The campaign whose checkpoints are read.
pub static CHECKPOINTED: LazyLock<(Campaign, Plan)> = LazyLock::new(|| {
    let text = include_str!("../../tests/data/checkpoint.toml");
    let campaign = campaign::parse(text, "small.toml", Path::new("")).expect("sound").campaign;
    let plan = measure::plan(&campaign).expect("small");
    (campaign, plan)
});

/// Where the file lies that a campaign names; one for all, a folder for each input would take most of the time.
static FOLDER: LazyLock<Mutex<TempDir>> =
    LazyLock::new(|| Mutex::new(tempfile::tempdir().expect("a folder")));

/// Reads what an input of `target` stands for.
pub fn read(target: &str, bytes: &[u8]) {
    match target {
        "campaign" => campaign(bytes),
        "checkpoint" => checkpoint(bytes),
        "table" => table(bytes),
        "realisations" => drop(answered(realisations::decode(path(), bytes))),
        "index_file" => index_file(bytes),
        "height_map" => map(bytes),
        "map_gsf" => map(&[b"Gwyddion Simple Field 1.0\n", bytes].concat()),
        "map_xyz" => map(&[b"0 0 0\n", bytes].concat()),
        name if name.starts_with("map_") => map(&scans::file(target, bytes)),
        "maps" => parameter_maps(bytes),
        "traced_map" => traced::trace(bytes),
        "merl" => half_difference(bytes),
        "utia" => tables_of_utia(bytes),
        format => {
            let format: Format = format.parse().expect("a target");
            reason(interchange::decode(format, &Options::default(), bytes));
        }
    }
}

/// A reader's reason, as the program shows it.
fn reason<T>(answer: Result<T, impl Into<ContentError>>) {
    answered(answer.map_err(|why| Error::format(path(), why)));
}

/// A verb's error about the file at hand: that of a wrong content, or of too little memory for it.
fn answered<T>(answer: Result<T, Error>) -> Option<T> {
    match answer {
        Ok(value) => Some(value),
        Err(Error::Format { what, .. } | Error::Refused(what)) => {
            line(&what);
            None
        }
        Err(other) => panic!("not an error of the file: {other}"),
    }
}

fn line(why: &str) {
    assert!(!why.is_empty() && !why.contains(is_unseen) && why.chars().count() <= 500, "{why:?}");
}

/// The path that messages name.
fn path() -> &'static Path {
    Path::new("fuzzed")
}

/// What is accepted is written as TOML and read as the same campaign.
fn campaign(bytes: &[u8]) {
    let parse = |text: &[u8]| campaign::parse(text, "c.toml", Path::new("no_such_folder"));
    match parse(bytes) {
        Ok(parsed) => {
            let again = parse(campaign::to_toml(&parsed.campaign).as_bytes()).expect("its own text");
            assert!(again.campaign == parsed.campaign);
        }
        Err(Error::Campaign(faults)) => {
            assert!(!faults.is_empty());
            faults.iter().for_each(|fault| line(&fault.to_string()));
        }
        Err(other) => panic!("{other}"),
    }
}

/// What is read is written again and read as the same.
fn table(bytes: &[u8]) {
    let Some(loaded) = answered(store::decode(path(), bytes)) else { return };
    let Ok(again) = store::encode(&loaded.table) else { return };
    assert!(store::decode(path(), &again).expect("its own bytes").table == loaded.table);
}

/// What checkpoints, shards and finished bands hold behind their checksum, for a small campaign to resume.
fn checkpoint(bytes: &[u8]) {
    let (campaign, plan) = &*CHECKPOINTED;
    let sealed = sealed::seal(KIND, bytes.len(), |head| Ok::<_, String>([&head, bytes].concat()));
    reason(sealed.and_then(|sealed| StoredRun::from_bytes(&sealed)).and_then(|kept| {
        kept.header
            .faults((campaign, None), "small.toml", "out")
            .iter()
            .for_each(|fault| line(&fault.to_string()));
        kept.run_state(campaign, plan).map(drop)
    }));
}

/// A file of (n, k) over wavelengths, which a campaign names.
fn index_file(bytes: &[u8]) {
    let folder = FOLDER.lock().expect("no reader has panicked");
    let file = folder.path().join("index.csv");
    // ext4 flushes a file that was cut to nothing and written again.
    std::fs::remove_file(&file).ok();
    std::fs::write(&file, bytes).expect("written");
    match campaign::parse(include_str!("index_file.toml"), "c.toml", folder.path()) {
        Ok(_) => {}
        Err(Error::Campaign(faults)) => {
            assert!(faults.iter().all(|fault| fault.key.starts_with("optics.")), "{faults:?}");
            faults.iter().for_each(|fault| line(&fault.to_string()));
        }
        Err(other) => panic!("{other}"),
    }
}

/// A height map; what the program would refuse for want of memory is not read.
fn map(bytes: &[u8]) {
    match map_file::needed(bytes) {
        Ok(needed) if needed > MOST_OF_A_MAP => {}
        Ok(_) => reason(map_file::read(bytes)),
        Err(why) => reason(Err::<(), _>(why)),
    }
}

/// Two EXR images, and the campaign of a texel. The first two bytes say where the second image begins.
fn parameter_maps(bytes: &[u8]) {
    let [a, b, rest @ ..] = bytes else { return };
    let (alpha, f0) = rest.split_at(usize::from(u16::from_le_bytes([*a, *b])).min(rest.len()));
    let found = interchange::maps::read(alpha, f0);
    if let Ok(maps) = &found {
        reason(maps.campaign(0, 0));
    }
    reason(found);
}

/// A MERL file as it is. Filled to its size it takes a thousand times as long: one input in 128.
fn half_difference(bytes: &[u8]) {
    reason(merl::read(bytes, merl::Sampling::Node));
    if bytes.len() > 12 && bytes.len() % 128 == 20 {
        let head = [90u32, 90, 180].map(u32::to_le_bytes).concat();
        let whole = [head, filled(bytes, MERL - 12)].concat();
        reason(merl::read(&whole, merl::Sampling::Centre));
    }
}

/// A file of UTIA or its image form: as it is, and filled to the size of a `.bin`.
fn tables_of_utia(bytes: &[u8]) {
    reason(utia::read(bytes));
    if bytes.len() > 8 && bytes.len() % 8 == 3 {
        reason(utia::read(&filled(bytes, UTIA)));
    }
}

/// A file of `length` bytes that begins as `bytes` do and goes on with them over and over: for formats of one size.
fn filled(bytes: &[u8], length: usize) -> Vec<u8> {
    bytes.iter().copied().cycle().take(length).collect()
}
