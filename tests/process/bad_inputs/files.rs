//! Files that are read: tables, height maps, other programs' formats.

use std::fs;
use std::path::Path;

use gonio::files::image::{self, Attribute, ImagePart, Samples};
use gonio::instrument::{Grid, GridKind};
use gonio::interchange::foreign_table;
use gonio::interchange::merl;
use gonio::interchange::text::csv;
use gonio::table::{BrdfTable, store};

use super::row::{Row, command};
use crate::support::arrays;
use crate::support::campaign_text::SMALL;

pub fn rows() -> Vec<Row> {
    [tables(), maps(), merl_files(), csv_files()].into_iter().flatten().collect()
}

/// Two incidences of two points.
fn table() -> BrdfTable {
    let text = "{\"kind\":\"points\",\"theta_i_deg\":[0,30],\"phi_i_deg\":[0],\"phi_r_relative\":false,\"points_deg\":[[0,0],[30,180]]}";
    let grid: Grid = serde_json::from_str(text).expect("a grid");
    assert_eq!(grid.kind, GridKind::Points);
    foreign_table(grid, vec![vec![0.3, 0.2, 0.2, 0.4]]).expect("a table")
}

/// The bytes of a small sound table.
pub fn table_bytes() -> Vec<u8> {
    store::encode(&table()).expect("encodes")
}

/// The table's file after `change` of its one part; its digest is left out.
fn changed(change: impl FnOnce(&mut ImagePart)) -> Vec<u8> {
    let mut parts = image::decode(&table_bytes()).expect("decodes");
    parts[0].attributes.remove("gonio.digest");
    change(&mut parts[0]);
    image::encode(parts).expect("encodes")
}

fn with_value(value: f32) -> Vec<u8> {
    changed(|part| {
        part.channels.insert("Y".into(), Samples::F32(vec![0.3, value, 0.2, 0.4]));
    })
}

/// The table's file with four bytes of the attribute `name` of type `kind` replaced.
fn with_header(name: &str, kind: &str, offset: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = table_bytes();
    let key = [name.as_bytes(), b"\0", kind.as_bytes(), b"\0"].concat();
    let at = file.windows(key.len()).position(|w| w == key).expect("is there") + key.len() + 4 + offset;
    file[at..at + bytes.len()].copy_from_slice(bytes);
    file
}

fn tables() -> Vec<Row> {
    let row = |content: Vec<u8>, says: &'static str| {
        command("table damaged", "validate x.exr").file("x.exr", content).exits(3, &["error: x.exr: ", says])
    };
    let good = table_bytes();
    let half = half::f16::from_f32(0.5);
    let mut deep = good.clone();
    deep[5] |= 0x08;
    let mut tiled = good.clone();
    tiled[5] |= 0x02;
    let mut longer = good.clone();
    longer.extend_from_slice(&[0; 100]);
    let mut flipped = good.clone();
    let last = flipped.len() - 3;
    flipped[last] ^= 1;
    vec![
        command("table damaged", "validate x.exr").file("x.exr", good.clone()).exits(0, &["verdict"]),
        row(vec![], "the file is empty"),
        row(good[..3].to_vec(), ""),
        row(good[..400].to_vec(), ""),
        row(good[..good.len() - 1].to_vec(), ""),
        row(flipped, ""),
        row(with_header("dataWindow", "box2i", 8, &i32::MAX.to_le_bytes()), ""),
        row(with_header("dataWindow", "box2i", 8, &(-5i32).to_le_bytes()), ""),
        row(with_value(f32::NAN), "channel `Y`, incidence 0, bin 1"),
        row(with_value(f32::INFINITY), "channel `Y`, incidence 0, bin 1"),
        row(changed(|part| drop(part.channels.remove("single.Y"))), "channel `single.Y` is missing"),
        row(
            changed(|part| drop(part.channels.insert("Y".into(), Samples::F16(vec![half; 4])))),
            "channel `Y` is HALF",
        ),
        row(changed(|part| drop(part.attributes.remove("gonio.grid"))), "no gonio.grid attribute"),
        row(
            changed(|part| drop(part.attributes.insert("gonio.grid".into(), Attribute::Text("{".into())))),
            "gonio.grid: ",
        ),
        row(deep, ""),
        row(tiled, ""),
        row(SMALL.into(), "not an EXR file"),
        command("table damaged", "compare x.exr x.exr")
            .file("x.exr", "EXR")
            .exits(3, &["error: x.exr: not an EXR file"]),
        command("table damaged", "fit x.exr")
            .file("x.exr", "EXR")
            .exits(3, &["error: x.exr: not an EXR file"]),
        command("table damaged", "report x.exr -o x.html")
            .file("x.exr", "EXR")
            .exits(3, &["error: x.exr: not an EXR file"]),
        command("table damaged", "validate x.exr").file("x.exr", longer),
    ]
}

