//! Tables larger than memory: written by rows and read by rows, with the bytes and the figures of whole ones.

#[path = "common/analytic.rs"]
mod analytic;

use std::io::Cursor;
use std::path::Path;

use analytic::{Ggx, hemisphere, measured_looking, steps};
use gonio::files::image;
use gonio::table::{BrdfTable, TableRows, TableWriter, store};

/// 6 x 8 stops of 3 x 8 bins: three blocks of 16 rows.
fn grid() -> gonio::instrument::Grid {
    hemisphere(steps(15.0, 6), Some(steps(45.0, 8)), 3, 8)
}

fn table() -> BrdfTable {
    measured_looking(&Ggx::new(0.3, 0.5), &grid())
}

/// The stops `first..end` of a table, as a table.
fn band(table: &BrdfTable, first: usize, end: usize) -> BrdfTable {
    let bins = table.grid.bins();
    let part = |values: &[f32]| values[first * bins..end * bins].to_vec();
    let mut band = table.clone();
    band.grid = table.grid.of_stops(first..end).expect("stops");
    band.hits = table.hits[first * bins..end * bins].to_vec();
    for colour in &mut band.colours {
        for channel in [
            &mut colour.total,
            &mut colour.single,
            &mut colour.multiple,
            &mut colour.stderr,
            &mut colour.stderr_single,
        ] {
            *channel = part(channel);
        }
    }
    band
}

#[test]
fn a_table_written_by_rows_has_the_bytes_of_one_written_at_once() {
    let table = table();
    let whole = store::encode(&table).expect("encoded");
    // The general encoder of images, which knows nothing of rows, makes them too.
    assert!(image::encode(image::decode(&whole).expect("decoded")).expect("encoded") == whole);
    for step in [1, 7, 16, 48] {
        let path = Path::new("t.exr");
        let out = Cursor::new(Vec::new());
        let mut writer = TableWriter::new(out, path, &band(&table, 0, step), &table.grid).expect("begun");
        for first in (0..48).step_by(step) {
            writer.append(&band(&table, first, (first + step).min(48))).expect("taken");
        }
        let (bytes, digest) = writer.finish().expect("whole");
        assert!(bytes.into_inner() == whole, "bands of {step}");
        assert_eq!(digest, store::digest(&table).expect("a digest"));
    }
}

#[test]
fn a_table_that_is_not_whole_takes_no_name() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("t.exr");
    let table = table();
    let mut writer = TableWriter::create(&path, &table, &table.grid).expect("begun");
    writer.append(&band(&table, 0, 20)).expect("taken");
    let why = writer.finish().map(drop).expect_err("rows are missing").to_string();
    assert!(why.contains("20 of 48 rows"), "{why}");
    let mut bad = band(&table, 20, 40);
    bad.colours[0].total[30] = f32::NAN;
    let mut writer = TableWriter::create(&path, &table, &table.grid).expect("begun");
    writer.append(&band(&table, 0, 20)).expect("taken");
    let why = writer.append(&bad).expect_err("NaN").to_string();
    assert!(why.contains("channel `Y`, stop 21, bin 6: NaN"), "{why}");
    drop(writer);
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

#[test]
fn bands_of_a_table_are_its_rows() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("t.exr");
    let table = table();
    store::save(&path, &table).expect("saved");
    let mut rows = TableRows::open(&path).expect("opened");
    rows.verify().expect("sound");
    assert_eq!((rows.grid(), rows.bytes()), (&table.grid, 48 * 24 * 6 * 4));
    for bytes in [1, rows.row_bytes() * 20, u64::MAX] {
        let bands = rows.bands(bytes, rows.row_bytes());
        assert_eq!((bands[0].start, bands[bands.len() - 1].end), (0, 48));
        for range in bands {
            let stops: Vec<usize> = range.clone().collect();
            let found = rows.take(&stops).expect("read");
            let mut wanted = band(&table, range.start, range.end);
            if range.len() == 48 {
                wanted.grid = table.grid.clone();
            }
            assert!(found == wanted, "{range:?}");
            for (k, stop) in range.enumerate() {
                assert_eq!(found.grid.regions(k), table.grid.regions(stop));
                assert_eq!(found.grid.wi(k), table.grid.wi(stop));
            }
        }
    }
    // Single stops, far apart.
    let some = rows.take(&[3, 17, 47]).expect("read");
    assert_eq!(some.hits[24..48], table.hits[17 * 24..18 * 24]);
    let mut damaged = std::fs::read(&path).expect("there");
    let last = damaged.len() - 3;
    damaged[last] ^= 1;
    std::fs::write(&path, damaged).expect("written");
    let found = TableRows::open(&path).and_then(|mut rows| rows.verify());
    assert!(found.expect_err("damaged").to_string().contains("t.exr"));
}
