//! Radiance XML with a Klems matrix: 145 patches of light times 145 of the sensor.
//!
//! A value is the mean of the BRDF over both patches by projected solid angle. Patch j of a ring of n is centred on
//! azimuth 360 j/n; the light's patch names the direction in which light travels on, so its x and y are those of wi
//! negated. Value index = sensor x 145 + light (`Columns`). Source: Radiance's bsdf_m.c.

use std::fmt::Write;

use glam::DVec3;
use rayon::prelude::*;

use super::radiance_xml::{self, short};
use super::resample::nodes;
use super::{Brdf, Colour, Lookup, Reason, colour, foreign_table};
use crate::instrument::klems::{FULL, middles, patches};
use crate::instrument::{Grid, GridKind, Region, Sensor};
use crate::table::BrdfTable;

/// How the values are meant.
pub const CONVENTION: &str = "Klems full basis, IncidentDataStructure Columns, BRDF in 1/sr, no cosine, mean over both \
    patches by projected solid angle; Reflection Back is the +z side; patches of the light have the azimuth of wi + 180; \
    Visible is Y, of a table of three colours CIE-X and CIE-Z beside it (linear BT.709 primaries, white D65)";

const NAME: &str = "LBNL/Klems Full";

/// The geometry of a matrix: stops in the middle of the light's patches.
fn grid(light: &[[f64; 4]], sensor: Vec<[f64; 4]>) -> Grid {
    Grid { kind: GridKind::Patches, stops_deg: middles(light), patches_deg: sensor, ..Grid::default() }
}

/// What the blocks of a coloured file are, after `Visible`.
const COLOURS: [&str; 2] = ["CIE-X", "CIE-Z"];

/// The text of a file. Values of a table of these very patches are kept; those of three colours go through XYZ.
pub fn write(table: &BrdfTable) -> Reason<String> {
    let full = patches(&FULL);
    let own = grid(&full, full.clone());
    let coloured = table.colours.len() > 1;
    let matrix: Vec<Colour> = if table.grid == own {
        let value = |k: usize| {
            std::array::from_fn(|c| table.colours.get(c).map_or(0.0, |colour| f64::from(colour.total[k])))
        };
        (0..full.len() * full.len()).map(value).collect()
    } else {
        means(&Lookup::new(table)?, &full)
    };
    let channel = |c: usize| {
        let value = |k: usize| if coloured { colour::xyz(matrix[k])[[1, 0, 2][c]] } else { matrix[k][0] };
        numbers(full.len(), value)
    };
    let names = ["Visible", COLOURS[0], COLOURS[1]];
    let channels: Vec<_> = (0..if coloured { 3 } else { 1 }).map(|c| (names[c], channel(c))).collect();
    let bases =
        format!("<ColumnAngleBasis>{NAME}</ColumnAngleBasis>\n<RowAngleBasis>{NAME}</RowAngleBasis>\n");
    Ok(radiance_xml::write("Columns", &basis(), &bases, &channels))
}

/// Means over pairs of patches, light major.
fn means(lookup: &Lookup, full: &[[f64; 4]]) -> Vec<Colour> {
    let outward = |turn: f64| {
        let region = |&[t1, t2, p1, p2]: &[f64; 4]| Region::Rectangle {
            theta: [t1.to_radians(), t2.to_radians()],
            phi: [(p1 + turn).to_radians(), (p2 + turn).to_radians()],
        };
        full.iter().map(|patch| nodes(&region(patch))).collect::<Vec<_>>()
    };
    let (light, sensor) = (outward(180.0), outward(0.0));
    let mean = |k: usize| {
        let mut sum = [0.0; 3];
        for (wi, w) in &light[k / full.len()] {
            for (wo, v) in &sensor[k % full.len()] {
                let value = lookup.brdf(*wi, *wo);
                sum.iter_mut().zip(value).for_each(|(s, f)| *s += w * v * f);
            }
        }
        sum
    };
    (0..full.len() * full.len()).into_par_iter().map(mean).collect()
}

/// One channel as text, a line a patch of the sensor; `value` counts light major.
fn numbers(side: usize, value: impl Fn(usize) -> f64) -> String {
    let mut data = String::new();
    for out in 0..side {
        for light in 0..side {
            // Writing into a String does not fail.
            let _written = write!(data, "{:.7e},\t", value(light * side + out));
        }
        data.push('\n');
    }
    data
}