/// A campaign on the map `scan.npy`.
const MAP: &str = "\
name = \"map\"
[surface]
[surface.file]
path = \"scan.npy\"
pitch_x_um = 1
pitch_y_um = 1
height_unit_um = 1
tiles = 2
[light]
average_azimuth = true
theta_i_deg = [20]
[sensor.hemisphere]
theta_r_bins = 6
phi_r_bins = 12
[stop]
samples = 65_536
";

fn npy(columns: usize, rows: usize, height: impl Fn(usize) -> f64) -> Vec<u8> {
    arrays::npy(&(0..rows * columns).map(height).collect::<Vec<_>>(), columns)
}

fn maps() -> Vec<Row> {
    let row = |name: &'static str, map: Vec<u8>| {
        command(name, "measure map.toml").file("map.toml", MAP).file("scan.npy", map)
    };
    let hole = |value: f64| npy(20, 20, move |i| if i == 45 { value } else { i as f64 });
    vec![
        // Prime and oblong.
        row("map prime or oblong", npy(102, 30, |i| ((i * i) % 17) as f64 * 0.01)).exits(0, &["verdict"]),
        row("map flat", npy(33, 33, |_| 7.0)).exits(0, &["the map is flat: a mirror"]),
        // A fault of a file's content, not of the campaign: 3.
        row("map with a hole", hole(f64::NAN)).exits(
            3,
            &["error: scan.npy: no data at row 2, column 5 (1 such of 400): set surface.file.gaps"],
        ),
        row("map with a hole", hole(f64::INFINITY)).exits(
            3,
            &["error: scan.npy: no data at row 2, column 5 (1 such of 400): set surface.file.gaps"],
        ),
        row("cells out of range", npy(8, 30, |i| i as f64))
            .exits(3, &["error: scan.npy: 7 x 29 cells; at least 8 x 8"]),
        row("table damaged", table_bytes()).exits(3, &["error: scan.npy: "]),
        row("table damaged", vec![]).exits(3, &["error: scan.npy: the file is empty"]),
        command("no such campaign", "measure map.toml")
            .file("map.toml", MAP)
            .exits(3, &["error: scan.npy: No such file"]),
    ]
}

fn sparse(path: &Path, head: &[u8], length: usize) {
    fs::write(path, head).expect("file");
    fs::OpenOptions::new().write(true).open(path).and_then(|f| f.set_len(length as u64)).expect("sparse");
}

fn merl_head(dimensions: [i32; 3]) -> Vec<u8> {
    dimensions.iter().flat_map(|side| side.to_le_bytes()).collect()
}

fn merl_files() -> Vec<Row> {
    let row = || command("MERL damaged", "import x.binary --from merl -o t.exr");
    vec![
        row().file("x.binary", "").exits(3, &["error: x.binary: merl: ", "too few"]),
        row().file("x.binary", merl_head([90, 90, 180])).exits(3, &["error: x.binary: merl: ", "34992012"]),
        row()
            .prepared(|f| sparse(&f.join("x.binary"), &merl_head([0, 90, 180]), merl::BYTES))
            .exits(3, &["error: x.binary: merl: ", "0 x 90 x 180"]),
        row()
            .prepared(|f| sparse(&f.join("x.binary"), &merl_head([-90, -90, 180]), merl::BYTES))
            .exits(3, &["error: x.binary: merl: ", "-90 x -90 x 180"]),
        row()
            .prepared(|f| sparse(&f.join("x.binary"), &merl_head([90, 90, 180]), merl::BYTES + 1))
            .exits(3, &["error: x.binary: merl: 34992013 bytes"]),
    ]
}

fn csv_files() -> Vec<Row> {
    let mut good = Vec::new();
    csv::write(&table(), &mut good).map_err(|_| "full").expect("written");
    let good = String::from_utf8(good).expect("text");
    let row = |name: &'static str, text: String| {
        command(name, "import x.csv --from csv -o t.exr").file("x.csv", text)
    };
    let wrong =
        |text: String, says: &'static str| row("CSV damaged", text).exits(3, &["error: x.csv: csv: ", says]);
    let value = |text: &str| good.replacen(",0.3,", &format!(",{text},"), 1);
    vec![
        row("CSV damaged", good.clone()).exits(0, &["2 incidences of 2 bins"]),
        wrong(good.replace("theta_i_deg", "theta"), "no column `theta_i_deg`"),
        wrong(good.replacen("\n0,", "\n0,0,", 1), "line 2"),
        wrong(value("nan"), "line 2"),
        wrong(value("three"), "line 2"),
        wrong(value("-0.3"), "line 2"),
        wrong(value("1e39"), "line 2"),
        wrong(value("0,3"), "line 2"),
        // What spreadsheets write is the same table.
        row("CSV damaged", good.replace('\n', "\r\n")).exits(0, &["2 incidences of 2 bins"]),
        row("CSV damaged", value("\"0.3\"")).exits(0, &["2 incidences of 2 bins"]),
        row("value beyond the format", value("3.5e38")).exits(3, &["error: x.csv: csv: ", "line 2"]),
        row("value below normal", value("1e-42")).exits(0, &["2 incidences of 2 bins"]),
    ]
}
