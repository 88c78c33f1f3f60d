//! Files of Gwyddion 2 (`.gwy`): a tree of named values, of which the data fields `/0/data`, `/1/data` .. are the maps.
//!
//! `GWYP`, then objects: a name that a NUL ends, a length of four bytes, and components: a name, a letter for the type, and the
//! value; capital letters are arrays with their number of values in front. Source: the file format in Gwyddion's user guide.

use super::raw::at;
use super::{MapReader, units};
use crate::error::Checked;
use crate::files::memory;
use crate::surface::io::samples::{MapSamples, Stored};

const MAGIC: &[u8] = b"GWYP";
/// Data fields that a message names at most.
const MOST_NAMED: usize = 8;

pub struct Gwy;

impl MapReader for Gwy {
    fn name(&self) -> &'static str {
        "GWY"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(MAGIC)
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        Ok(2 * bytes.len() as u64)
    }

    fn has_channels(&self) -> bool {
        true
    }

    fn read(&self, bytes: &[u8], channel: Option<&str>) -> Checked<MapSamples> {
        Ok(read(bytes, channel).map_err(|why| format!("GWY: {why}"))?)
    }
}

/// A data field of the file.
#[derive(Default)]
struct Channel<'a> {
    /// `0` of `/0/data`.
    number: String,
    title: Option<String>,
    field: Option<Components<'a>>,
    has_mask: bool,
}

impl Channel<'_> {
    fn called(&self) -> String {
        format!("{} `{:.40}`", self.number, self.title.as_deref().unwrap_or(""))
    }

    /// The unit of its heights; empty without one.
    fn unit(&self) -> Result<String, String> {
        self.field.as_ref().map_or(Ok(String::new()), |field| unit(field, "si_unit_z"))
    }
}

fn read(bytes: &[u8], wanted: Option<&str>) -> Result<MapSamples, String> {
    let (name, components) = object(&bytes[MAGIC.len()..])?;
    if name != "GwyContainer" {
        return Err(format!("begins with a `{name:.40}`, no GwyContainer"));
    }
    let channels = channels(components)?;
    let chosen = choose(&channels, wanted)?;
    let field = chosen.field.as_ref().ok_or("no data field")?;
    let mut map = samples(field)?;
    if chosen.has_mask {
        map.notes.push("GWY: the mask over the map is not read: heights under it count as they are".into());
    }
    Ok(map)
}

fn channels(components: Components<'_>) -> Result<Vec<Channel<'_>>, String> {
    let mut channels: Vec<Channel> = Vec::new();
    for component in components {
        let (name, value) = component?;
        let Some((number, rest)) = name.strip_prefix('/').and_then(|name| name.split_once('/')) else {
            continue;
        };
        if !number.bytes().all(|byte| byte.is_ascii_digit()) {
            continue;
        }
        let at = channels.iter().position(|channel| channel.number == number).unwrap_or_else(|| {
            channels.push(Channel { number: number.into(), ..Channel::default() });
            channels.len() - 1
        });
        match (rest, value) {
            ("data", Value::Object("GwyDataField", field)) => channels[at].field = Some(field),
            ("data/title", Value::Text(title)) => channels[at].title = Some(title),
            ("mask", Value::Object(..)) => channels[at].has_mask = true,
            _ => {}
        }
    }
    channels.retain(|channel| channel.field.is_some());
    // Gwyddion writes them in the order of their names, 10 before 2.
    channels.sort_by_key(|channel| channel.number.parse::<u64>().unwrap_or(u64::MAX));
    Ok(channels)
}

/// Channels as a message names them.
fn named(channels: &[&Channel<'_>]) -> String {
    let mut names: Vec<String> = channels.iter().take(MOST_NAMED).map(|channel| channel.called()).collect();
    if channels.len() > MOST_NAMED {
        names.push("..".into());
    }
    names.join(", ")
}

/// The channel of a name or a number; without one the only channel of heights.
fn choose<'a, 'b>(channels: &'b [Channel<'a>], wanted: Option<&str>) -> Result<&'b Channel<'a>, String> {
    let all: Vec<&Channel> = channels.iter().collect();
    if let Some(wanted) = wanted {
        let titled = channels.iter().find(|channel| channel.title.as_deref() == Some(wanted));
        let found = titled.or_else(|| channels.iter().find(|channel| channel.number == wanted));
        return found.ok_or_else(|| {
            format!("no channel `{wanted:.40}` among {}: see surface.file.channel", named(&all))
        });
    }
    let mut heights = Vec::new();
    for channel in channels {
        if units::metres(&channel.unit()?).is_some() {
            heights.push(channel);
        }
    }
    let how = "as surface.file.channel, by title or number";
    match (&heights[..], channels) {
        ([], []) => Err("no map in the file".into()),
        ([one], _) => Ok(one),
        ([], [one]) => Ok(one),
        ([], _) => Err(format!("no channel has a length for its unit: name one of {} {how}", named(&all))),
        _ => Err(format!("several channels of heights: name one of {} {how}", named(&heights))),
    }
}

fn samples(field: &Components<'_>) -> Result<MapSamples, String> {
    let (mut counts, mut sizes, mut data) = ([0usize; 2], [f64::NAN; 2], None);
    for component in field.clone() {
        match component? {
            ("xres", Value::Whole(count)) => counts[0] = count as usize,
            ("yres", Value::Whole(count)) => counts[1] = count as usize,
            ("xreal", Value::Float(size)) => sizes[0] = size,
            ("yreal", Value::Float(size)) => sizes[1] = size,
            ("data", Value::Floats(values)) => data = Some(values),
            _ => {}
        }
    }
    let ([columns, rows], data) = (counts, data.ok_or("a data field without data")?);
    if columns.checked_mul(rows).and_then(|count| count.checked_mul(8)) != Some(data.len()) || data.is_empty()
    {
        return Err(format!(
            "{} bytes of data do not make {columns} x {rows} heights of 8 bytes",
            data.len()
        ));
    }
    let mut heights = memory::room(columns * rows)?;
    heights.extend(data.as_chunks::<8>().0.iter().map(|eight| f64::from_le_bytes(*eight)));
    let pitch = [sizes[0] / columns as f64, sizes[1] / rows as f64];
    let (lateral, height) = (unit(field, "si_unit_xy")?, unit(field, "si_unit_z")?);
    let map = MapSamples::new(columns, rows, heights, Stored::Exact);
    Ok(map.with_units("GWY", pitch, [&lateral, &lateral], &height))
}

/// The unit of a field by the name of its component.
fn unit(field: &Components<'_>, name: &str) -> Result<String, String> {
    for component in field.clone() {
        if let (found, Value::Object(_, parts)) = component?
            && found == name
        {
            for part in parts {
                if let ("unitstr", Value::Text(unit)) = part? {
                    return Ok(unit);
                }
            }
        }
    }
    Ok(String::new())
}

/// The value of a component, as far as maps need it.
enum Value<'a> {
    Whole(u32),
    Float(f64),
    /// An array of doubles as its bytes.
    Floats(&'a [u8]),
    Text(String),
    Object(&'a str, Components<'a>),
    Other,
}

/// The components of an object, read one after the other.
#[derive(Clone)]
struct Components<'a> {
    bytes: &'a [u8],
}

