//! pab-opto's text: one file for each direction of the light, one line a direction of the sensor.
//!
//! Heading lines begin with `#`; then `theta phi value`, degrees, in the frame of the sample. Read by Radiance's
//! `pabopto2bsdf`.

use std::path::Path;

use crate::campaign::LightSide;
use crate::files;
use crate::interchange::codec::{Codec, Encoded, FileContent, FormatTraits, Sides};
use crate::interchange::content::light::side_of;
use crate::interchange::read_back::{self, ReadBack, middles_deg};
use crate::interchange::{Checked, Imported, Options};
use crate::table::BrdfTable;
use crate::text_decoding::decode_text_or_latin1;

/// How the values are meant.
const CONVENTION: &str = "one file for each incidence; degrees, in the frame of the sample: light from the front below 90, from \
    the back beyond, phi absolute; format BSDF: 1/sr, no cosine; \
    colorimetry CIE-Y; the middle of each bin";

/// The format.
pub struct Pabopto;

impl Codec for Pabopto {
    fn traits(&self) -> FormatTraits {
        FormatTraits { gaps: true, sides: Sides::Both, colours: false, ..FormatTraits::totals("pabopto") }
    }

    fn decode(&self, _bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Err("a file has one incidence; read its folder with pabopto2bsdf, or export as ssdd".into())
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &Options) -> Checked<Encoded<'a>> {
        let files =
            (0..table.grid.incidences()).map(|incidence| (file_name(incidence), text(table, incidence)));
        let content = FileContent::Folder(Box::new(files));
        Ok(Encoded { content, convention: CONVENTION.into(), notes: vec![] })
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, _options: &Options) -> Checked<Option<ReadBack>> {
        let bins = table.grid.bins();
        let mut totals = Vec::with_capacity(table.hits.len());
        for incidence in 0..table.grid.incidences() {
            let mut values = read(&files::read(&path.join(file_name(incidence)))?)?.1.into_iter();
            let is_gap = |bin: usize| table.is_gap(incidence * bins + bin);
            totals.extend((0..bins).filter_map(|bin| if is_gap(bin) { Some(0.0) } else { values.next() }));
        }
        read_back::listed(table, &[&totals])
    }
}

fn file_name(incidence: usize) -> String {
    format!("stop_{incidence:04}.txt")
}

/// The text of one incidence of a table with one colour; a gap has no line.
pub fn text(table: &BrdfTable, incidence: usize) -> String {
    let (theta_i, phi_i) = table.grid.incidence_deg(incidence);
    // A table counts from the normal on the light's side.
    let from_back = side_of(table) == Some(LightSide::Back);
    let in_frame = |theta: f64| if from_back { 180.0 - theta } else { theta };
    let theta_i = in_frame(theta_i);
    let mut text = format!(
        "#sample_name \"gonio\"\n#format: theta phi BSDF\n#incident_angle {theta_i} {phi_i}\n#upphi 0\n#colorimetry: CIE-Y\n"
    );
    let bins = table.grid.bins();
    for (bin, (theta, phi)) in middles_deg(&table.grid, incidence).into_iter().enumerate() {
        if !table.is_gap(incidence * bins + bin) {
            text +=
                &format!("{} {phi} {}\n", in_frame(theta), table.colours[0].total[incidence * bins + bin]);
        }
    }
    text
}

/// The values of one file in their order, and its direction of the light in degrees.
pub fn read(bytes: &[u8]) -> Checked<([f64; 2], Vec<f32>)> {
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
