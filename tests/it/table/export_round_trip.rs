//! Promise: what is written comes back, the same from every run, and damaged files are errors, never panics.

use std::path::Path;
use std::sync::Once;
use std::sync::atomic::{AtomicUsize, Ordering};

use gonio::error::Error;
use gonio::files::image::{self, Attribute, ImagePart, Samples};
use gonio::files::sha256_hex;
use gonio::instrument::{Grid, GridKind};
use gonio::table::{
    BrdfTable, ColourChannels, RealisationPart, Realisations, SchlickSums, TableRows, realisations, store,
};

use crate::support::alone::{alone, path_of};
use crate::support::long::or_long;
use crate::support::mutations::Bits;

fn grid() -> Grid {
    Grid {
        kind: GridKind::Hemisphere,
        // Two blocks of 16 rows.
        theta_i_deg: (0..6).map(|i| f64::from(i) * 90.0 / 7.0).collect(),
        phi_i_deg: (0..3).map(|i| f64::from(i) * 100.0 / 3.0).collect(),
        phi_r_relative: false,
        theta_r_edges_deg: (0..=3).map(|i| f64::from(i) / 3.0 * 90.0).collect(),
        phi_r_edges_deg: (0..=7).map(|i| f64::from(i) / 7.0 * 360.0 - 0.1).collect(),
        ..Grid::default()
    }
}

fn table(colours: usize) -> BrdfTable {
    let grid = grid();
    let pixels = grid.incidences() * grid.bins();
    let mut bits = Bits(7);
    let mut channel = || (0..pixels).map(|_| bits.unit() * 40.0).collect::<Vec<f32>>();
    let colours = (0..colours)
        .map(|k| ColourChannels {
            total: channel(),
            single: channel(),
            multiple: channel(),
            stderr: channel(),
            stderr_single: vec![-1.0; pixels],
            albedo_se: channel()[..grid.incidences()].to_vec(),
            // Orders 2 and 3 by themselves; colours beyond R, G, B are told by their wavelengths.
            orders: vec![channel(), channel()],
            mueller: (0..16).map(|_| channel()).collect(),
            stderr_mueller: (0..16).map(|_| channel()).collect(),
            left_map: channel(),
            wavelength_nm: (colours > 3).then_some(400.0 + 12.5 * k as f64),
        })
        .collect();
    let further = vec![vec![channel(), channel(), channel()], vec![channel(), channel()]];
    let schlick = Some(SchlickSums { unit: channel(), first: channel(), further });
    BrdfTable {
        grid,
        campaign: "name = \"gold\"\nseed = 1 # µ\n".into(),
        version: "0.1.0".into(),
        seed: u64::MAX - 1,
        patch_digest: "0f".repeat(32),
        colours,
        hits: (0..pixels as u32).map(|i| u32::MAX - i).collect(),
        schlick,
    }
}

fn here() -> &'static Path {
    Path::new("table.exr")
}

#[test]
fn tables_of_one_and_three_colours_round_trip_exactly() {
    let folder = tempfile::tempdir().expect("temporary folder");
    for colours in [1, 3, 5] {
        for schlick in [true, false] {
            let mut table = table(colours);
            table.schlick = table.schlick.filter(|_| schlick);
            let path = folder.path().join("gold table.exr");
            store::save(&path, &table).expect("saves");
            let loaded = store::load(&path).expect("loads");
            assert_eq!(loaded.warnings, Vec::<String>::new());
            assert!(loaded.table == table, "{colours} colours come back changed");
        }
    }
}

#[test]
fn a_failed_save_leaves_no_file_behind() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join("table.exr");
    std::fs::create_dir(&path).expect("folder");
    assert!(matches!(store::save(&path, &table(1)), Err(Error::Io { .. })));
    assert_eq!(std::fs::read_dir(folder.path()).expect("readable").count(), 1);
}

