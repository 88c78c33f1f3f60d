//! The table of every realisation: `<name>.realisations.exr`, one part each, for pairing and jackknife.
//!
//! Input: [`Realisations`] and the table they belong to. Output: a multi-part EXR, or a smaller one with 16
//! groups of consecutive realisations, or nothing where even that is too large.

use std::path::Path;

use crate::error::{Checked, ContentError, Error, Result, wrong};
use crate::files::image::{self, ImagePart};
use crate::files::{Destination, NewFile};
use crate::instrument::Grid;

use super::channels::{self, ColourName, DIGEST};
use super::grid_attribute::{self, GRID};
use super::{BrdfTable, RealisationPart, Realisations, SchlickSums, store};

/// The attribute by which a file of realisations is told as one of ours.
pub const TABLE_DIGEST: &str = "gonio.table_digest";
const GROUP_SIZE: &str = "gonio.group_size";

/// The largest file that is written unasked, bytes.
pub const SIZE_LIMIT: u64 = 64_000_000;
/// The largest file that is written, asked to keep every realisation or not.
pub fn limit(keep_all: bool) -> u64 {
    if keep_all { u64::MAX } else { SIZE_LIMIT }
}

/// How many groups are made where single realisations would exceed the limit.
pub const GROUPS: usize = 16;

/// What of the realisations is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoredRealisations {
    /// Every one.
    All,
    /// [`GROUPS`] means over consecutive ones.
    Groups,
    /// None.
    Nothing,
}

/// The content of a realisations file.
#[derive(Debug, Clone, PartialEq)]
pub struct RealisationsFile {
    /// Which incidences and bins, as in the table.
    pub grid: Grid,
    /// Digest of the table that they belong to.
    pub table_digest: String,
    /// Realisations in each part, at least 1.
    pub group_size: usize,
    /// The values.
    pub realisations: Realisations,
    /// What is missing or odd, without being wrong.
    pub warnings: Vec<String>,
}

impl RealisationsFile {
    /// Whether these are the realisations of the table with this digest.
    pub fn is_of(&self, digest: &str) -> bool {
        self.table_digest == digest
    }
}

/// An upper bound of the file's size in bytes, known before anything is measured.
///
/// Pixels of so many f32 `channels` that do not compress at all, and the headers.
// Tested by `the_size_said_beforehand_is_never_exceeded`.
pub fn file_bytes(grid: &Grid, channels: usize, parts: usize) -> u64 {
    let (incidences, bins) = (grid.incidences() as u64, grid.bins() as u64);
    let channels = channels as u64;
    let pixels = incidences.saturating_mul(bins).saturating_mul(channels * 4);
    let text = grid_attribute::grid_text(grid).map_or(0, |text| text.len() as u64);
    let header = 1024 + text + 48 * channels;
    let chunks = incidences.div_ceil(16) * 20;
    pixels.saturating_add(header + chunks).saturating_mul(parts as u64).saturating_add(16)
}

/// Channels of one part: total and single of every colour, and the sums of Schlick's formula.
pub fn channels_of(table: &BrdfTable) -> usize {
    let sums = table.schlick.as_ref().map_or(0, |sums| sums.channels(table.is_by_order()).len());
    2 * table.colours.len() + sums
}

/// What can be stored within `limit` bytes, with so many channels in each part.
pub fn kept(grid: &Grid, channels: usize, realisations: usize, limit: u64) -> StoredRealisations {
    if file_bytes(grid, channels, realisations) <= limit {
        return StoredRealisations::All;
    }
    let grouping = realisations > GROUPS && realisations.is_multiple_of(GROUPS);
    if grouping && file_bytes(grid, channels, GROUPS) <= limit {
        StoredRealisations::Groups
    } else {
        StoredRealisations::Nothing
    }
}

/// Means over consecutive realisations, `groups` of equal size, summed in f64.
pub fn grouped(realisations: &Realisations, groups: usize) -> Result<Realisations> {
    let count = realisations.parts.len();
    if groups == 0 || count == 0 || !count.is_multiple_of(groups) {
        return Err(Error::Internal(format!("{count} realisations do not make {groups} equal groups")));
    }
    let parts = realisations.parts.chunks(count / groups).map(mean_part).collect();
    Ok(Realisations { parts })
}

fn mean_part(parts: &[RealisationPart]) -> RealisationPart {
    let colours = |pick: fn(&RealisationPart) -> &Vec<Vec<f32>>| {
        let of = |c: usize| mean_values(parts.iter().map(move |part| &pick(part)[c]));
        (0..pick(&parts[0]).len()).map(of).collect()
    };
    let sums: Option<Vec<&SchlickSums>> = parts.iter().map(|part| part.schlick.as_ref()).collect();
    let schlick = sums.map(|sums| {
        let part = |group: usize, m: usize| mean_values(sums.iter().map(move |sums| &sums.further[group][m]));
        let group = |group: usize| (0..sums[0].further[group].len()).map(|m| part(group, m)).collect();
        SchlickSums {
            unit: mean_values(sums.iter().map(|sums| &sums.unit)),
            first: mean_values(sums.iter().map(|sums| &sums.first)),
            further: (0..sums[0].further.len()).map(group).collect(),
        }
    });
    RealisationPart { total: colours(|part| &part.total), single: colours(|part| &part.single), schlick }
}

