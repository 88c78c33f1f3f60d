//! Promise: a patch as a mesh has the facets that are traced, and says of its numbers what glTF asks for.

use glam::DVec3;
use gonio::surface::Heightfield;
use gonio::surface::io::glb;
use serde_json::Value;

/// The document of a file, and its numbers.
fn parts(file: &[u8]) -> (Value, &[u8]) {
    let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!((&file[..4], number(4), number(8)), (&b"glTF"[..], 2, file.len()));
    let (length, document) = (number(12), &file[20..]);
    assert_eq!((&file[16..20], length % 4), (&b"JSON"[..], 0));
    let binary = &document[length..];
    assert_eq!((&binary[4..8], binary.len() - 8), (&b"BIN\0"[..], number(20 + length)));
    (serde_json::from_slice(&document[..length]).expect("JSON"), &binary[8..])
}

fn field(periodic: bool) -> Heightfield {
    let extra = usize::from(!periodic);
    let height = |k: usize| ((37 * k) % 11) as f64 / 8.0 - 0.5;
    Heightfield::new(4, 3, periodic, (0..(4 + extra) * (3 + extra)).map(height).collect())
}

#[test]
fn a_mesh_has_the_facets_of_the_patch() {
    for field in [field(true), field(false)] {
        let pitch = [0.5, 2.0];
        let file = glb::encode(&field, pitch).expect("a mesh");
        let (document, numbers) = parts(&file);
        let views = &document["bufferViews"];
        let vertices = views[0]["byteLength"].as_u64().expect("bytes") as usize;
        assert_eq!((vertices, document["accessors"][0]["count"].as_u64()), (5 * 4 * 12, Some(20)));
        let words = |bytes: &[u8]| {
            bytes.chunks(4).map(|word| word.try_into().expect("four bytes")).collect::<Vec<[u8; 4]>>()
        };
        let parts: Vec<f32> = words(&numbers[..vertices]).into_iter().map(f32::from_le_bytes).collect();
        // Back to the frame of the patch, in cells.
        let place = |k: u32| {
            let [x, y, z] = [0, 1, 2].map(|part| f64::from(parts[3 * k as usize + part]));
            DVec3::new(x / pitch[0], -z / pitch[1], y)
        };
        let corners: Vec<u32> = words(&numbers[vertices..]).into_iter().map(u32::from_le_bytes).collect();
        assert_eq!(corners.len(), 3 * 2 * 4 * 3);
        for (k, triangle) in corners.chunks(3).enumerate() {
            let [a, b, c] = [0, 1, 2].map(|k| place(triangle[k]));
            let normal = (b - a).cross(c - a);
            // Heights in eighths and pitches that are powers of two: every number is exact.
            let (cell, upper) = (k / 2, k % 2 == 1);
            let slope = field.corners(cell % 4, cell / 4).slope(upper);
            assert_eq!(normal, DVec3::new(-slope.x, -slope.y, 1.0), "{k}");
            let middle = (a + b + c) / 3.0;
            assert_eq!((middle.x as usize, middle.y as usize), (cell % 4, cell / 4));
        }
        let of = |part: usize| parts.iter().skip(part).step_by(3).copied();
        for (part, name) in ["min", "max"].into_iter().enumerate() {
            let said = document["accessors"][0][name].as_array().expect("three numbers");
            for (k, said) in said.iter().enumerate() {
                let wanted =
                    if part == 0 { of(k).fold(f32::MAX, f32::min) } else { of(k).fold(f32::MIN, f32::max) };
                assert_eq!(said.as_f64(), Some(f64::from(wanted)));
            }
        }
    }
}

#[test]
fn heights_that_a_mesh_cannot_hold_are_refused() {
    let mut heights = vec![0.0; 16];
    heights[6] = 1e39;
    let why =
        glb::encode(&Heightfield::new(4, 4, true, heights), [1.0; 2]).expect_err("beyond f32").to_string();
    assert!(why.contains("height at row 1, column 2 is 1e39") || why.contains("no finite f32"), "{why}");
}
