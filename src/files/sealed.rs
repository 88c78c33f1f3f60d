//! Binary files of the program's own: a line that says what they are, a length, a checksum, the content.

use std::io::{self, Read};

use sha2::{Digest, Sha256};

const LENGTH: usize = 8;
const CHECKSUM: usize = 32;
/// Bytes that are read at a time.
const PIECE: usize = 1 << 16;

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
// Tested by `every_cut_and_every_flipped_bit_is_noticed`.
pub fn open<'a>(kind: &str, bytes: &'a [u8]) -> Result<&'a [u8], String> {
    let (wanted, checksum, content) = promised(kind, bytes)?;
    let length = content.len() as u64;
    // Of another length there is nothing to be summed.
    let found = if length == wanted { Sha256::digest(content).to_vec() } else { Vec::new() };
    whole((length, wanted), &found, checksum).map(|()| content)
}

/// Reads a file of this `kind` to its end and holds it to its checksum, never more than `most` bytes and a piece in
/// memory; hands back the beginning of its content, up to `most` bytes, or what is wrong with it.
// Tested by `every_cut_and_every_flipped_bit_is_noticed`.
pub fn checked(kind: &str, from: &mut impl Read, most: usize) -> io::Result<Result<Vec<u8>, String>> {
    let mut head = Vec::new();
    from.by_ref().take((kind.len() + 1 + LENGTH + CHECKSUM) as u64).read_to_end(&mut head)?;
    let (wanted, checksum) = match promised(kind, &head) {
        Ok((wanted, checksum, _)) => (wanted, *checksum),
        Err(why) => return Ok(Err(why)),
    };
    let (mut begin, mut length, mut digest) = (Vec::new(), 0, Sha256::new());
    let mut piece = vec![0; PIECE];
    loop {
        let read = match from.read(&mut piece) {
            Ok(0) => break,
            Ok(read) => read,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(e),
        };
        digest.update(&piece[..read]);
        begin.extend_from_slice(&piece[..read.min(most - begin.len())]);
        length += read as u64;
    }
    Ok(whole((length, wanted), &digest.finalize()[..], &checksum).map(|()| begin))
}

/// What the head of a file of this kind says of its content, length and checksum, and what follows it.
fn promised<'a>(kind: &str, bytes: &'a [u8]) -> Result<(u64, &'a [u8; CHECKSUM], &'a [u8]), String> {
    let head = kind.len() + 1;
    let cut = || format!("cut off: {} bytes", bytes.len());
    let (line, rest) = bytes.split_at_checked(head).ok_or_else(cut)?;
    if line[..kind.len()] != *kind.as_bytes() || line[kind.len()] != b'\n' {
        let what = if line.starts_with(b"gonio ") {
            "is of another version or kind"
        } else {
            "is none of this program"
        };
        return Err(format!("{what}: it does not begin with `{kind}`"));
    }
    let parts = rest.split_first_chunk().and_then(|(length, rest)| Some((length, rest.split_first_chunk()?)));
    let (length, (checksum, content)) = parts.ok_or_else(cut)?;
    Ok((u64::from_le_bytes(*length), checksum, content))
}

/// Whether a content of this length and checksum is the one that was promised.
fn whole((length, wanted): (u64, u64), found: &[u8], checksum: &[u8]) -> Result<(), String> {
    if length != wanted {
        return Err(format!("{length} bytes of content, {wanted} needed"));
    }
    if found != checksum {
        return Err("its checksum is wrong: the file is damaged".into());
    }
    Ok(())
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
        let checked = |kind: &str, mut bytes: &[u8], most| checked(kind, &mut bytes, most).expect("readable");
        for most in [0, 4, content.len(), 1000] {
            let begin = &content[..most.min(content.len())];
            assert_eq!(checked("gonio test 1", &sealed, most).as_deref(), Ok(begin));
        }
        let refused = |kind: &str, bytes: &[u8]| {
            let why = open(kind, bytes).expect_err("damaged");
            assert_eq!(checked(kind, bytes, 4), Err(why.clone()));
            why
        };
        (0..sealed.len()).for_each(|length| drop(refused("gonio test 1", &sealed[..length])));
        for bit in 0..8 * sealed.len() {
            let mut flipped = sealed.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            refused("gonio test 1", &flipped);
        }
        assert!(refused("gonio test 2", &sealed).contains("gonio test 2"));
    }
}