/// An object's name and components.
fn object(bytes: &[u8]) -> Result<(&str, Components<'_>), String> {
    let mut rest = Components { bytes };
    let name = rest.text()?;
    let length = u32::from_le_bytes(rest.array()?) as usize;
    Ok((name, Components { bytes: rest.bytes(length)? }))
}

impl<'a> Components<'a> {
    fn bytes(&mut self, length: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.bytes.split_at_checked(length).ok_or("the file is cut off, or damaged")?;
        self.bytes = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let taken = self.bytes(N)?;
        at(taken, 0, "a value")
    }

    /// Up to a NUL.
    fn text(&mut self) -> Result<&'a str, String> {
        let length = self.bytes.iter().position(|byte| *byte == 0).ok_or("a name that does not end")?;
        let text = self.bytes(length)?;
        self.bytes(1)?;
        std::str::from_utf8(text).map_err(|_| "a name that is not UTF-8".into())
    }

    fn value(&mut self, kind: u8) -> Result<Value<'a>, String> {
        let size = |kind: u8| match kind {
            b'b' | b'c' => Some(1),
            b'i' => Some(4),
            b'q' | b'd' => Some(8),
            _ => None,
        };
        if let Some(size) = size(kind.to_ascii_lowercase()) {
            if kind.is_ascii_uppercase() {
                let count = u32::from_le_bytes(self.array()?) as usize;
                let values = self.bytes(count.saturating_mul(size))?;
                return Ok(if kind == b'D' { Value::Floats(values) } else { Value::Other });
            }
            return Ok(match kind {
                b'i' => Value::Whole(u32::from_le_bytes(self.array()?)),
                b'd' => Value::Float(f64::from_le_bytes(self.array()?)),
                _ => {
                    self.bytes(size)?;
                    Value::Other
                }
            });
        }
        let count = if kind.is_ascii_uppercase() { u32::from_le_bytes(self.array()?) } else { 1 };
        let mut last = Value::Other;
        for _ in 0..count {
            last = match kind.to_ascii_lowercase() {
                b's' => Value::Text(self.text()?.to_string()),
                b'o' => {
                    let name = self.text()?;
                    let length = u32::from_le_bytes(self.array()?) as usize;
                    Value::Object(name, Components { bytes: self.bytes(length)? })
                }
                other => return Err(format!("a value of type {:?}", char::from(other))),
            };
        }
        Ok(if kind.is_ascii_uppercase() { Value::Other } else { last })
    }
}

impl<'a> Iterator for Components<'a> {
    type Item = Result<(&'a str, Value<'a>), String>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.bytes.is_empty() {
            return None;
        }
        let mut component = || {
            let name = self.text()?;
            let [kind] = self.array()?;
            Ok((name, self.value(kind)?))
        };
        let found = component();
        if found.is_err() {
            // A damaged object ends here.
            self.bytes = &[];
        }
        Some(found)
    }
}
