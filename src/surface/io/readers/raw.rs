//! Numbers as binary files hold them.

use crate::files::memory;

/// `N` bytes at a place; the error names what they should have been.
pub fn at<const N: usize>(bytes: &[u8], place: usize, what: &str) -> Result<[u8; N], String> {
    let found = bytes.get(place..).and_then(|rest| rest.first_chunk());
    found.copied().ok_or_else(|| format!("the file ends before {what}"))
}

/// A text of `length` bytes at a place: up to its first NUL, without blanks round it, in UTF-8 or else Latin-1.
pub fn text(bytes: &[u8], place: usize, length: usize) -> String {
    let field = bytes.get(place..).unwrap_or_default();
    let field = field[..length.min(field.len())].split(|byte| *byte == 0).next().unwrap_or_default();
    let latin1 = || field.iter().map(|byte| char::from(*byte)).collect();
    std::str::from_utf8(field).map_or_else(|_| latin1(), String::from).trim().to_string()
}

/// The reason of another library, short and in one line.
pub fn short(why: impl std::fmt::Display) -> String {
    why.to_string().chars().take(160).map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// The types of numbers that files hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    F32,
    F64,
}

impl Number {
    /// Bytes of one.
    pub fn size(self) -> usize {
        match self {
            Number::U8 | Number::I8 => 1,
            Number::U16 | Number::I16 => 2,
            Number::U32 | Number::I32 | Number::F32 => 4,
            Number::F64 => 8,
        }
    }

    /// The smallest and the largest of them.
    pub fn ends(self) -> [f64; 2] {
        match self {
            Number::U8 => [0.0, f64::from(u8::MAX)],
            Number::I8 => [f64::from(i8::MIN), f64::from(i8::MAX)],
            Number::U16 => [0.0, f64::from(u16::MAX)],
            Number::I16 => [f64::from(i16::MIN), f64::from(i16::MAX)],
            Number::U32 => [0.0, f64::from(u32::MAX)],
            Number::I32 => [f64::from(i32::MIN), f64::from(i32::MAX)],
            Number::F32 => [f64::from(f32::MIN), f64::from(f32::MAX)],
            Number::F64 => [f64::MIN, f64::MAX],
        }
    }

    /// `columns` x `rows` of them, little-endian, each turned by `to`: the bytes must be as many as that.
    pub fn read(
        self,
        bytes: &[u8],
        [columns, rows]: [usize; 2],
        to: impl Fn(f64) -> f64,
    ) -> Result<Vec<f64>, String> {
        let count = columns.checked_mul(rows).filter(|count| *count > 0);
        if count.and_then(|count| count.checked_mul(self.size())) != Some(bytes.len()) {
            return Err(format!(
                "{} bytes of data do not make {columns} x {rows} heights of {} bytes",
                bytes.len(),
                self.size()
            ));
        }
        let mut heights = memory::room(bytes.len() / self.size())?;
        match self {
            Number::U8 => heights.extend(bytes.iter().map(|byte| to(f64::from(*byte)))),
            Number::I8 => heights.extend(bytes.iter().map(|byte| to(f64::from(*byte as i8)))),
            Number::U16 => extend(&mut heights, bytes, |four| to(f64::from(u16::from_le_bytes(four)))),
            Number::I16 => extend(&mut heights, bytes, |four| to(f64::from(i16::from_le_bytes(four)))),
            Number::U32 => extend(&mut heights, bytes, |four| to(f64::from(u32::from_le_bytes(four)))),
            Number::I32 => extend(&mut heights, bytes, |four| to(f64::from(i32::from_le_bytes(four)))),
            Number::F32 => extend(&mut heights, bytes, |four| to(f64::from(f32::from_le_bytes(four)))),
            Number::F64 => extend(&mut heights, bytes, |eight| to(f64::from_le_bytes(eight))),
        }
        Ok(heights)
    }
}

fn extend<const N: usize>(heights: &mut Vec<f64>, bytes: &[u8], to: impl Fn([u8; N]) -> f64) {
    heights.extend(bytes.as_chunks::<N>().0.iter().map(|number| to(*number)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_reads_its_ends_and_counts_its_bytes() {
        let all = |kind: Number, bytes: &[u8]| kind.read(bytes, [2, 1], |h| h).expect("two numbers");
        assert_eq!(all(Number::U8, &[0, 255]), Number::U8.ends());
        assert_eq!(all(Number::I8, &[0x80, 0x7f]), Number::I8.ends());
        assert_eq!(all(Number::I16, &[0x00, 0x80, 0xff, 0x7f]), Number::I16.ends());
        assert_eq!(all(Number::U32, &[0, 0, 0, 0, 255, 255, 255, 255]), Number::U32.ends());
        let floats: Vec<u8> = [f32::MIN, f32::MAX].iter().flat_map(|f| f.to_le_bytes()).collect();
        assert_eq!(all(Number::F32, &floats), Number::F32.ends());
        let why = Number::F64.read(&[0; 15], [2, 1], |h| h).expect_err("15 bytes");
        assert!(why.contains("15 bytes of data do not make 2 x 1 heights of 8 bytes"), "{why}");
        assert!(Number::U8.read(&[], [0, 3], |h| h).is_err());
    }

    #[test]
    fn fields_end_with_the_file() {
        assert_eq!(at::<2>(&[1, 2, 3], 1, "a count"), Ok([2, 3]));
        assert_eq!(at::<2>(&[1, 2, 3], 2, "a count"), Err("the file ends before a count".into()));
        assert_eq!(text(b"\xb5m \0junk", 0, 16), "\u{b5}m");
        assert_eq!(text(b"\xc2\xb5m\0junk", 0, 16), "\u{b5}m");
        assert_eq!(text(b"mm", 5, 4), "");
        assert_eq!(short(format!("a\n{}", "b".repeat(200))).len(), 160);
    }
}
