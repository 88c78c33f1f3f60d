//! Files that ask for far more memory than they are long, or are longer than memory.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use gonio::files::image::{self, Part, Samples};
use zip::write::SimpleFileOptions;

/// A file, and the command line that reads it.
pub struct Bomb {
    pub name: String,
    pub arguments: String,
    /// Puts it into a folder.
    pub write: Box<dyn Fn(&Path)>,
}

/// A file `name` from pieces: text and how often it stands there.
fn texts(name: &'static str, pieces: Vec<(String, u64)>) -> Box<dyn Fn(&Path)> {
    Box::new(move |folder| {
        let mut out = BufWriter::new(File::create(folder.join(name)).expect("created"));
        for (text, times) in &pieces {
            let block = text.repeat((1 << 16) / text.len().max(1) + 1);
            let mut left = text.len() as u64 * times;
            while left > 0 {
                let size = left.min(block.len() as u64);
                out.write_all(&block.as_bytes()[..size as usize]).expect("written");
                left -= size;
            }
        }
        out.flush().expect("written");
    })
}

/// A file of these bytes that goes on with zeros, which take no space on the disk.
fn sparse(name: &'static str, head: Vec<u8>, length: u64) -> Box<dyn Fn(&Path)> {
    Box::new(move |folder| {
        let mut file = File::create(folder.join(name)).expect("created");
        file.write_all(&head).expect("written");
        file.set_len(length.max(head.len() as u64)).expect("a sparse file");
    })
}

/// The header of an NPY file.
fn npy(kind: &str, shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes()].concat()
}

/// An archive of members of zeros behind a head.
fn npz(members: Vec<(String, Vec<u8>, u64)>) -> Box<dyn Fn(&Path)> {
    Box::new(move |folder| {
        let mut zip = zip::ZipWriter::new(File::create(folder.join("b")).expect("created"));
        for (name, head, zeros) in &members {
            let deflated = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
            zip.start_file(name, deflated).expect("a member");
            zip.write_all(head).expect("written");
            let block = vec![0u8; 1 << 16];
            for _ in 0..zeros.div_ceil(1 << 16) {
                zip.write_all(&block).expect("written");
            }
        }
        zip.finish().expect("finished");
    })
}

/// An image whose windows are made so wide and high, followed by zeros.
fn exr(name: &'static str, [width, height]: [u32; 2], length: u64) -> Box<dyn Fn(&Path)> {
    let mut part = Part { width: 4, height: 4, ..Part::default() };
    for channel in ["R", "G", "B", "height"] {
        part.channels.insert(channel.into(), Samples::F32(vec![0.0; 16]));
    }
    let mut bytes = image::encode(vec![part]).expect("an image");
    for window in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let at = bytes.windows(window.len()).position(|here| here == window.as_bytes()).expect("there");
        let corner = at + window.len() + 4 + 8;
        bytes[corner..][..4].copy_from_slice(&(width - 1).to_le_bytes());
        bytes[corner + 4..][..4].copy_from_slice(&(height - 1).to_le_bytes());
    }
    let count = b"chunkCount\0int\0";
    if let Some(at) = bytes.windows(count.len()).position(|here| here == count) {
        bytes[at + count.len() + 4..][..4].copy_from_slice(&height.div_ceil(16).to_le_bytes());
    }
    sparse(name, bytes, length)
}

