//! Tables larger than memory: written by rows and read by rows, with the bytes and the figures of whole ones.

use std::io::Cursor;
use std::path::Path;
use std::sync::OnceLock;

use gonio::campaign;
use gonio::files::image;
use gonio::interchange::{self, Format, Options};
use gonio::measure;
use gonio::report::html::thinned::kept_incidences;
use gonio::table::realisations;
use gonio::table::{BrdfTable, TableRows, TableWriter, store};
use gonio::validate::two_tables::{ComparedTable, TableDifference, difference, difference_of_rows};
use gonio::validate::{Verdict, examine, examine_rows};

use crate::support::analytic::{Ggx, hemisphere, measured_looking, steps};
use crate::support::measuring;
use crate::support::program::{exits, gonio};

/// 6 x 8 incidences of 3 x 8 bins: three blocks of 16 rows.
fn grid() -> gonio::instrument::Grid {
    hemisphere(steps(15.0, 6), Some(steps(45.0, 8)), 3, 8)
}

fn table() -> BrdfTable {
    measured_looking(&Ggx::new(0.3, 0.5), &grid())
}

/// The incidences `first..end` of a table, as a table.
fn band(table: &BrdfTable, first: usize, end: usize) -> BrdfTable {
    let bins = table.grid.bins();
    let part = |values: &[f32]| values[first * bins..end * bins].to_vec();
    let mut band = table.clone();
    band.grid = table.grid.of_incidences(first..end).expect("stops");
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
    assert!(why.contains("channel `Y`, incidence 21, bin 6: NaN"), "{why}");
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
            let incidences: Vec<usize> = range.clone().collect();
            let found = rows.take(&incidences).expect("read");
            let mut wanted = band(&table, range.start, range.end);
            if range.len() == 48 {
                wanted.grid = table.grid.clone();
            }
            assert!(found == wanted, "{range:?}");
            for (k, incidence) in range.enumerate() {
                assert_eq!(found.grid.regions(k), table.grid.regions(incidence));
                assert_eq!(found.grid.wi(k), table.grid.wi(incidence));
            }
        }
    }
    // Single incidences, far apart.
    let some = rows.take(&[3, 17, 47]).expect("read");
    assert_eq!(some.hits[24..48], table.hits[17 * 24..18 * 24]);
    let mut damaged = std::fs::read(&path).expect("there");
    let last = damaged.len() - 3;
    damaged[last] ^= 1;
    std::fs::write(&path, damaged).expect("written");
    let found = TableRows::open(&path).and_then(|mut rows| rows.verify());
    assert!(found.expect_err("damaged").to_string().contains("t.exr"));
}

/// Eight incidences, and as many bins and orders as make two MiB and more: bands are asked for in MiB.
const CAMPAIGN: &str = "name = \"rows\"\nseed = 3\n[surface]\nrealisations = 4\ncells = 64\ncorrelation_cells = 4.0\n\
    [surface.ggx]\nalpha_x = 0.3\nalpha_y = 0.5\n[light]\ntheta_i_deg = [20, 50]\nazimuth = \"absolute\"\n\
    phi_i_deg = { from = 0, to = 270, step = 90 }\n[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 12\n\
    [optics]\nmaterials = [\"gold\", \"copper\"]\n[trace]\nbounces = 8\n[stop]\nsamples = 8192\n";

/// Its first table, measured once.
fn measured() -> &'static measure::Measured {
    static MEASURED: OnceLock<measure::Measured> = OnceLock::new();
    MEASURED.get_or_init(|| measuring::measured(CAMPAIGN).remove(0))
}

#[test]
fn a_table_examined_by_rows_has_the_verdict_of_the_whole() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("t.exr");
    let measured = measured();
    store::save(&path, &measured.table).expect("saved");
    let json = |verdict: &Verdict| serde_json::to_string(verdict).expect("JSON");
    for parts in [None, Some(&measured.realisations)] {
        let whole = examine(&measured.table, &measured.campaign, parts);
        // Eight incidences make 28 pairs.
        assert!(whole.reciprocity.as_ref().is_some_and(|found| found.pairs > 20));
        for bytes in [1, u64::MAX] {
            let mut rows = TableRows::open(&path).expect("opened");
            let found = examine_rows(&mut rows, Some(&measured.campaign), parts, bytes).expect("read");
            assert_eq!(json(&found), json(&whole), "{bytes} bytes");
        }
        let found = examine_rows(&mut TableRows::open(&path).expect("opened"), None, parts, 1).expect("read");
        assert_eq!(json(&found), json(&examine(&measured.table, None, parts)));
    }
}

fn side(measured: &measure::Measured) -> ComparedTable<'_> {
    let measure::Measured { table, campaign, realisations, .. } = measured;
    ComparedTable { campaign: Some(campaign), parts: Some(realisations), ..ComparedTable::of(table) }
}

