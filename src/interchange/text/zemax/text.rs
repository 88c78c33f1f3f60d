//! The text of a Zemax tabular BSDF, both ways.
//!
//! Keywords are read in any case, as the format's own pages spell them in several. Comments may be of any characters.

use std::fmt::Write;
use std::iter::Peekable;

use super::tables::Zemax;
use crate::error::wrong;
use crate::interchange::Checked;
use crate::interchange::radiance::xml::{negative_note, short};
use crate::interchange::text::azimuths::{Azimuths, SAME, widest_gap};
use crate::text_decoding::decode_text_or_latin1;

/// More numbers in a list than any file has.
const LONGEST: usize = 10_000;
/// The widest step between rotations that is interpolated over, degrees.
const WIDEST_GAP: f64 = 46.0;
/// Of light that comes back and that has gone through.
const TYPES: [&str; 2] = ["BRDF", "BTDF"];
const KEYS: [&str; 4] = ["SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial"];

/// The text of a file of one channel; azimuths that go round end where they began, as other readers do not wrap them.
pub fn text(file: &Zemax) -> String {
    let listed = |list: &[f64]| list.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let symmetry = if file.symmetric { "PlaneSymmetrical" } else { "ASymmetrical4D" };
    let seam = if file.symmetric { None } else { file.azimuths.first().map(|first| first + 360.0) };
    let azimuths: Vec<f64> = file.azimuths.iter().copied().chain(seam).collect();
    let mut text = format!(
        "# written by gonio\nSource  Measured\nSymmetry  {symmetry}\nSpectralContent  Monochrome\nScatterType  {}\n",
        TYPES[usize::from(file.through)]
    );
    for (key, list) in KEYS.iter().zip([&file.rotations, &file.light, &azimuths, &file.radials]) {
        text += &format!("{key}  {}\n{}\n", list.len(), listed(list));
    }
    text += "\nMonochrome\nDataBegin\n";
    let row = file.radials.len();
    for (block, tis) in file.values[0].chunks(file.azimuths.len() * row).zip(&file.tis[0]) {
        text += &format!("TIS {tis:.6}\n");
        let again = seam.map(|_| &block[..row]);
        for values in block.chunks(row).chain(again) {
            for value in values {
                // Writing into a String does not fail.
                let _written = write!(text, "{value:.6e} ");
            }
            text.push('\n');
        }
    }
    text + "DataEnd\n"
}

/// What stands before the data.
struct ZemaxHeader {
    through: bool,
    symmetric: bool,
    channels: &'static [&'static str],
    lists: [Vec<f64>; 4],
}