/// The part of an encoded table, to be changed behind the digest's back.
fn opened(table: &BrdfTable) -> ImagePart {
    image::decode(&store::encode(table).expect("encodes")).expect("decodes").remove(0)
}

fn refusal(part: ImagePart) -> String {
    let bytes = image::encode(vec![part]).expect("encodes");
    match store::decode(here(), &bytes).expect_err("must be refused") {
        Error::Format { what, .. } => what,
        other => panic!("not a format error: {other}"),
    }
}

#[test]
fn a_changed_value_grid_or_patch_digest_is_noticed() {
    let table = table(3);
    for channel in ["R", "single.G", "multiple.B", "stderr.R", "stderr.single.G", "schlick"] {
        let mut part = opened(&table);
        match part.channels.get_mut(channel) {
            Some(Samples::F32(values)) => values[40] = f32::from_bits(values[40].to_bits() ^ 1),
            other => panic!("`{channel}` is {other:?}"),
        }
        assert!(refusal(part).contains("gonio.digest"), "{channel}");
    }
    let mut part = opened(&table);
    let grid = part.text("gonio.grid").expect("is there").replacen("90.0", "89.0", 1);
    part.set_text("gonio.grid", &grid);
    assert!(refusal(part).contains("gonio.digest"));
    let mut part = opened(&table);
    part.attributes.remove("gonio.patch_digest");
    assert!(refusal(part).contains("gonio.digest"));
}

/// Every text of a part with one bit turned over, at its head, middle and end.
fn with_a_bit_flipped(part: &ImagePart) -> Vec<(String, ImagePart)> {
    let mut all = Vec::new();
    for name in part.attributes.keys().filter(|name| name.starts_with("gonio.")) {
        let text = part.text(name).expect("a text");
        for at in [0, text.len() / 2, text.len() - 1] {
            let mut bytes = text.as_bytes().to_vec();
            bytes[at] ^= 1;
            let mut other = part.clone();
            // A letter outside ASCII may fall apart: then it is replaced.
            other.set_text(name, &String::from_utf8_lossy(&bytes));
            all.push((format!("{name}, byte {at}"), other));
        }
    }
    all
}

#[test]
fn one_flipped_bit_in_any_text_of_a_table_is_an_error() {
    // One colour: its texts are those of three.
    let part = opened(&table(1));
    let flipped = with_a_bit_flipped(&part);
    let names = [
        "albedo_se",
        "campaign",
        "convention",
        "digest",
        "grid",
        "mueller",
        "patch_digest",
        "seed",
        "version",
    ];
    assert_eq!(flipped.len(), 3 * names.len());
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join("table.exr");
    for (what, part) in flipped {
        std::fs::write(&path, image::encode(vec![part.clone()]).expect("encodes")).expect("written");
        let by_rows = TableRows::open(&path).and_then(|mut rows| rows.verify());
        assert!(by_rows.is_err(), "{what} by rows");
        assert!(refusal(part).contains("gonio."), "{what}");
    }
}

#[test]
fn one_flipped_bit_in_any_text_of_realisations_is_an_error() {
    let table = table(1);
    let values = vec![table.colours[0].total.clone()];
    let part = RealisationPart { total: values.clone(), single: values, schlick: None };
    let whole = realisations::encode(&Realisations { parts: vec![part] }, &table, 3).expect("encodes");
    let part = image::decode(&whole).expect("decodes").remove(0);
    let flipped = with_a_bit_flipped(&part);
    assert_eq!(flipped.len(), 3 * ["digest", "grid", "group_size", "table_digest"].len());
    for (what, part) in flipped {
        let bytes = image::encode(vec![part]).expect("encodes");
        assert!(realisations::decode(here(), &bytes).is_err(), "{what}");
    }
}

