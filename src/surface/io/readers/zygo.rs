//! Zygo MetroPro (`.dat`): a header in big-endian order, a picture of the fringes, and phases of 32 bits.
//!
//! Height = phase x scale factor x obliquity x wavelength / resolution, metres, where the resolution is 4096, 32768 or 131072
//! (`phase_res`); phases from 2147483640 on are no data. Source: the layout that the readers of `SurfaceTopography`,
//! `surfalize` and Gwyddion share.

use super::MapReader;
use super::raw::at;
use crate::error::Checked;
use crate::files::memory;
use crate::surface::io::samples::{MapSamples, Stored};

/// The three versions of the header.
const MAGICS: [&[u8]; 3] = [b"\x88\x1b\x03\x6f", b"\x88\x1b\x03\x70", b"\x88\x1b\x03\x71"];
/// The smallest value that is no phase.
const NO_PHASE: i32 = 2_147_483_640;

pub struct MetroPro;

impl MapReader for MetroPro {
    fn name(&self) -> &'static str {
        "Zygo .dat"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        MAGICS.iter().any(|magic| bytes.starts_with(magic))
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        Ok(4 * bytes.len() as u64)
    }

    fn read(&self, bytes: &[u8], _: Option<&str>) -> Checked<MapSamples> {
        Ok(read(bytes).map_err(|why| format!("Zygo .dat: {why}"))?)
    }
}

fn read(bytes: &[u8]) -> Result<MapSamples, String> {
    let short = |place: usize| at(bytes, place, "its header ends").map(u16::from_be_bytes);
    let long = |place: usize| at(bytes, place, "its header ends").map(u32::from_be_bytes);
    let float = |place: usize| at(bytes, place, "its header ends").map(f32::from_be_bytes).map(f64::from);
    let [columns, rows] = [usize::from(short(68)?), usize::from(short(70)?)];
    if columns == 0 || rows == 0 {
        return Err(format!("phases of {columns} x {rows} points: the file holds fringes alone, no map"));
    }
    let fringes = [52, 54, 56].map(|place| short(place).map(usize::from));
    let [width, height, buckets] = fringes;
    let start = long(6)? as usize + 2 * width? * height? * buckets?;
    let resolution = match short(218)? {
        0 => 4096.0,
        1 => 32_768.0,
        2 => 131_072.0,
        other => return Err(format!("phase resolution {other}; 0, 1 and 2 are known")),
    };
    let sign = if short(232)? == 0 { 1.0 } else { -1.0 };
    let [scale, wavelength, obliquity, lateral] = [float(164)?, float(168)?, float(176)?, float(184)?];
    let unit = sign * scale * obliquity * wavelength / resolution;
    if unit == 0.0 || !unit.is_finite() {
        return Err(format!(
            "scale factor {scale}, obliquity {obliquity} and wavelength {wavelength} m make no height of a phase"
        ));
    }
    let data = bytes.get(start..).unwrap_or_default();
    let length = 4 * columns * rows;
    let Some(data) = data.get(..length) else {
        return Err(format!(
            "{} bytes of phases do not make {columns} x {rows}: the file is cut off",
            data.len()
        ));
    };
    let mut heights = memory::room(columns * rows)?;
    let phase = |four: &[u8; 4]| match i32::from_be_bytes(*four) {
        phase if phase >= NO_PHASE => f64::NAN,
        phase => unit * f64::from(phase),
    };
    heights.extend(data.as_chunks::<4>().0.iter().map(phase));
    let map = MapSamples::new(columns, rows, heights, Stored::Exact);
    if lateral > 0.0 {
        return Ok(map.with_units("Zygo .dat", [lateral; 2], ["m", "m"], "m"));
    }
    let no_pitch = "Zygo .dat: no lateral resolution: the instrument was not calibrated".to_string();
    Ok(MapSamples { no_pitch: Some(no_pitch), unit_um: Some(1e6), ..map })
}
