//! The digest of a table's content, taken row by row: what the file's `gonio.digest` says.
//!
//! SHA-256 over every `gonio.` text of the part but the digest itself (name, length in bytes, text: campaign, version,
//! seed, grid, ...) and, for every channel by name, its name, type, number of values and the SHA-256 of its
//! little-endian values. One sum runs for each channel, so that rows can come and go.

use std::borrow::Cow;
use std::collections::BTreeMap;

use sha2::{Digest, Sha256};

use crate::files;
use crate::files::image::{Attribute, ImagePart, Samples};

/// An unfinished digest.
#[derive(Default)]
pub(super) struct ContentDigest {
    channels: BTreeMap<String, ChannelDigest>,
}

#[derive(Clone)]
struct ChannelDigest {
    kind: &'static str,
    count: u64,
    sum: Sha256,
}

/// Name of the digest's attribute, the one text that it does not hold.
pub(super) const DIGEST: &str = "gonio.digest";

impl ContentDigest {
    /// Adds further values of a channel: their type, and their bytes in the machine's order.
    pub fn add(&mut self, name: &str, kind: &Samples, bytes: &[u8]) {
        let (kind, size) = match kind {
            Samples::F32(_) => ("FLOAT", 4),
            Samples::U32(_) => ("UINT", 4),
            Samples::F16(_) => ("HALF", 2),
        };
        if !self.channels.contains_key(name) {
            self.channels.insert(name.into(), ChannelDigest { kind, count: 0, sum: Sha256::new() });
        }
        if let Some(channel) = self.channels.get_mut(name) {
            channel.count += (bytes.len() / size) as u64;
            channel.sum.update(little_endian(bytes, size));
        }
    }

    /// Adds all values of a channel.
    pub fn add_samples(&mut self, name: &str, samples: &Samples) {
        const SOME: usize = 1 << 14;
        // A channel without values has a name all the same.
        self.add(name, samples, &[]);
        for first in (0..samples.len()).step_by(SOME) {
            let bytes = samples.bytes(first..samples.len().min(first + SOME));
            self.add(name, samples, &bytes);
        }
    }

    /// 64 hex digits; the texts are those of `part`.
    pub fn finish(&self, part: &ImagePart) -> String {
        let texts = part.attributes.iter().filter_map(|(name, value)| match value {
            Attribute::Text(text) if name.starts_with("gonio.") && name != DIGEST => Some((name, text)),
            _ => None,
        });
        let line = |(name, text): (&String, &String)| format!("{name} {}\n{text}\n", text.len());
        self.of_head(&format!("gonio digest 3\n{}", texts.map(line).collect::<String>()))
    }

    /// What versions before digest 3 wrote, which left out all texts but two: known to be named, not to be trusted.
    pub fn finish_2(&self, grid: &str, patches: &str) -> String {
        self.of_head(&format!("gonio digest 2\n{grid}\n{patches}\n"))
    }

    fn of_head(&self, head: &str) -> String {
        let mut all = Sha256::new();
        all.update(head);
        for (name, ChannelDigest { kind, count, sum }) in &self.channels {
            all.update(format!("{name} {kind} {count} {}\n", files::hex(&sum.clone().finalize())));
        }
        files::hex(&all.finalize())
    }
}

fn little_endian(bytes: &[u8], size: usize) -> Cow<'_, [u8]> {
    if cfg!(target_endian = "little") {
        return Cow::Borrowed(bytes);
    }
    bytes.chunks(size).flat_map(|value| value.iter().rev().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_follows_its_definition_and_not_the_pieces() {
        let values = [0.5f32, -1.0, 3.25];
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let channel = files::sha256_hex(&bytes);
        let head = "gonio digest 3\ngonio.campaign 3\n\u{b5}\n\ngonio.grid 1\ng\n";
        let wanted = files::sha256_hex(format!("{head}Y FLOAT 3 {channel}\n").as_bytes());
        let mut part = ImagePart::default();
        for (name, text) in
            [("gonio.grid", "g"), ("gonio.campaign", "\u{b5}\n"), (DIGEST, "d"), ("owner", "o")]
        {
            part.set_text(name, text);
        }
        let mut whole = ContentDigest::default();
        whole.add_samples("Y", &Samples::F32(values.to_vec()));
        assert_eq!(whole.finish(&part), wanted);
        let mut pieces = ContentDigest::default();
        for value in values {
            pieces.add("Y", &Samples::F32(vec![]), &value.to_ne_bytes());
        }
        assert_eq!(pieces.finish(&part), wanted);
    }
}
