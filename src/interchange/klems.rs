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
use super::{Brdf, Colour, Lookup, Reason, foreign_table};
use crate::instrument::klems::{FULL, middles, patches};
use crate::instrument::{Grid, GridKind, Region, Sensor};
use crate::table::BrdfTable;

/// How the values are meant.
pub const CONVENTION: &str = "Klems full basis, IncidentDataStructure Columns, BRDF in 1/sr, no cosine, mean over both \
    patches by projected solid angle; Reflection Back is the +z side; patches of the light have the azimuth of wi + 180; \
    Visible only";

const NAME: &str = "LBNL/Klems Full";

/// The geometry of a matrix: stops in the middle of the light's patches.
fn grid(light: &[[f64; 4]], sensor: Vec<[f64; 4]>) -> Grid {
    Grid { kind: GridKind::Patches, stops_deg: middles(light), patches_deg: sensor, ..Grid::default() }
}

/// The text of a file of a table with one colour. Values of a table of these very patches are kept.
pub fn write(table: &BrdfTable) -> Reason<String> {
    let full = patches(&FULL);
    let own = grid(&full, full.clone());
    let matrix: Vec<f64> = if table.grid == own {
        table.colours[0].total.iter().map(|&v| f64::from(v)).collect()
    } else {
        let lookup = Lookup::new(table)?;
        let outward = |turn: f64| {
            full.iter()
                .map(|&[t1, t2, p1, p2]| {
                    nodes(&Region::Rectangle {
                        theta: [t1.to_radians(), t2.to_radians()],
                        phi: [(p1 + turn).to_radians(), (p2 + turn).to_radians()],
                    })
                })
                .collect::<Vec<_>>()
        };
        let (light, sensor) = (outward(180.0), outward(0.0));
        let mean = |k: usize| {
            let over = |(wi, w): &(DVec3, f64)| {
                sensor[k % full.len()].iter().map(|(wo, v)| w * v * lookup.brdf(*wi, *wo)[0]).sum::<f64>()
            };
            light[k / full.len()].iter().map(over).sum::<f64>()
        };
        (0..full.len() * full.len()).into_par_iter().map(mean).collect()
    };
    let mut basis = format!("<AngleBasis>\n<AngleBasisName>{NAME}</AngleBasisName>\n");
    for (low, high, n) in FULL {
        let theta = if low == 0.0 { 0.0 } else { 0.5 * (low + high) };
        basis += &format!(
            "<AngleBasisBlock>\n<Theta>{theta}</Theta>\n<nPhis>{n}</nPhis>\n<ThetaBounds><LowerTheta>{low}</LowerTheta>\
             <UpperTheta>{high}</UpperTheta></ThetaBounds>\n</AngleBasisBlock>\n"
        );
    }
    basis += "</AngleBasis>\n";
    let bases =
        format!("<ColumnAngleBasis>{NAME}</ColumnAngleBasis>\n<RowAngleBasis>{NAME}</RowAngleBasis>\n");
    let mut data = String::new();
    for out in 0..full.len() {
        for light in 0..full.len() {
            write!(data, "{:.7e},\t", matrix[light * full.len() + out]).map_err(|e| e.to_string())?;
        }
        data.push('\n');
    }
    Ok(radiance_xml::write("Columns", &basis, &bases, &data))
}

/// The table of patches of a file; negative values become 0, as Radiance has it.
///
/// Held by: `klems_patches_come_back`, `damaged_xml_is_refused` (tests/interchange_radiance.rs).
pub fn read(bytes: &[u8]) -> Reason<BrdfTable> {
    let document = radiance_xml::read(bytes)?;
    let block = document.reflection()?;
    let columns = match document.structure.as_str() {
        "Columns" => true,
        "Rows" => false,
        other => return Err(format!("IncidentDataStructure {:?}: Columns or Rows needed", short(other))),
    };
    let basis = |k: usize| {
        let name = block.bases.get(k).ok_or("a block without ColumnAngleBasis and RowAngleBasis")?;
        let rings = document.bases.iter().find(|basis| basis.0 == *name).map(|basis| patches(&basis.1));
        rings
            .filter(|rings| !rings.is_empty())
            .ok_or_else(|| format!("the basis {:?} is not described", short(name)))
    };
    let (light, sensor) = if columns { (basis(0)?, basis(1)?) } else { (basis(1)?, basis(0)?) };
    let wanted = light.len() * sensor.len();
    let cells = block.data.split(|c: char| c == ',' || c.is_whitespace()).filter(|cell| !cell.is_empty());
    let mut values = Vec::with_capacity(wanted.min(block.data.len()));
    for cell in cells {
        let value: f32 = cell.parse().map_err(|_| format!("{:?} is no number", short(cell)))?;
        if values.len() == wanted {
            return Err(format!("more than {} x {} values", light.len(), sensor.len()));
        }
        values.push(if value < 0.0 { 0.0 } else { value });
    }
    if values.len() != wanted {
        return Err(format!("{} values, {} x {} needed", values.len(), light.len(), sensor.len()));
    }
    let place =
        |stop: usize, bin: usize| if columns { bin * light.len() + stop } else { stop * sensor.len() + bin };
    let bins = sensor.len();
    let total = (0..wanted).map(|k| values[place(k / bins, k % bins)]).collect();
    let grid = grid(&light, sensor);
    crate::table::check_grid(&grid)?;
    foreign_table(grid, vec![total])
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