fn mean_values<'a>(all: impl Iterator<Item = &'a Vec<f32>>) -> Vec<f32> {
    let all: Vec<&Vec<f32>> = all.collect();
    let mean = |i: usize| all.iter().map(|values| f64::from(values[i])).sum::<f64>() / all.len() as f64;
    (0..all.first().map_or(0, |values| values.len())).map(|i| mean(i) as f32).collect()
}

/// The bytes of the realisations' file; `group_size` realisations went into each part.
pub fn encode(realisations: &Realisations, table: &BrdfTable, group_size: usize) -> Result<Vec<u8>> {
    encode_of(realisations, table, &store::digest(table)?, group_size)
}

/// The same for a table that is not at hand: its digest, and a table with its grid and colours.
pub fn encode_of(
    realisations: &Realisations,
    table: &BrdfTable,
    table_digest: &str,
    group_size: usize,
) -> Result<Vec<u8>> {
    let parts = (0..)
        .zip(&realisations.parts)
        .map(|(index, part)| to_part(index, part, table, table_digest, group_size))
        .collect::<Checked<Vec<_>>>()
        .map_err(|why| Error::Refused(format!("the realisations cannot be stored: {why}")))?;
    image::encode(parts).map_err(|why| Error::Internal(format!("encoding the realisations: {why}")))
}

/// Writes the realisations' file, whole or not at all, grouped or left out as `limit` bytes ask.
pub fn save(
    path: impl Into<Destination>,
    realisations: &Realisations,
    table: &BrdfTable,
    limit: u64,
) -> Result<StoredRealisations> {
    let (kept, file) = staged(path, realisations, table, limit)?;
    file.map_or(Ok(()), NewFile::commit)?;
    Ok(kept)
}

/// The realisations' file, on the disk and not yet in its place, where there is to be one.
pub fn staged(
    path: impl Into<Destination>,
    realisations: &Realisations,
    table: &BrdfTable,
    limit: u64,
) -> Result<(StoredRealisations, Option<NewFile>)> {
    let count = realisations.parts.len();
    let kept = kept(&table.grid, channels_of(table), count, limit);
    let bytes = match kept {
        StoredRealisations::All => encode(realisations, table, 1)?,
        StoredRealisations::Groups => encode(&grouped(realisations, GROUPS)?, table, count / GROUPS)?,
        StoredRealisations::Nothing => return Ok((kept, None)),
    };
    Ok((kept, Some(NewFile::with(path, &bytes)?)))
}

/// Reads a realisations' file.
pub fn load(path: &Path) -> Result<RealisationsFile> {
    from_parts(image::load(path)?).map_err(|why| Error::format(path, why))
}

/// The realisations in the bytes of a file; `path` is for messages only.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<RealisationsFile> {
    let parts = image::decode(bytes).map_err(|why| Error::format(path, why))?;
    from_parts(parts).map_err(|why| Error::format(path, why))
}

fn part_name(index: usize) -> String {
    format!("realisation_{index:03}")
}

fn to_part(
    index: usize,
    values: &RealisationPart,
    table: &BrdfTable,
    table_digest: &str,
    group_size: usize,
) -> Checked<ImagePart> {
    let (height, width) = grid_attribute::check_grid(&table.grid)?;
    let names = table.colour_names();
    if values.total.len() != names.len() || values.single.len() != names.len() {
        return Err(wrong!("{} has other colours than the table", part_name(index)));
    }
    let mut part = ImagePart { name: Some(part_name(index)), width, height, ..ImagePart::default() };
    for (c, name) in names.iter().enumerate() {
        channels::insert(&mut part, name, &values.total[c])?;
        channels::insert(&mut part, &format!("single.{name}"), &values.single[c])?;
    }
    channels::insert_schlick(&mut part, values.schlick.as_ref(), table.is_by_order())?;
    let grid = grid_attribute::grid_text(&table.grid)?;
    part.set_text(GRID, &grid);
    part.set_text(TABLE_DIGEST, table_digest);
    part.set_text(GROUP_SIZE, &group_size.to_string());
    let digest = channels::content_of(&part).finish(&part);
    part.set_text(DIGEST, &digest);
    Ok(part)
}

