//! Radiance XML with Klems matrices: patches of light times patches of the sensor (145, 73 or 41 each).
//!
//! A value is the mean of the BSDF over both patches by projected solid angle. Patch j of a ring of n is centred on
//! azimuth 360 j/n; the light's patch names the direction in which light travels on, so its x and y are those of wi
//! negated; the sensor's has the x and y of wo, on either side. Value index = sensor x patches + light (`Columns`).
//! Source: Radiance's bsdf_m.c.

use std::fmt::Write;

use super::colour;
use super::patch_means::means;
pub use super::patchwise::Patchwise;
use super::patchwise::{bases_of, grid};
use super::sample_side::{SampleSide, SideBlocks};
use super::xml::{DataBlock, Document, negative_note, short};
use super::{sides, xml, xml_writer};
use crate::error::wrong;
use crate::instrument::GridKind;
use crate::instrument::klems::{Basis, Ring, patches};
use crate::interchange::codec::{Codec, Encoded, FormatTraits, Sides};
use crate::interchange::foreign_table;
use crate::interchange::{Brdf, Checked, Colour, Imported, Lookup, Options, needed};
use crate::table::BrdfTable;

/// How the values are meant.
const CONVENTION: &str = "Klems matrix, IncidentDataStructure Columns, BRDF in 1/sr, no cosine, mean over both \
    patches by projected solid angle; Back is light from the +z side; patches of the light have the azimuth of wi + 180; \
    Visible is Y, of a table of three colours CIE-X and CIE-Z beside it (linear BT.709 primaries, white D65)";

/// The format.
pub struct Klems;

impl Codec for Klems {
    fn traits(&self) -> FormatTraits {
        FormatTraits { sides: Sides::Both, light_from_back: true, ..FormatTraits::resampled("klems") }
    }

    fn memory_needed(&self, bytes: &[u8]) -> Checked<u64> {
        Ok(needed::xml(bytes))
    }

    fn decode(&self, bytes: &[u8], options: &Options) -> Checked<(Imported, Vec<String>)> {
        let (table, notes) = read_side(bytes, options.side)?;
        Ok((table.into(), notes))
    }

    fn encode<'a>(&self, table: &'a BrdfTable, options: &Options) -> Checked<Encoded<'a>> {
        let (text, notes) = write(table, options)?;
        Ok(Encoded::bytes(text, xml_writer::convention(CONVENTION, table.grid.looks_below()), notes))
    }
}

/// What the blocks of a coloured file are, after `Visible`.
const COLOURS: [&str; 2] = ["CIE-X", "CIE-Z"];

/// The text of a file, and notes on it. Values of a table of patches are kept as they are, unless another
/// basis is wanted; of other tables the full basis is written. Those of three colours go through XYZ.
// Tested by `half_and_quarter_bases_go_out_as_they_came`, `klems_patches_come_back`.
pub fn write(table: &BrdfTable, options: &Options) -> Checked<(String, Vec<String>)> {
    let (all, mut notes) = sides::of(table, options)?;
    let (mut bases, mut blocks) = (Bases::default(), vec![]);
    for side in &all {
        let (rings, matrix, note) = matrix_of(side, options.klems)?;
        notes.extend(Some(note).filter(|note| !notes.contains(note)));
        let light = bases.name(&rings[0], "patches of the light");
        let sensor = bases.name(&rings[1], "patches of the sensor");
        let counts = rings.map(|rings| rings.iter().map(|ring| ring.2).sum::<usize>());
        let named = format!(
            "<ColumnAngleBasis>{light}</ColumnAngleBasis>\n<RowAngleBasis>{sensor}</RowAngleBasis>\n"
        );
        let coloured = side.half.colours.len() > 1;
        for (c, wavelength) in ["Visible", COLOURS[0], COLOURS[1]].into_iter().enumerate() {
            if c == 0 || coloured {
                let value =
                    |k: usize| if coloured { colour::xyz(matrix[k])[[1, 0, 2][c]] } else { matrix[k][0] };
                let data = numbers(counts, value);
                let (light, through, bases) = (side.light, side.through, named.clone());
                blocks.push(xml_writer::Block { light, through, bases, wavelength, data });
            }
        }
    }
    Ok((xml_writer::write("Columns", &bases.described(), &blocks), notes))
}

/// Bases of light and sensor, the values between them, and what is to say of those.
type Values = ([Vec<Ring>; 2], Vec<Colour>, String);

