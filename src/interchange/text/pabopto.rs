//! pab-opto's text: one file for each direction of the light, one line a direction of the sensor.
//!
//! Heading lines begin with `#`; then `theta phi value`, degrees, in the frame of the sample. Read by Radiance's
//! `pabopto2bsdf`.

use std::fmt::Write;

use crate::interchange::Reason;
use crate::interchange::read_back::middles_deg;
use crate::table::BrdfTable;
use crate::text_decoding::decode_text_or_latin1;

/// How the values are meant.
pub const CONVENTION: &str = "one file a stop; degrees, theta from the normal, phi absolute; format BSDF: 1/sr, no cosine; \
    colorimetry CIE-Y; the middle of each bin";

/// The text of one stop of a table with one colour; a gap has no line.
pub fn write(table: &BrdfTable, stop: usize) -> Reason<String> {
    let (theta_i, phi_i) = table.grid.stop_deg(stop);
    let mut text = format!(
        "#sample_name \"gonio\"\n#format: theta phi BSDF\n#incident_angle {theta_i} {phi_i}\n#upphi 0\n#colorimetry: CIE-Y\n"
    );
    let bins = table.grid.bins();
    for (bin, (theta, phi)) in middles_deg(&table.grid, stop).into_iter().enumerate() {
        if table.is_gap(stop * bins + bin) {
            continue;
        }
        let value = table.colours[0].total[stop * bins + bin];
        writeln!(text, "{theta} {phi} {value}").map_err(|e| e.to_string())?;
    }
    Ok(text)
}

/// The values of one file in their order, and its direction of the light in degrees.
pub fn read(bytes: &[u8]) -> Reason<([f64; 2], Vec<f32>)> {
    let text = decode_text_or_latin1(bytes)?;
    let (mut light, mut values) = (None, Vec::new());
    for (k, line) in text.lines().enumerate() {
        let numbers = |text: &str| {
            text.split_whitespace().map(|cell| cell.parse::<f64>().ok()).collect::<Option<Vec<_>>>()
        };
        if let Some(rest) = line.strip_prefix("#incident_angle") {
            light = numbers(rest).filter(|angles| angles.len() == 2).map(|angles| [angles[0], angles[1]]);
        } else if !line.starts_with('#') && !line.trim().is_empty() {
            let found =
                numbers(line).filter(|n| n.len() == 3 && n.iter().all(|n| n.is_finite()) && n[2] >= 0.0);
            values.push(
                found.ok_or_else(|| format!("line {}: theta, phi and a value needed", k + 1))?[2] as f32,
            );
        }
    }
    Ok((light.ok_or("no #incident_angle: not a pab-opto file")?, values))
}
