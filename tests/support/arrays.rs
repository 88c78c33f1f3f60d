//! NPY files, well-formed in all but what a test changes.

/// The header of an array of this kind (`<f8`) and shape (`(2, 3)`).
pub fn npy_header(kind: &str, shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = u16::try_from(header.len()).expect("short").to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes()].concat()
}

/// `columns` x `rows` heights of f64, row by row.
pub fn npy(heights: &[f64], columns: usize) -> Vec<u8> {
    let mut bytes = npy_header("<f8", &format!("({}, {columns})", heights.len() / columns));
    bytes.extend(heights.iter().flat_map(|height| height.to_le_bytes()));
    bytes
}

/// The same as f32.
pub fn npy_f32(heights: &[f64], columns: usize) -> Vec<u8> {
    let mut bytes = npy_header("<f4", &format!("({}, {columns})", heights.len() / columns));
    bytes.extend(heights.iter().flat_map(|height| (*height as f32).to_le_bytes()));
    bytes
}
