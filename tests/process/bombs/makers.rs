//! How a bomb is made: long texts, sparse files, archives of zeros, images and tensors of false sizes.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use gonio::files::image::{self, ImagePart, Samples};
use zip::write::SimpleFileOptions;

/// Puts a bomb into a folder.
pub type Maker = Box<dyn Fn(&Path)>;

/// A file `name` from pieces: text and how often it stands there.
pub fn texts(name: &'static str, pieces: Vec<(String, u64)>) -> Maker {
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
pub fn sparse(name: &'static str, head: Vec<u8>, length: u64) -> Maker {
    Box::new(move |folder| {
        let mut file = File::create(folder.join(name)).expect("created");
        file.write_all(&head).expect("written");
        file.set_len(length.max(head.len() as u64)).expect("a sparse file");
    })
}

/// The header of an NPY file.
pub fn npy(kind: &str, shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes()].concat()
}

/// An archive of members of zeros behind a head.
pub fn npz(members: Vec<(String, Vec<u8>, u64)>) -> Maker {
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
pub fn exr(name: &'static str, [width, height]: [u32; 2], length: u64) -> Maker {
    let mut part = ImagePart { width: 4, height: 4, ..ImagePart::default() };
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
pub fn attributes(count: u64) -> Maker {
    let magic = [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let many = (0..count).flat_map(|k| [format!("{k:x}").as_bytes(), b"\0i\0\0\0\0\0"].concat());
    sparse("b", magic.into_iter().chain(many).chain([0]).collect(), 0)
}

/// A tensor file of single precision: names, sides, and where each field's values begin.
fn tensors(fields: &[(&str, Vec<u64>, u64)]) -> Vec<u8> {
    let mut head = b"tensor_file\0\x01\0".to_vec();
    head.extend((fields.len() as u32).to_le_bytes());
    for (name, sides, start) in fields {
        head.extend((name.len() as u16).to_le_bytes());
        head.extend(name.as_bytes());
        head.extend((sides.len() as u16).to_le_bytes());
        head.push(10);
        head.extend(start.to_le_bytes());
        sides.iter().for_each(|side| head.extend(side.to_le_bytes()));
    }
    head
}

/// A tensor file whose fields are all the same bytes.
pub fn overlapping(values: u64) -> Maker {
    let axes = [("theta_i", 1), ("phi_i", 1), ("ndf", 2), ("sigma", 2), ("vndf", 4), ("rgb", 5)];
    let sides = |axes: usize| (0..axes).map(|axis| if axis == 0 { values } else { 1 }).collect();
    let fields: Vec<_> = axes.into_iter().map(|(name, axes)| (name, sides(axes), 512)).collect();
    sparse("b", tensors(&fields), 512 + 4 * values)
}

/// A sound tensor file of so many polar angles and azimuths of the light, with hardly a value for each.
pub fn lights(side: u64) -> Maker {
    let mut fields = vec![
        ("ndf", vec![2, 2], 512),
        ("sigma", vec![2, 2], 528),
        ("vndf", vec![side, side, 2, 2], 544),
        ("rgb", vec![side, side, 3, 2, 2], 544 + 16 * side * side),
    ];
    let angles = 544 + 64 * side * side;
    fields.extend([("theta_i", vec![side], angles), ("phi_i", vec![side], angles + 4 * side)]);
    let mut bytes = tensors(&fields);
    bytes.resize(512, 0);
    (0..8 + 16 * side * side).for_each(|_| bytes.extend(1.0f32.to_le_bytes()));
    for [from, to] in [[0.0, 1.5f32], [-3.12, 3.12]] {
        let angle = |k: u64| from + (to - from) * k as f32 / (side - 1) as f32;
        (0..side).for_each(|k| bytes.extend(angle(k).to_le_bytes()));
    }
    sparse("b", bytes, 0)
}

/// A map of so many samples along a side, each of which is refined before it is measured: every second one is a needle.
pub fn needles(name: &'static str, side: u64) -> Maker {
    let samples = (0..side * side).map(|at| (at / side * at % 2) as u8 * 200);
    let head = npy("|u1", &format!("({side}, {side})"));
    sparse(name, head.into_iter().chain(samples).collect(), 0)
}

/// A list in which each of so many lights has a direction of its own: all other pairs are gaps, in every colour.
pub fn gaps(lights: u64, colours: u64) -> Maker {
    let names: String = (0..colours).map(|colour| format!(",{}nm", 400 + colour)).collect();
    let values = ",1".repeat(colours as usize);
    let angle = |light: u64| 80.0 * light as f64 / lights as f64;
    let line = |light: u64| format!("{0},0,{0},180{values}\n", angle(light));
    let list: String = (0..lights).map(line).collect();
    texts("b", vec![(format!("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg{names}\n{list}"), 1)])
}

const MAP: &str = "name = \"b\"\nseed = 1\n[surface.file]\npath = \"SCAN\"\npitch_x_um = 1\npitch_y_um = 1\nheight_unit_um = 1\n\
    [light]\ntheta_i_deg = [0]\nphi_i_deg = [0]\n[sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\n[stop]\n\
    samples = 1000\n";

/// The file of a height map, and the campaign that names it.
pub fn map(name: &'static str, scan: Maker) -> Maker {
    Box::new(move |folder| {
        std::fs::write(folder.join("c.toml"), MAP.replace("SCAN", name)).expect("written");
        scan(folder);
    })
}

/// What makes a bomb, with a small table beside it.
pub fn beside_a_table(bomb: Maker) -> Maker {
    Box::new(move |folder| {
        let table = gonio::interchange::foreign_table(small_grid(), vec![vec![1.0; 8]]);
        let path = folder.join("t.exr");
        gonio::table::store::save(&path, &table.expect("a table")).expect("saved");
        bomb(folder);
    })
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