fn matrix_of(side: &sides::Side<'_>, wanted: Option<Basis>) -> Checked<Values> {
    let table: &BrdfTable = &side.half;
    let own = bases_of(&table.grid);
    let kept = own.filter(|own| wanted.is_none_or(|basis| own.iter().all(|rings| rings == basis.rings())));
    if let Some(bases) = kept {
        let value = |k: usize| {
            std::array::from_fn(|c| table.colours.get(c).map_or(0.0, |colour| f64::from(colour.total[k])))
        };
        let matrix = (0..table.grid.incidences() * table.grid.bins()).map(value).collect();
        return Ok((bases, matrix, "the table's own patches, as they are".into()));
    }
    let basis = wanted.unwrap_or(Basis::Full);
    let brdf = as_function(table, side.through)?;
    let matrix = means(brdf.as_ref(), basis.rings(), table.grid.is_isotropic());
    let count = patches(basis.rings()).len();
    let note = format!("resampled to {count} patches: lobes narrower than those are not held");
    Ok(([basis.rings().to_vec(), basis.rings().to_vec()], matrix, note))
}

/// The bases of a file by name.
#[derive(Default)]
struct Bases(Vec<(String, Vec<Ring>)>);

impl Bases {
    /// The name of a basis: that of a known one, else `other`, with a number where that is another's.
    fn name(&mut self, rings: &[Ring], other: &str) -> String {
        if let Some((name, _)) = self.0.iter().find(|(_, known)| known == rings) {
            return name.clone();
        }
        let known = Basis::ALL.iter().find(|basis| basis.rings() == rings);
        let mut name = known.map_or_else(|| other.to_string(), |basis| basis.name().into());
        let taken = self.0.iter().filter(|(taken, _)| taken.starts_with(&name)).count();
        if taken > 0 {
            name = format!("{name} {}", taken + 1);
        }
        self.0.push((name.clone(), rings.to_vec()));
        name
    }

    fn described(&self) -> String {
        self.0.iter().map(|(name, rings)| basis(name, rings)).collect()
    }
}

/// The table, one side of it, as a function of two directions.
fn as_function(table: &BrdfTable, through: bool) -> Checked<Box<dyn Brdf>> {
    if table.grid.kind == GridKind::Patches && bases_of(&table.grid).is_some() {
        return Ok(Box::new(Patchwise::new(table.clone())?));
    }
    Ok(Box::new(Lookup::of_side(table, through)?))
}

/// One channel as text, a line a patch of the sensor, in the nine digits that an f32 needs; `value` counts light major.
fn numbers([light, sensor]: [usize; 2], value: impl Fn(usize) -> f64) -> String {
    let mut data = String::new();
    for out in 0..sensor {
        for incidence in 0..light {
            // Writing into a String does not fail.
            let _written = write!(data, "{:.8e},\t", value(incidence * sensor + out));
        }
        data.push('\n');
    }
    data
}

/// The description of a basis.
fn basis(name: &str, rings: &[Ring]) -> String {
    let mut basis = format!("<AngleBasis>\n<AngleBasisName>{name}</AngleBasisName>\n");
    for &(low, high, n) in rings {
        let theta = if low == 0.0 { 0.0 } else { 0.5 * (low + high) };
        basis += &format!(
            "<AngleBasisBlock>\n<Theta>{theta}</Theta>\n<nPhis>{n}</nPhis>\n<ThetaBounds><LowerTheta>{low}</LowerTheta>\
             <UpperTheta>{high}</UpperTheta></ThetaBounds>\n</AngleBasisBlock>\n"
        );
    }
    basis + "</AngleBasis>\n"
}

/// The table of patches of a file; see [`read_side`].
pub fn read(bytes: &[u8]) -> Checked<BrdfTable> {
    read_side(bytes, None).map(|(table, _)| table)
}