/// The header of an image with so many attributes.
fn attributes(count: u64) -> Box<dyn Fn(&Path)> {
    let magic = [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let many = (0..count).flat_map(|k| [format!("{k:x}").as_bytes(), b"\0i\0\0\0\0\0"].concat());
    sparse("b", magic.into_iter().chain(many).chain([0]).collect(), 0)
}

/// A tensor file whose fields are all the same bytes.
fn overlapping(values: u64) -> Box<dyn Fn(&Path)> {
    let mut head = b"tensor_file\0\x01\0".to_vec();
    let fields = [("theta_i", 1), ("phi_i", 1), ("ndf", 2), ("sigma", 2), ("vndf", 4), ("rgb", 5)];
    head.extend((fields.len() as u32).to_le_bytes());
    for (name, axes) in fields {
        head.extend((name.len() as u16).to_le_bytes());
        head.extend(name.as_bytes());
        head.extend((axes as u16).to_le_bytes());
        head.push(10);
        head.extend(512u64.to_le_bytes());
        (0..axes).for_each(|axis| head.extend(if axis == 0 { values } else { 1 }.to_le_bytes()));
    }
    sparse("b", head, 512 + 4 * values)
}

const MAP: &str = "name = \"b\"\nseed = 1\n[surface.file]\npath = \"SCAN\"\npitch_x_um = 1\npitch_y_um = 1\nheight_unit_um = 1\n\
    [light]\ntheta_i_deg = [0]\nphi_i_deg = [0]\n[sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\n[stop]\n\
    samples = 1000\n";

/// The file of a height map, and the campaign that names it.
fn map(name: &'static str, scan: Box<dyn Fn(&Path)>) -> Box<dyn Fn(&Path)> {
    Box::new(move |folder| {
        std::fs::write(folder.join("c.toml"), MAP.replace("SCAN", name)).expect("written");
        scan(folder);
    })
}

const XML: &str = "<WindowElement><DataDefinition><IncidentDataStructure>";
const BLOCK: &str = "<WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock><WavelengthDataDirection>Reflection \
    Back</WavelengthDataDirection>";
const KLEMS: &str =
    "<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis><RowAngleBasis>LBNL/Klems Full</RowAngleBasis>";
const CSV: &str = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n";
const ASTM: &str = "VARS theta_i,phi_i,theta_s,phi_s,Y\n";
const SSDD: &str =
    "VERSION 1.0\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n";

fn xml(structure: &str, pieces: Vec<(String, u64)>) -> Box<dyn Fn(&Path)> {
    let head = format!("{XML}{structure}</IncidentDataStructure>");
    let end = "</ScatteringData></WavelengthDataBlock></WavelengthData></WindowElement>";
    texts("b", [(head, 1)].into_iter().chain(pieces).chain([(end.to_string(), 1)]).collect())
}

/// What makes a bomb, with a small table beside it.
fn beside_a_table(bomb: Box<dyn Fn(&Path)>) -> Box<dyn Fn(&Path)> {
    Box::new(move |folder| {
        let table = gonio::interchange::foreign_table(small_grid(), vec![vec![1.0; 8]]);
        let path = folder.join("t.exr");
        gonio::table::store::save(&path, &table.expect("a table")).expect("saved");
        bomb(folder);
    })
}

/// A bomb's name, the command that is to read it, and what makes it.
type Made<'a> = (&'a str, String, Box<dyn Fn(&Path)>);