#[test]
fn tables_compared_by_rows_differ_as_whole_ones() {
    let folder = tempfile::tempdir().expect("folder");
    let paths = ["a.exr", "b.exr"].map(|name| folder.path().join(name));
    let a = measured();
    let mut b = a.clone();
    b.table.colours[0].total.iter_mut().for_each(|value| *value *= 1.01);
    for part in &mut b.realisations.parts {
        part.total[0].iter_mut().enumerate().for_each(|(k, value)| *value *= 1.01 + 1e-3 * (k % 7) as f32);
    }
    [a, &b].iter().zip(&paths).for_each(|(m, path)| store::save(path, &m.table).expect("saved"));
    let json = |found: &TableDifference| serde_json::to_string(found).expect("JSON");
    let whole = difference(side(a), side(&b)).expect("comparable");
    assert!(whole.paired);
    let [mut rows_a, mut rows_b] = paths.each_ref().map(|path| TableRows::open(path).expect("opened"));
    let both = (&mut rows_a, &mut rows_b);
    let parts = [Some(&a.realisations), Some(&b.realisations)];
    let found = difference_of_rows(both, [Some(&a.campaign), Some(&b.campaign)], parts, 1).expect("read");
    assert_eq!(json(&found), json(&whole));
}

#[test]
fn a_table_exported_by_rows_is_the_file_of_the_whole() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("t.exr");
    let measured = measured();
    store::save(&path, &measured.table).expect("saved");
    for (name, format) in [("npy", Format::Npy), ("csv", Format::Csv)] {
        let [whole, by_rows] = ["whole", "by_rows"].map(|kind| folder.path().join(format!("{kind}.{name}")));
        let wanted =
            interchange::export(&measured.table, format, &Options::default(), &whole).expect("written");
        let mut rows = TableRows::open(&path).expect("opened");
        let found = interchange::export_rows(&mut rows, format, &(&by_rows).into(), 1).expect("written");
        assert!(std::fs::read(&whole).expect("there") == std::fs::read(&by_rows).expect("there"), "{name}");
        assert_eq!(found, wanted);
        assert_eq!(found.read_back.expect("light").worst, 0.0);
    }
    let mut rows = TableRows::open(&path).expect("opened");
    let output = folder.path().join("t.bsdf");
    let refused =
        interchange::export_rows(&mut rows, Format::Rgl, &(&output).into(), 1).expect_err("needs it whole");
    assert!(refused.exit_code() == 4 && !output.exists(), "{refused}");
}

#[test]
fn a_page_of_a_large_table_shows_incidences_of_every_part_of_it() {
    let grid = grid();
    assert_eq!(kept_incidences(&grid, 10, 480), Some((grid.clone(), (0..48).collect())));
    let (kept, incidences) = kept_incidences(&grid, 10, 130).expect("stops");
    assert!(kept.incidences() <= 13 && kept.incidences() == incidences.len() && incidences.contains(&0));
    for (k, &incidence) in incidences.iter().enumerate() {
        assert_eq!((kept.incidence_deg(k), kept.wi(k)), (grid.incidence_deg(incidence), grid.wi(incidence)));
    }
    assert_eq!(kept_incidences(&grid, 10, 1).expect("stops").1, [0]);
}

#[test]
fn a_campaign_measured_in_bands_gives_the_same_bytes() {
    let folder = tempfile::tempdir().expect("folder");
    let here = folder.path();
    std::fs::write(here.join("rows.toml"), CAMPAIGN).expect("written");
    let campaign = campaign::parse(CAMPAIGN, "rows", Path::new("")).expect("sound").campaign;
    // A part of a MiB less than all at once takes: some incidences fewer.
    let all = measure::plan(&campaign).expect("fits").memory_bytes >> 20;
    let banded = (1..=all)
        .find(|&mb| measure::plan_within(&campaign, mb << 20).is_ok_and(|plan| plan.bands().len() > 2));
    let mb = banded.expect("a budget that bands fit").to_string();
    for (name, memory) in [("whole", vec![]), ("bands", vec!["--memory-mb", &mb])] {
        let words = [&["measure", "rows.toml", "-o", name, "--threads", "2"], &memory[..]].concat();
        exits(&gonio(here, &words), 0);
    }
    let read = |name: &str, file: &str| std::fs::read(here.join(name).join(file)).expect(file);
    for material in ["gold", "copper"] {
        for end in [".exr", ".realisations.exr"] {
            let file = format!("rows_{material}{end}");
            assert!(read("whole", &file) == read("bands", &file), "{file}");
        }
        let summary = |name| -> serde_json::Value {
            serde_json::from_slice(&read(name, &format!("rows_{material}.json"))).expect("JSON")
        };
        let (whole, bands) = (summary("whole"), summary("bands"));
        for key in
            ["stops", "comparisons", "energy", "reciprocity", "ok", "fresnel", "stopped_by", "patch_digest"]
        {
            assert_eq!(whole[key], bands[key], "{key}");
        }
        assert_eq!(whole["cost"]["samples"], bands["cost"]["samples"]);
        // Cards tell the time; all else is the same.
        let card = |name| {
            let text = String::from_utf8(read(name, &format!("rows_{material}.card.md"))).expect("UTF-8");
            text.lines().filter(|line| !line.starts_with("| time")).collect::<Vec<_>>().join("\n")
        };
        assert_eq!(card("whole"), card("bands"));
    }
    let file = realisations::load(&here.join("bands/rows_gold.realisations.exr")).expect("sound");
    let table = store::load(&here.join("bands/rows_gold.exr")).expect("sound").table;
    assert!(file.is_of(&store::digest(&table).expect("a digest")));
}
