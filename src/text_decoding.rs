//! The characters of a text file: UTF-8 and UTF-16 by their byte order marks, Latin-1 where the caller or the file's
//! own declaration allows it.

use std::borrow::Cow;

/// A reason, to be completed with the file's path.
type Reason<T> = Result<T, String>;

const UTF8_MARK: &[u8] = &[0xef, 0xbb, 0xbf];
/// How far into a file its XML declaration may reach, bytes.
const DECLARATION: usize = 400;

/// The text of a file in UTF-8, with or without a byte order mark, or in UTF-16 with one; the mark is no part of it.
// Tested by `marks_say_how_a_text_is_written`.
pub fn decode_text(bytes: &[u8]) -> Reason<Cow<'_, str>> {
    match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes).map(Cow::Owned),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes).map(Cow::Owned),
        _ => {
            let (text, mark) = bytes.strip_prefix(UTF8_MARK).map_or((bytes, 0), |rest| (rest, 3));
            let text = std::str::from_utf8(text).map_err(|e| {
                format!("byte {} is not UTF-8; save the file as UTF-8 text", e.valid_up_to() + mark)
            })?;
            Ok(Cow::Borrowed(text))
        }
    }
}

/// The same; a text that is no UTF-8 and has no mark is taken to be Latin-1, whose bytes are all characters.
///
/// For formats whose keys and numbers are ASCII and whose comments may be anything.
pub fn decode_text_or_latin1(bytes: &[u8]) -> Reason<Cow<'_, str>> {
    match decode_text(bytes) {
        Err(_) if !has_mark(bytes) => Ok(Cow::Owned(latin1(bytes))),
        decoded => decoded,
    }
}

/// The bytes of a file that begins with text and may go on with numbers: without a mark, and UTF-16 as UTF-8.
// Tested by `a_file_that_only_begins_with_text_loses_its_mark`.
pub fn without_mark(bytes: &[u8]) -> Reason<Cow<'_, [u8]>> {
    match bytes.strip_prefix(UTF8_MARK) {
        Some(rest) => Ok(Cow::Borrowed(rest)),
        None if has_mark(bytes) => Ok(Cow::Owned(decode_text(bytes)?.into_owned().into_bytes())),
        None => Ok(Cow::Borrowed(bytes)),
    }
}

/// The text of an XML file: by its mark, else in the encoding that its declaration names, else UTF-8.
// Tested by `xml_is_read_in_the_encoding_that_it_declares`.
pub fn decode_xml(bytes: &[u8]) -> Reason<Cow<'_, str>> {
    match bytes {
        // UTF-16 without a mark: `<` and half a zero.
        [b'<', 0, ..] => return utf16(bytes, u16::from_le_bytes).map(Cow::Owned),
        [0, b'<', ..] => return utf16(bytes, u16::from_be_bytes).map(Cow::Owned),
        _ if has_mark(bytes) => return decode_text(bytes),
        _ => {}
    }
    let declared = declared_encoding(&bytes[..bytes.len().min(DECLARATION)]);
    match declared.as_deref() {
        None | Some("utf-8" | "utf8" | "us-ascii" | "ascii") => decode_text(bytes),
        // The three differ in signs that no number and no name of an element has.
        Some("iso-8859-1" | "latin1" | "latin-1" | "iso-8859-15" | "windows-1252" | "cp1252") => {
            Ok(Cow::Owned(latin1(bytes)))
        }
        // The declaration outlived a conversion, or the text is plain ASCII.
        Some(name) => decode_text(bytes).map_err(|_| {
            format!("encoding {name:?} is not read; save the file as UTF-8, UTF-16 or ISO-8859-1")
        }),
    }
}

fn has_mark(bytes: &[u8]) -> bool {
    bytes.starts_with(UTF8_MARK) || bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff])
}

/// Every byte is the character of its number.
fn latin1(bytes: &[u8]) -> String {
    bytes.iter().map(|&byte| char::from(byte)).collect()
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Reason<String> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    if !rest.is_empty() {
        return Err("UTF-16 with half a character at its end: the file is cut off".into());
    }
    let decoded: Result<String, _> = char::decode_utf16(pairs.iter().map(|&pair| unit(pair))).collect();
    decoded.map_err(|_| "not UTF-16, although its first bytes say so; save the file as UTF-8".into())
}