/// The digest before the texts went in: "gonio digest 2", grid and patches, then a line for each channel.
#[test]
fn a_table_whose_digest_left_the_campaign_out_is_named_as_old() {
    let mut part = opened(&table(1));
    let (grid, patches) =
        (part.text("gonio.grid").expect("set"), part.text("gonio.patch_digest").expect("set"));
    let mut all = format!("gonio digest 2\n{grid}\n{patches}\n");
    for (name, samples) in &part.channels {
        let (kind, bytes): (_, Vec<u8>) = match samples {
            Samples::F32(values) => ("FLOAT", values.iter().flat_map(|v| v.to_le_bytes()).collect()),
            Samples::U32(values) => ("UINT", values.iter().flat_map(|v| v.to_le_bytes()).collect()),
            Samples::F16(_) => panic!("no table has HALF"),
        };
        all += &format!("{name} {kind} {} {}\n", bytes.len() / 4, sha256_hex(&bytes));
    }
    part.set_text("gonio.digest", &sha256_hex(all.as_bytes()));
    let why = refusal(part);
    assert!(why.contains("older version") && why.contains("measure it again"), "{why}");
}

#[test]
fn a_missing_digest_is_a_warning() {
    let table = table(1);
    let mut part = opened(&table);
    part.attributes.remove("gonio.digest");
    let bytes = image::encode(vec![part]).expect("encodes");
    let loaded = store::decode(here(), &bytes).expect("readable");
    assert!(loaded.table == table);
    assert!(loaded.warnings.len() == 1 && loaded.warnings[0].contains("gonio.digest"));
}

#[test]
fn equal_tables_have_equal_bytes_whatever_the_hash_seed() {
    // Every map of the encoder is hashed with a key of its own, and every thread starts from another.
    let first = store::encode(&table(3)).expect("encodes");
    let threads: Vec<_> = (0..8)
        .map(|_| {
            std::thread::spawn(|| {
                (0..8).map(|_| store::encode(&table(3)).expect("encodes")).collect::<Vec<_>>()
            })
        })
        .collect();
    for thread in threads {
        for bytes in thread.join().expect("thread ran") {
            assert!(bytes == first);
        }
    }
}

const CHILD_OUTPUT: &str = "GONIO_TEST_CHILD_OUTPUT";

#[test]
#[ignore = "run by `fresh_processes_write_the_same_bytes` in processes of its own"]
fn child_writes_a_table() {
    if let Some(path) = std::env::var_os(CHILD_OUTPUT) {
        store::save(Path::new(&path), &table(1)).expect("saves");
    }
}

#[test]
fn fresh_processes_write_the_same_bytes() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let here = store::encode(&table(1)).expect("encodes");
    for k in 0..6 {
        let path = folder.path().join(format!("{k}.exr"));
        let run = std::process::Command::new(std::env::current_exe().expect("test program"))
            .args(["--ignored", "--exact", &path_of(module_path!(), "child_writes_a_table")])
            .env(CHILD_OUTPUT, &path)
            .output()
            .expect("child runs");
        assert!(run.status.success());
        assert!(std::fs::read(&path).expect("child wrote") == here);
    }
}

/// Peak resident memory of this process, bytes.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().strip_suffix(" kB"))
        .and_then(|kb| kb.trim().parse::<u64>().ok())
        .unwrap_or(0)
        * 1024
}

/// Panics inside the image codec, which the reader would turn into errors.
static CODEC_PANICS: AtomicUsize = AtomicUsize::new(0);
static COUNT_PANICS: Once = Once::new();

fn count_codec_panics() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if info.location().is_some_and(|place| !place.file().contains("export_round_trip")) {
            CODEC_PANICS.fetch_add(1, Ordering::SeqCst);
        }
        usual(info);
    }));
}