/// The table of patches of the light from one side of a file, what comes back and what goes through where the file has
/// them, and notes on it; negative values become 0, as Radiance has
/// it, and are counted.
// Tested by `klems_patches_come_back`, `colours_of_radiance_files_come_back`, `damaged_xml_is_refused`,
// `negative_values_are_counted` (tests/it/interchange/interchange_radiance.rs).
pub fn read_side(bytes: &[u8], side: Option<SampleSide>) -> Checked<(BrdfTable, Vec<String>)> {
    let document = xml::read(bytes)?;
    let columns = match document.structure.as_str() {
        "Columns" => true,
        "Rows" => false,
        other => {
            return Err(wrong!("IncidentDataStructure {:?}: Columns or Rows needed", short(other)));
        }
    };
    let SideBlocks { halves, mut notes } = document.side(COLOURS, side)?;
    let (mut tables, mut seen) = ([None, None], Counted::default());
    for (table, blocks) in tables.iter_mut().zip(halves) {
        if !blocks.is_empty() {
            *table = Some(table_of(&document, &blocks, columns, &mut seen)?);
        }
    }
    notes.extend(negative_note(seen.negative, seen.values, seen.least));
    let [above, below] = tables;
    let whole = match (above, below.and_then(|below| below.mirrored())) {
        (Some(above), Some(image)) => above.joined(&image),
        (above, image) => above.or(image),
    };
    Ok((whole.ok_or("reflection and transmission have different bases of the light")?, notes))
}

/// The table of one block, or of three of colour.
fn table_of(
    document: &Document,
    blocks: &[&DataBlock],
    columns: bool,
    seen: &mut Counted,
) -> Checked<BrdfTable> {
    let basis = |k: usize| {
        let name = blocks[0].bases.get(k).ok_or("a block without ColumnAngleBasis and RowAngleBasis")?;
        let described = document.bases.iter().find(|basis| basis.0 == *name).map(|basis| patches(&basis.1));
        let known = Basis::ALL.iter().find(|basis| basis.name() == name).map(|basis| patches(basis.rings()));
        described
            .filter(|rings| !rings.is_empty())
            .or(known)
            .ok_or_else(|| format!("the basis {:?} is not described", short(name)))
    };
    let (light, sensor) = if columns { (basis(0)?, basis(1)?) } else { (basis(1)?, basis(0)?) };
    if blocks.iter().any(|block| block.bases != blocks[0].bases) {
        return Err("the blocks have different bases".into());
    }
    let bins = sensor.len();
    let place = |incidence: usize, bin: usize| {
        if columns { bin * light.len() + incidence } else { incidence * bins + bin }
    };
    let matrices = blocks
        .iter()
        .map(|block| matrix(&block.data, light.len(), bins, seen))
        .collect::<Checked<Vec<Vec<f32>>>>()?;
    let sorted =
        |matrix: &Vec<f32>| (0..light.len() * bins).map(|k| matrix[place(k / bins, k % bins)]).collect();
    let channels: Vec<Vec<f32>> = matrices.iter().map(sorted).collect();
    let grid = grid(&light, sensor);
    crate::table::check_grid(&grid)?;
    foreign_table(grid, rgb_of(channels))
}

/// R, G, B of Y, X, Z; a single channel as it is.
fn rgb_of(channels: Vec<Vec<f32>>) -> Vec<Vec<f32>> {
    let [y, x, z] = &channels[..] else { return channels };
    let wide = |values: &[f32], k: usize| f64::from(values[k]);
    let value = |k: usize| match wide(x, k) + wide(y, k) + wide(z, k) {
        // To be refused with its place.
        sum if !sum.is_finite() => [f64::NAN; 3],
        _ => colour::rgb([wide(x, k), wide(y, k), wide(z, k)]),
    };
    let all: Vec<Colour> = (0..y.len()).map(value).collect();
    (0..3).map(|c| all.iter().map(|value| value[c] as f32).collect()).collect()
}

/// Values that were read, and what was negative among them.
#[derive(Default)]
struct Counted {
    values: usize,
    negative: usize,
    least: f64,
}

fn matrix(data: &str, light: usize, sensor: usize, seen: &mut Counted) -> Checked<Vec<f32>> {
    let wanted = light * sensor;
    let cells = data.split(|c: char| c == ',' || c.is_whitespace()).filter(|cell| !cell.is_empty());
    let mut found = Vec::with_capacity(wanted.min(data.len()));
    for cell in cells {
        let value: f32 = cell.parse().map_err(|_| format!("{:?} is no number", short(cell)))?;
        if found.len() == wanted {
            return Err(wrong!("more than {light} x {sensor} values"));
        }
        seen.negative += usize::from(value < 0.0);
        seen.least = seen.least.min(f64::from(value));
        found.push(if value < 0.0 { 0.0 } else { value });
    }
    if found.len() != wanted {
        return Err(wrong!("{} values, {light} x {sensor} needed", found.len()));
    }
    seen.values += wanted;
    Ok(found)
}
