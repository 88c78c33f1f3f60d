//! OpenEXR images of one channel, or with a channel `height`; attributes `pitch_x` and `pitch_y` in the unit of the heights.

use std::io::Cursor;

use super::MapReader;
use crate::error::Checked;
use crate::files::exr_header;
use crate::files::image;
use crate::files::image::Samples;
use crate::files::image_blocks::BlockReader;
use crate::surface::io::samples::{MapSamples, Stored};

pub struct Exr;

impl MapReader for Exr {
    fn name(&self) -> &'static str {
        "EXR"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        exr_header::is_exr(bytes)
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        // Heights in f64 are four times as long as halves.
        Ok(BlockReader::open(Cursor::new(bytes))?.bytes().saturating_mul(8))
    }

    fn has_channels(&self) -> bool {
        true
    }

    fn read(&self, bytes: &[u8], channel: Option<&str>) -> Checked<MapSamples> {
        let mut parts = image::decode(bytes)?;
        let (Some(mut part), true) = (parts.pop(), parts.is_empty()) else {
            return Err("several parts; a height map has one".into());
        };
        let names: Vec<String> = part.channels.keys().cloned().collect();
        let samples = match (part.channels.remove(channel.unwrap_or("height")), channel, names.as_slice()) {
            (Some(samples), ..) => samples,
            (None, None, [only]) => part.channels.remove(only).ok_or("no channels")?,
            (None, Some(channel), _) => {
                return Err(format!(
                    "no channel `{channel}` among {}: see surface.file.channel",
                    names.join(", ")
                )
                .into());
            }
            (None, None, _) => {
                let names = names.join(", ");
                return Err(
                    format!("no channel `height` among {names}: name one as surface.file.channel").into()
                );
            }
        };
        let (heights, stored) = match samples {
            Samples::F32(values) => (values.into_iter().map(f64::from).collect(), Stored::Single),
            Samples::F16(values) => (values.into_iter().map(|v| v.to_f64()).collect(), Stored::Half),
            Samples::U32(values) => (values.into_iter().map(f64::from).collect(), Stored::Exact),
        };
        let pitch = [part.number("pitch_x"), part.number("pitch_y")];
        Ok(MapSamples { pitch, ..MapSamples::new(part.width, part.height, heights, stored) })
    }
}