/// Runs `read` on truncations and on `rounds` mutations of `bytes`; looks at the memory and the panics of the process.
fn damage(bytes: &[u8], rounds: usize, seed: u64, read: impl Fn(&[u8], bool)) {
    COUNT_PANICS.call_once(count_codec_panics);
    let before = peak_memory();
    let step = (bytes.len() / 700).max(1);
    for length in (0..bytes.len().min(600)).chain((600..bytes.len()).step_by(step)) {
        read(&bytes[..length], true);
    }
    let mut bits = Bits(seed);
    let head = bytes.len().min(3000);
    for round in 0..rounds {
        let mut damaged = bytes.to_vec();
        for _ in 0..1 + bits.below(3) {
            // Headers are where lengths are: half of all changes go there.
            let at = if round % 2 == 0 { bits.below(head) } else { bits.below(bytes.len()) };
            damaged[at] = match bits.below(4) {
                0 => 0xff,
                1 => 0,
                2 => damaged[at] ^ (1 << bits.below(8)),
                _ => bits.below(256) as u8,
            };
        }
        read(&damaged, false);
    }
    let growth = peak_memory().saturating_sub(before);
    assert!(growth < 256 << 20, "memory grew by {growth} bytes");
    assert_eq!(CODEC_PANICS.load(Ordering::SeqCst), 0, "the codec panicked; see the messages above");
}

fn format_error<T>(result: Result<T, Error>) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(Error::Format { what, .. }) if !what.is_empty() => None,
        Err(other) => panic!("not a format error: {other}"),
    }
}

#[test]
fn damaged_tables_are_errors_and_never_panic() {
    alone(module_path!(), "damaged_tables_are_errors_and_never_panic", || {
        let table = table(1);
        let bytes = store::encode(&table).expect("encodes");
        damage(&bytes, or_long(1_500, 4_000), 11, |bytes, cut| {
            let Some(loaded) = format_error(store::decode(here(), bytes)) else { return };
            assert!(!cut, "a file cut at {} bytes was read", bytes.len());
            let checked = !loaded.warnings.iter().any(|warning| warning.contains("gonio.digest"));
            let same = loaded.table.colours == table.colours
                && loaded.table.hits == table.hits
                && loaded.table.grid == table.grid;
            assert!(same || !checked, "damage went unnoticed");
        });
    });
}

#[test]
fn damaged_realisations_are_errors_and_never_panic() {
    alone(module_path!(), "damaged_realisations_are_errors_and_never_panic", || {
        let table = table(1);
        let part = |k: usize| RealisationPart {
            total: vec![table.colours[0].total.iter().map(|v| v + k as f32).collect()],
            single: vec![table.colours[0].single.clone()],
            schlick: table.schlick.clone(),
        };
        let parts = Realisations { parts: (0..3).map(part).collect() };
        let bytes = realisations::encode(&parts, &table, 1).expect("encodes");
        damage(&bytes, or_long(1_000, 2_000), 12, |bytes, cut| {
            assert!(format_error(realisations::decode(here(), bytes)).is_none() || !cut);
        });
    });
}

#[test]
fn damaged_images_with_other_compressions_never_panic() {
    alone(module_path!(), "damaged_images_with_other_compressions_never_panic", || {
        // The attribute `compression` is one byte; every method is tried on pixels that were made for another.
        let mut part = ImagePart { width: 40, height: 70, ..ImagePart::default() };
        let mut bits = Bits(3);
        part.channels
            .insert("height".into(), Samples::F32((0..2800).map(|i| (i as f32 * 0.01).sin()).collect()));
        part.channels.insert("mask".into(), Samples::U32((0..2800).map(|_| bits.below(5) as u32).collect()));
        part.attributes.insert("pitch_x".into(), Attribute::Number(0.5));
        let bytes = image::encode(vec![part]).expect("encodes");
        let name = b"compression\0compression\0";
        let at = bytes.windows(name.len()).position(|w| w == name).expect("is there") + name.len() + 4;
        for method in 0..=12 {
            let mut bytes = bytes.clone();
            bytes[at] = method;
            damage(&bytes, 300, 20 + u64::from(method), |bytes, _| {
                if let Err(why) = image::decode(bytes) {
                    assert!(!why.to_string().is_empty());
                }
            });
        }
    });
}
