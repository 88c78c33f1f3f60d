//! Binary files of the program's own: a line that says what they are, a length, a checksum, the content.

use sha2::{Digest, Sha256};

const LENGTH: usize = 8;
const CHECKSUM: usize = 32;

/// The bytes of a file of this `kind` (one line, without its end) with the content that `fill` adds to a buffer; about
/// `capacity` bytes of it.
pub fn seal<E>(
    kind: &str,
    capacity: usize,
    fill: impl FnOnce(Vec<u8>) -> Result<Vec<u8>, E>,
) -> Result<Vec<u8>, E> {
    let head = kind.len() + 1 + LENGTH + CHECKSUM;
    let mut bytes = Vec::with_capacity(head + capacity);
    bytes.extend_from_slice(kind.as_bytes());
    bytes.push(b'\n');
    bytes.resize(head, 0);
    let mut bytes = fill(bytes)?;
    let length = (bytes.len() - head) as u64;
    let checksum = Sha256::digest(&bytes[head..]);
    bytes[kind.len() + 1..][..LENGTH].copy_from_slice(&length.to_le_bytes());
    bytes[kind.len() + 1 + LENGTH..head].copy_from_slice(&checksum);
    Ok(bytes)
}

/// The content of a file of this `kind`, or what is wrong with it. Nothing is copied.
///
/// Held by: `every_cut_and_every_flipped_bit_is_noticed`.
pub fn open<'a>(kind: &str, bytes: &'a [u8]) -> Result<&'a [u8], String> {
    let head = kind.len() + 1;
    let (Some(line), Some(rest)) = (bytes.get(..head), bytes.get(head..)) else {
        return Err(format!("cut off: {} bytes", bytes.len()));
    };
    if line[..kind.len()] != *kind.as_bytes() || line[kind.len()] != b'\n' {
        return Err(format!("does not begin with `{kind}`"));
    }
    let (Some(length), Some(checksum), Some(content)) =
        (rest.first_chunk::<LENGTH>(), rest.get(LENGTH..LENGTH + CHECKSUM), rest.get(LENGTH + CHECKSUM..))
    else {
        return Err(format!("cut off: {} bytes", bytes.len()));
    };
    let wanted = u64::from_le_bytes(*length);
    if content.len() as u64 != wanted {
        return Err(format!("{} bytes of content, {wanted} needed", content.len()));
    }
    if Sha256::digest(content)[..] != *checksum {
        return Err("its checksum is wrong: the file is damaged".into());
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cut_and_every_flipped_bit_is_noticed() {
        let content = b"sums of finished blocks";
        let sealed =
            seal("gonio test 1", content.len(), |bytes| Ok::<_, ()>([&bytes, &content[..]].concat()));
        let sealed = sealed.expect("filled");
        assert_eq!(open("gonio test 1", &sealed), Ok(&content[..]));
        for length in 0..sealed.len() {
            assert!(open("gonio test 1", &sealed[..length]).is_err(), "{length} bytes");
        }
        for bit in 0..8 * sealed.len() {
            let mut flipped = sealed.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            assert!(open("gonio test 1", &flipped).is_err(), "bit {bit}");
        }
        assert!(open("gonio test 2", &sealed).expect_err("another format").contains("gonio test 2"));
    }
}