/// What stands behind `encoding=` in `<?xml ... ?>`, in small letters.
fn declared_encoding(head: &[u8]) -> Option<String> {
    let text = latin1(head);
    let declaration = text.strip_prefix("<?xml")?.split_once("?>")?.0;
    let value = declaration.split_once("encoding")?.1.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    Some(value[1..].split_once(quote)?.0.trim().to_ascii_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A degree sign and a character outside the basic plane.
    const TEXT: &str = "25 \u{b0}C \u{1d70c}";

    fn units(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(bytes).collect()
    }

    #[test]
    fn marks_say_how_a_text_is_written() {
        let (little, big) = (units(TEXT, u16::to_le_bytes), units(TEXT, u16::to_be_bytes));
        let marked = |mark: &[u8], rest: &[u8]| [mark, rest].concat();
        for bytes in [
            TEXT.as_bytes().to_vec(),
            marked(UTF8_MARK, TEXT.as_bytes()),
            marked(&[0xff, 0xfe], &little),
            marked(&[0xfe, 0xff], &big),
        ] {
            assert_eq!(decode_text(&bytes).expect("a text"), TEXT);
            assert_eq!(decode_text_or_latin1(&bytes).expect("a text"), TEXT);
        }
        // ISO/IEC 8859-1: 0xb0 is the degree sign.
        let latin = b"25 \xb0C";
        assert!(decode_text(latin).expect_err("no UTF-8").contains("byte 3"));
        assert_eq!(decode_text_or_latin1(latin).expect("any byte"), "25 \u{b0}C");
        // A mark that is followed by something else is no Latin-1.
        assert!(decode_text_or_latin1(&[0xff, 0xfe, 0x00, 0xdc]).is_err());
        assert!(decode_text_or_latin1(&[0xff, 0xfe, b'a']).expect_err("odd").contains("cut off"));
        assert!(decode_text_or_latin1(&marked(UTF8_MARK, b"\xb0")).expect_err("no UTF-8").contains("byte 3"));
        assert_eq!(decode_text(b"").expect("empty"), "");
    }

    #[test]
    fn a_file_that_only_begins_with_text_loses_its_mark() {
        let mixed = b"DATA binary\n\xff\xfe\x00\x80";
        let marked = [UTF8_MARK, mixed].concat();
        assert_eq!(&*without_mark(mixed).expect("no mark"), mixed);
        assert_eq!(&*without_mark(&marked).expect("a mark"), mixed);
        let wide = [&[0xff, 0xfe][..], &units(TEXT, u16::to_le_bytes)].concat();
        assert_eq!(&*without_mark(&wide).expect("UTF-16"), TEXT.as_bytes());
    }

    #[test]
    fn xml_is_read_in_the_encoding_that_it_declares() {
        let body = |encoding: &str| format!("<?xml version=\"1.0\" encoding='{encoding}'?><a>\u{b0}</a>");
        let latin = |text: &str| text.chars().map(|c| c as u8).collect::<Vec<u8>>();
        let utf8 = body("UTF-8");
        assert_eq!(decode_xml(utf8.as_bytes()).expect("read"), utf8);
        let text = body("ISO-8859-1");
        assert_eq!(decode_xml(&latin(&text)).expect("read"), text);
        // UTF-16 with and without a mark.
        let text = body("UTF-16");
        for bytes in [units(&text, u16::to_le_bytes), units(&text, u16::to_be_bytes)] {
            assert_eq!(decode_xml(&bytes).expect("read"), text);
        }
        assert_eq!(decode_xml(&units(&format!("\u{feff}{text}"), u16::to_le_bytes)).expect("read"), text);
        // Declared UTF-16, but converted to UTF-8 since: the bytes are right.
        assert_eq!(decode_xml(text.as_bytes()).expect("read"), text);
        assert!(decode_xml(&latin(&body("Shift_JIS"))).expect_err("unknown").contains("shift_jis"));
        assert!(decode_xml(&latin(&body("utf-8"))).expect_err("a lie").contains("is not UTF-8"));
        assert_eq!(decode_xml(b"<a/>").expect("read"), "<a/>");
    }
}