/// All of them; `size` is their length as a share of the usual one.
pub fn all(size: f64) -> Vec<Bomb> {
    let mb = |count: f64| (count * size * 1e6) as u64;
    let once = |text: &str| (text.to_string(), 1);
    let of = |text: &str, megabytes: f64| (text.to_string(), mb(megabytes) / text.len() as u64);
    let data = |bases: &str| once(&format!("</DataDefinition>{BLOCK}{bases}<ScatteringData>"));
    let side = ((size * 4e8).sqrt() as u64).max(8);
    let import = |format: &str| format!("import b --from {format} -o t.exr");
    let check = "measure c.toml -o out";
    let array = |zeros: u64| (npy("<f4", &format!("(1, 1, 1, {})", zeros / 4)), zeros);
    let named = |name: String, (head, zeros): (Vec<u8>, u64)| (name, head, zeros);
    let whole = |megabytes: f64| array(mb(megabytes).next_multiple_of(1 << 16));
    let orders = (2..22).map(|k| named(format!("order{k}.npy"), whole(40.0))).collect();
    let wide: String =
        CSV.encode_utf16().map(|unit| char::from(unit as u8)).flat_map(|c| [c, '\0']).collect();
    let list: Vec<Made> = vec![
        ("npz of zeros", import("npz"), npz(vec![("brdf.npy".into(), vec![], mb(600.0))])),
        ("npz array", import("npz"), npz(vec![named("brdf.npy".into(), whole(300.0))])),
        ("npz orders", import("npz"), npz(orders)),
        ("npz false shape", import("npz"), npz(vec![("grid.npy".into(), npy("<U1", "(9,)"), mb(300.0))])),
        ("npz texts", import("npz"), npz(vec![("grid.npy".into(), npy("<U1", "(70000000,)"), mb(280.0))])),
        ("npz members", import("npz"), npz((0..mb(0.06)).map(|k| (format!("{k}"), vec![], 0)).collect())),
        ("npz cut short", import("npz"), sparse("b", b"PK\x03\x04".to_vec(), mb(3000.0))),
        ("exr wide", import("utia"), exr("b", [1 << 24, 16], mb(4.0))),
        ("exr high", import("exr_parts"), exr("b", [1 << 10, (size * 1e6) as u32], mb(40.0))),
        ("exr table", "export b --to npy -o t.npy".into(), exr("b", [1 << 24, 16], mb(4.0))),
        ("exr attributes", "validate b".into(), attributes(mb(5.0))),
        ("exr maps", "import . --from maps --every 1 -o m".into(), {
            let alpha = exr("ax_ay.exr", [1 << 24, 8], mb(4.0));
            let f0 = exr("ps.exr", [1 << 24, 8], mb(4.0));
            Box::new(move |folder| (alpha(folder), f0(folder)).0)
        }),
        ("csv line", import("csv"), texts("b", vec![once(CSV), of("0,", 300.0)])),
        ("csv heading", import("csv"), texts("b", vec![of("theta_i_deg,", 300.0)])),
        ("csv quoted", import("csv"), texts("b", vec![once(CSV), once("0,0,0,0,\""), of("0\n", 300.0)])),
        ("csv lines", import("csv"), texts("b", vec![once(CSV), of("0,0,0,0,1\n", 300.0)])),
        ("csv empty lines", import("csv"), texts("b", vec![once(CSV), of("\n", 300.0)])),
        ("csv comments", import("csv"), texts("b", vec![of("#\n", 300.0)])),
        ("csv wide", import("csv"), texts("b", vec![once(&wide.to_string()), of("0\0,\0", 300.0)])),
        ("astm line", import("astm"), texts("b", vec![once(ASTM), of("0,", 300.0)])),
        ("astm lines", import("astm"), texts("b", vec![once(ASTM), of("0,0,0,0,1\n", 300.0)])),
        ("ssdd line", import("ssdd"), texts("b", vec![once(SSDD), once("PARAM0_LIST "), of("0 ", 300.0)])),
        (
            "ssdd binary",
            import("ssdd"),
            sparse("b", format!("{SSDD}PARAM0_LIST 0\nDATA binary\n").into_bytes(), mb(900.0)),
        ),
        ("ssdd ascii", import("ssdd"), texts("b", vec![once(SSDD), once("DATA ascii\n"), of("0\n", 200.0)])),
        ("klems data", import("klems"), xml("Columns", vec![data(KLEMS), of("0 ", 200.0)])),
        (
            "klems cells",
            import("klems"),
            xml("Columns", vec![data(KLEMS), once(&"0".repeat(9)), of("0", 400.0)]),
        ),
        (
            "klems rings",
            import("klems"),
            xml(
                "Columns",
                vec![
                    once("<AngleBasis><AngleBasisName>LBNL/Klems Full</AngleBasisName>"),
                    of("<AngleBasisBlock><nPhis>360</nPhis></AngleBasisBlock>", 20.0),
                    once("</AngleBasis>"),
                    data(KLEMS),
                ],
            ),
        ),
        (
            "klems names",
            import("klems"),
            xml(
                "Columns",
                vec![
                    once("<Wavelength>"),
                    of("V", 1.0),
                    once("</Wavelength>"),
                    of("<WavelengthDataBlock></WavelengthDataBlock>", 1.0),
                    data(KLEMS),
                ],
            ),
        ),
        (
            "klems elements",
            import("klems"),
            xml("Columns", vec![of("<AngleBasis></AngleBasis>", 300.0), data("")]),
        ),
        (
            "tensor tree",
            import("tensor_tree"),
            xml("TensorTree4", vec![data(""), once("{"), of("{0}", 100.0)]),
        ),
        (
            "tensor leaf",
            import("tensor_tree"),
            xml("TensorTree4", vec![data(""), once("{"), of("0 ", 200.0)]),
        ),
        ("zemax", import("zemax"), texts("b", vec![once("Source Measured\n"), of("0 ", 300.0)])),
        ("merl", import("merl"), sparse("b", vec![], mb(3000.0))),
        ("utia", import("utia"), sparse("b", vec![], mb(3000.0))),
        ("rgl", import("rgl"), sparse("b", b"tensor_file\0\x01\0".to_vec(), mb(900.0))),
        ("rgl overlap", import("rgl"), overlapping(mb(20.0))),
        (
            "map npy",
            check.into(),
            map(
                "scan.npy",
                sparse("scan.npy", npy("|u1", &format!("({side}, {side})")), {
                    side * side + npy("|u1", &format!("({side}, {side})")).len() as u64
                }),
            ),
        ),
        (
            "map gsf",
            check.into(),
            map("scan.gsf", {
                let head = format!("Gwyddion Simple Field 1.0\nXRes = {side}\nYRes = {side}\n");
                let start = head.len() as u64 + 4 - head.len() as u64 % 4;
                sparse("scan.gsf", head.into_bytes(), start + 4 * side * side)
            }),
        ),
        ("map exr", check.into(), map("scan.exr", exr("scan.exr", [1 << 24, 16], mb(4.0)))),
        ("map line", check.into(), map("scan.txt", texts("scan.txt", vec![of("0 0 0 ", 300.0)]))),
        ("map points", check.into(), map("scan.xyz", texts("scan.xyz", vec![of("0 0 0\n", 300.0)]))),
        (
            "map matrix",
            check.into(),
            map("scan.txt", texts("scan.txt", vec![of("0 0 0 0 0 0 0 0\n", 300.0)])),
        ),
        (
            "map arc",
            check.into(),
            map("scan.asc", texts("scan.asc", vec![once("ncols 1\n"), of("a 1 ", 300.0)])),
        ),
        ("toml", check.into(), texts("c.toml", vec![once("a = ["), of("0,", 200.0)])),
        ("toml values", check.into(), texts("c.toml", vec![once("a = ["), of("0,", 16.0)])),
        ("toml fewer values", check.into(), texts("c.toml", vec![once("a = ["), of("0,", 4.0), once("0]")])),
        ("toml tables", check.into(), texts("c.toml", vec![once("a = ["), of("{},", 5.0), once("0]")])),
        (
            "json nodes",
            "report t.exr --bench j.json".into(),
            beside_a_table(texts("j.json", vec![once("["), of("0,", 100.0)])),
        ),
        (
            "json text",
            "report t.exr --bench j.json".into(),
            beside_a_table(texts("j.json", vec![once("\""), of("0", 900.0)])),
        ),
        ("shard", "merge b.shard_1_of_1 -o out".into(), sparse("b.shard_1_of_1", vec![], mb(3000.0))),
        ("shard content", "merge b.shard_1_of_1 -o out".into(), {
            sparse("b.shard_1_of_1", b"gonio shard 3\n".to_vec(), mb(900.0))
        }),
    ];
    list.into_iter().map(|(name, arguments, write)| Bomb { name: name.into(), arguments, write }).collect()
}

fn small_grid() -> gonio::instrument::Grid {
    gonio::instrument::Grid {
        theta_i_deg: vec![0.0],
        phi_i_deg: vec![0.0],
        theta_r_edges_deg: vec![0.0, 45.0, 90.0],
        phi_r_edges_deg: vec![0.0, 90.0, 180.0, 270.0, 360.0],
        phi_r_relative: true,
        ..gonio::instrument::Grid::default()
    }
}