/// Reads a file; several rotations must go round. Returns notes on its values, too.
// Tested by `keywords_are_read_in_any_case_and_a_closed_seam_is_dropped`, `azimuths_go_round` and others in
// tests/it/interchange/interchange_zemax.rs.
pub fn parse(bytes: &[u8]) -> Checked<(Zemax, Vec<String>)> {
    let text = decode_text_or_latin1(bytes)?;
    let uncommented = text.lines().map(|line| line.split('#').next().unwrap_or_default());
    let mut words = uncommented.flat_map(str::split_whitespace).peekable();
    let header = header(&mut words)?;
    let [rotations, light, azimuths, radials] = &header.lists;
    let (turns, directions) = (circle(KEYS[0], rotations)?, circle(KEYS[2], azimuths)?);
    let mut file = Zemax {
        through: header.through,
        symmetric: header.symmetric,
        rotations: turns.angles.clone(),
        light: light.clone(),
        azimuths: directions.angles.clone(),
        radials: radials.clone(),
        ..Zemax::default()
    };
    check(&file, azimuths)?;
    let sizes = [rotations.len(), light.len(), azimuths.len(), radials.len()];
    let mut seen = ValueCheck::default();
    let (mut tis, mut values) = (vec![vec![]; header.channels.len()], vec![vec![]; header.channels.len()]);
    for _ in header.channels {
        let channel = channel(&mut words, header.channels)?;
        if !tis[channel].is_empty() {
            return Err(wrong!("{} is there twice", header.channels[channel]));
        }
        for _ in 0..rotations.len() * light.len() {
            tis[channel].push(block(
                &mut words,
                azimuths.len() * radials.len(),
                &mut values[channel],
                &mut seen,
            )?);
        }
        let ended = words.next_if(|word| is(word, "DataEnd")).is_some();
        if !ended && !words.peek().is_some_and(|word| header.channels[1..].iter().any(|next| is(word, next)))
        {
            return Err("DataEnd needed behind the values".into());
        }
    }
    if words.any(|word| is(word, "DataBegin") || is(word, "TIS")) {
        return Err(wrong!("more data than {} need", header.channels.join(", ")));
    }
    let equal = |a, b| a == b;
    file.tis = tis.iter().map(|tis| turns.merged(tis, [1, sizes[0], sizes[1]], equal).0).collect();
    let mut seam = 0.0f64;
    for raw in &values {
        let largest = raw.iter().fold(f64::MIN_POSITIVE, |most, &value| most.max(value));
        let (by_turn, off_turn) = turns.merged(raw, [1, sizes[0], sizes[1] * sizes[2] * sizes[3]], equal);
        let blocks = turns.angles.len() * sizes[1];
        let (all, off) = directions.merged(&by_turn, [blocks, sizes[2], sizes[3]], equal);
        seam = seam.max(off_turn.max(off) / largest);
        file.values.push(all.iter().map(|&value| value as f32).collect());
    }
    let mut notes = vec![];
    if seam > 0.0 {
        notes.push(format!(
            "values a whole turn apart differ by up to {:.1} % of the largest: their mean is taken",
            100.0 * seam
        ));
    }
    notes.extend(negative_note(seen.negative, seen.values, seen.least));
    Ok((file, notes))
}

fn is(word: &str, key: &str) -> bool {
    word.eq_ignore_ascii_case(key)
}

/// Everything up to the name of the first channel, or its data.
fn header<'a>(words: &mut Peekable<impl Iterator<Item = &'a str>>) -> Checked<ZemaxHeader> {
    let mut header =
        ZemaxHeader { through: false, symmetric: true, channels: &["Monochrome"], lists: Default::default() };
    loop {
        let word = *words.peek().ok_or("no DataBegin: not a Zemax BSDF")?;
        if is(word, "DataBegin")
            || is(word, "Monochrome")
            || word.to_ascii_lowercase().starts_with("tristimulus")
        {
            break;
        }
        words.next();
        let mut choice = |key: &str, allowed: &[&str]| {
            let value = words.next().unwrap_or_default();
            let found = allowed.iter().position(|allowed| is(value, allowed));
            found.ok_or_else(|| format!("{key} {:?}: {} needed", short(value), allowed.join(" or ")))
        };
        if is(word, "Symmetry") {
            let allowed = ["PlaneSymmetrical", "Asymmetrical", "ASymmetrical4D"];
            header.symmetric = choice("Symmetry", &allowed)? == 0;
        } else if is(word, "SpectralContent") {
            let coloured = choice("SpectralContent", &["Monochrome", "XYZ"])? == 1;
            header.channels =
                if coloured { &["TristimulusX", "TristimulusY", "TristimulusZ"] } else { &["Monochrome"] };
        } else if is(word, "ScatterType") {
            header.through = choice("ScatterType", &TYPES)? == 1;
        } else if let Some(k) = KEYS.iter().position(|key| is(word, key)) {
            header.lists[k] = list(KEYS[k], words)?;
        }
    }
    if header.lists[0].is_empty() {
        header.lists[0].push(0.0);
    }
    match KEYS.iter().zip(&header.lists).find(|(_, list)| list.is_empty()) {
        Some((key, _)) => Err(wrong!("no {key}")),
        None => Ok(header),
    }
}

/// A number of angles, and the angles.
fn list<'a>(key: &str, words: &mut impl Iterator<Item = &'a str>) -> Checked<Vec<f64>> {
    let count =
        words.next().and_then(|word| word.parse::<usize>().ok()).filter(|n| (1..=LONGEST).contains(n));
    let count = count.ok_or_else(|| format!("{key}: a number of angles from 1 to {LONGEST} needed"))?;
    let list = (0..count).map(|_| number(words.next())).collect::<Checked<Vec<f64>>>()?;
    match list.windows(2).all(|pair| pair[0] < pair[1]) {
        true => Ok(list),
        false => Err(wrong!("{key}: the angles do not increase")),
    }
}