/// The description of the full basis.
fn basis() -> String {
    let mut basis = format!("<AngleBasis>\n<AngleBasisName>{NAME}</AngleBasisName>\n");
    for (low, high, n) in FULL {
        let theta = if low == 0.0 { 0.0 } else { 0.5 * (low + high) };
        basis += &format!(
            "<AngleBasisBlock>\n<Theta>{theta}</Theta>\n<nPhis>{n}</nPhis>\n<ThetaBounds><LowerTheta>{low}</LowerTheta>\
             <UpperTheta>{high}</UpperTheta></ThetaBounds>\n</AngleBasisBlock>\n"
        );
    }
    basis + "</AngleBasis>\n"
}

/// The table of patches of a file; negative values become 0, as Radiance has it.
///
/// Held by: `klems_patches_come_back`, `colours_of_radiance_files_come_back`, `damaged_xml_is_refused`
/// (tests/interchange_radiance.rs).
pub fn read(bytes: &[u8]) -> Reason<BrdfTable> {
    let document = radiance_xml::read(bytes)?;
    let blocks = document.reflection(COLOURS)?;
    let columns = match document.structure.as_str() {
        "Columns" => true,
        "Rows" => false,
        other => return Err(format!("IncidentDataStructure {:?}: Columns or Rows needed", short(other))),
    };
    let basis = |k: usize| {
        let name = blocks[0].bases.get(k).ok_or("a block without ColumnAngleBasis and RowAngleBasis")?;
        let rings = document.bases.iter().find(|basis| basis.0 == *name).map(|basis| patches(&basis.1));
        rings
            .filter(|rings| !rings.is_empty())
            .ok_or_else(|| format!("the basis {:?} is not described", short(name)))
    };
    let (light, sensor) = if columns { (basis(0)?, basis(1)?) } else { (basis(1)?, basis(0)?) };
    if blocks.iter().any(|block| block.bases != blocks[0].bases) {
        return Err("the blocks have different bases".into());
    }
    let bins = sensor.len();
    let place = |stop: usize, bin: usize| if columns { bin * light.len() + stop } else { stop * bins + bin };
    let channels = blocks
        .iter()
        .map(|block| {
            let values = matrix(&block.data, light.len(), bins)?;
            Ok((0..light.len() * bins).map(|k| values[place(k / bins, k % bins)]).collect())
        })
        .collect::<Reason<Vec<Vec<f32>>>>()?;
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

/// The values of one block.
fn matrix(data: &str, light: usize, sensor: usize) -> Reason<Vec<f32>> {
    let wanted = light * sensor;
    let cells = data.split(|c: char| c == ',' || c.is_whitespace()).filter(|cell| !cell.is_empty());
    let mut values = Vec::with_capacity(wanted.min(data.len()));
    for cell in cells {
        let value: f32 = cell.parse().map_err(|_| format!("{:?} is no number", short(cell)))?;
        if values.len() == wanted {
            return Err(format!("more than {light} x {sensor} values"));
        }
        values.push(if value < 0.0 { 0.0 } else { value });
    }
    if values.len() != wanted {
        return Err(format!("{} values, {light} x {sensor} needed", values.len()));
    }
    Ok(values)
}

/// A matrix as a function: the value of the patches that hold the directions.
pub struct Patchwise {
    light: Sensor,
    sensor: Sensor,
    table: BrdfTable,
}

impl Patchwise {
    /// Of a table of patches whose stops are the middles of the same patches.
    pub fn new(table: BrdfTable) -> Reason<Self> {
        let full = patches(&FULL);
        if table.grid != grid(&full, full.clone()) {
            return Err("only the full basis of 145 patches is known as a function".into());
        }
        let sensor = Sensor::new(&table.grid);
        Ok(Patchwise { light: sensor.clone(), sensor, table })
    }
}

impl Brdf for Patchwise {
    fn colours(&self) -> usize {
        self.table.colours.len()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let find = |sensor: &Sensor, w: DVec3| {
            let mut found = None;
            sensor.each_bin(w, |bin| found = Some(bin));
            found
        };
        let (light, sensor) = (find(&self.light, DVec3::new(-wi.x, -wi.y, wi.z)), find(&self.sensor, wo));
        let Some((stop, bin)) = light.zip(sensor) else { return [0.0; 3] };
        let at = stop * self.table.grid.bins() + bin;
        std::array::from_fn(|c| self.table.colours.get(c).map_or(0.0, |colour| f64::from(colour.total[at])))
    }
}