fn from_parts(parts: Vec<ImagePart>) -> Checked<RealisationsFile> {
    let first = parts.first().ok_or("no parts")?;
    let grid = grid_attribute::read_grid(first)?;
    let same =
        |name: &str| first.text(name).map(str::to_string).ok_or_else(|| format!("no {name} attribute"));
    let (table_digest, group) = (same(TABLE_DIGEST)?, same(GROUP_SIZE)?);
    let group_size = match group.parse() {
        Ok(size) if size > 0 => size,
        _ => return Err(wrong!("{GROUP_SIZE} = {group}: a positive integer needed")),
    };
    let mut warnings = Vec::new();
    let mut realisations = Realisations::default();
    let names = channels::colour_names(first)?;
    for (index, mut part) in parts.into_iter().enumerate() {
        let wrong = |why: ContentError| why.at(format_args!("part {index}"));
        if part.name.as_deref() != Some(part_name(index).as_str()) {
            let what = format!("its name is {:?}, not `{}`", part.name, part_name(index));
            return Err(wrong(what.into()));
        }
        if grid_attribute::read_grid(&part).map_err(wrong)? != grid
            || part.text(TABLE_DIGEST) != Some(&table_digest)
            || part.text(GROUP_SIZE) != Some(&group)
        {
            return Err(wrong("it belongs to another table than part 0".into()));
        }
        channels::check_digest(&part, &table_digest, &mut warnings).map_err(wrong)?;
        realisations.parts.push(take_part(&mut part, &names).map_err(wrong)?);
    }
    Ok(RealisationsFile { grid, table_digest, group_size, realisations, warnings })
}

fn take_part(part: &mut ImagePart, names: &[ColourName]) -> Checked<RealisationPart> {
    let mut values =
        RealisationPart { schlick: channels::take_schlick(part, 0)?, ..RealisationPart::default() };
    for (name, _) in names {
        values.total.push(channels::take(part, name, 0)?);
        values.single.push(channels::take(part, &format!("single.{name}"), 0)?);
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::super::test_tables::table;
    use super::*;

    fn realisations(count: u16, colours: u16) -> Realisations {
        let values = |k: u16, c: u16| (0..12).map(|i| f32::from(100 * k + 20 * c + i).sqrt()).collect();
        let colours = |k: u16| (0..colours).map(|c| values(k, c)).collect::<Vec<Vec<f32>>>();
        let part = |k: u16| RealisationPart { total: colours(k + 1), single: colours(k), schlick: None };
        Realisations { parts: (0..count).map(part).collect() }
    }

    #[test]
    fn realisations_round_trip_with_their_table() {
        for (count, colours) in [(1, 1), (3, 3), (12, 1)] {
            let (table, parts) = (table(usize::from(colours)), realisations(count, colours));
            let bytes = encode(&parts, &table, 1).expect("encodes");
            assert_eq!(bytes, encode(&parts, &table, 1).expect("encodes"));
            let file = decode(Path::new("x.exr"), &bytes).expect("decodes");
            assert_eq!(file.realisations, parts);
            assert_eq!((&file.grid, file.group_size), (&table.grid, 1));
            assert!(file.is_of(&store::digest(&table).expect("a digest")) && file.warnings.is_empty());
            let mut other = table.clone();
            other.hits[0] += 1;
            assert!(!file.is_of(&store::digest(&other).expect("a digest")));
        }
    }

    #[test]
    fn the_size_said_beforehand_is_never_exceeded() {
        for (count, colours) in [(1, 1), (16, 3), (40, 1)] {
            let table = table(usize::from(colours));
            let bytes = encode(&realisations(count, colours), &table, 1).expect("encodes").len() as u64;
            let bound = file_bytes(&table.grid, channels_of(&table), usize::from(count));
            assert!(bytes <= bound, "{bytes} > {bound}");
        }
    }

    #[test]
    fn too_many_realisations_become_groups_and_then_nothing() {
        let table = table(1);
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("t.realisations.exr");
        let (sixteen, all) = (file_bytes(&table.grid, 2, 16), file_bytes(&table.grid, 2, 48));
        let parts = realisations(48, 1);
        assert_eq!(save(&path, &parts, &table, sixteen - 1).expect("saves"), StoredRealisations::Nothing);
        assert!(!path.exists());
        assert_eq!(kept(&table.grid, 2, 40, all - 1), StoredRealisations::All);
        assert_eq!(kept(&table.grid, 2, 50, all - 1), StoredRealisations::Nothing);
        assert_eq!(save(&path, &parts, &table, all - 1).expect("saves"), StoredRealisations::Groups);
        let file = load(&path).expect("loads");
        assert_eq!((file.realisations.parts.len(), file.group_size), (16, 3));
        let mean: f64 = (3..6).map(|k| f64::from(parts.parts[k].single[0][5])).sum::<f64>() / 3.0;
        assert_eq!(file.realisations.parts[1].single[0][5], mean as f32);
    }
}