/// The name of a channel, by which its place is known, and DataBegin.
fn channel<'a>(words: &mut Peekable<impl Iterator<Item = &'a str>>, channels: &[&str]) -> Checked<usize> {
    let word = *words.peek().ok_or_else(|| format!("cut off before {}", channels[channels.len() - 1]))?;
    let found = channels.iter().position(|channel| is(word, channel));
    if found.is_none() && (channels.len() > 1 || !is(word, "DataBegin")) {
        return Err(wrong!("{:?} where {} is needed", short(word), channels.join(", ")));
    }
    words.next_if(|word| !is(word, "DataBegin"));
    match words.next_if(|word| is(word, "DataBegin")) {
        Some(_) => Ok(found.unwrap_or(0)),
        None => Err(wrong!("no DataBegin behind {}", channels[found.unwrap_or(0)])),
    }
}

/// What the values were before they were held.
#[derive(Default)]
struct ValueCheck {
    values: usize,
    negative: usize,
    least: f64,
}

/// TIS of a block; its values are appended.
fn block<'a>(
    words: &mut impl Iterator<Item = &'a str>,
    count: usize,
    values: &mut Vec<f64>,
    seen: &mut ValueCheck,
) -> Checked<f64> {
    if !words.next().is_some_and(|word| is(word, "TIS")) {
        return Err("TIS needed before the values of each incidence".into());
    }
    let tis = number(words.next())?;
    for _ in 0..count {
        let value = number(words.next())?;
        if !(value as f32).is_finite() {
            return Err(wrong!("{value:e} is no BRDF value"));
        }
        seen.values += 1;
        seen.negative += usize::from(value < 0.0);
        seen.least = seen.least.min(value);
        values.push(value.max(0.0));
    }
    Ok(tis)
}

fn number(word: Option<&str>) -> Checked<f64> {
    let value = word.and_then(|word| word.parse::<f64>().ok()).filter(|value| value.is_finite());
    value.ok_or_else(|| wrong!("{:?} where a finite number is needed", short(word.unwrap_or_default())))
}

/// The angles of a list that goes round.
fn circle(key: &str, list: &[f64]) -> Checked<Azimuths> {
    let (first, last) = (list[0], list[list.len() - 1]);
    if first < -360.0 || last > 360.0 || last - first > 360.0 + SAME {
        return Err(wrong!(
            "{key}: the angles from {first} to {last} are more than a turn, or outside [-360, 360]"
        ));
    }
    Ok(Azimuths::of(list, 360.0, false))
}

/// Whether the angles make tables that can be read; `listed` are the azimuths as the file has them.
fn check(file: &Zemax, listed: &[f64]) -> Checked<()> {
    let within = |list: &[f64], most: f64| list.iter().all(|angle| (0.0..=most).contains(angle));
    if !within(&file.light, 90.0) || !within(&file.radials, 180.0) {
        return Err("an angle lies outside [0, 90] (incidence) or [0, 180] (radial)".into());
    }
    if file.radials.len() < 2 {
        return Err("at least two radials needed".into());
    }
    if file.symmetric && !within(listed, 180.0) {
        return Err("PlaneSymmetrical: an azimuth lies outside [0, 180]".into());
    }
    // Two opposite azimuths are a scan in a plane; of more, half a turn without any is a forgotten symmetry.
    let (widest, count) = (widest_gap(&file.azimuths, 360.0), file.azimuths.len());
    if !file.symmetric && count > 1 && widest > if count == 2 { 180.0 } else { 180.0 - SAME } {
        return Err(wrong!(
            "ScatterAzimuth: {widest} degrees without any azimuth; half a turn is what PlaneSymmetrical has"
        ));
    }
    if file.rotations.len() > 1 && (file.symmetric || widest_gap(&file.rotations, 360.0) > WIDEST_GAP) {
        return Err(wrong!(
            "several rotations must be asymmetrical and go round in steps of at most {WIDEST_GAP}"
        ));
    }
    Ok(())
}
