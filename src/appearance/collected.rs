//! Readings of a receptor, and of the whole hemisphere, by the sensor that a table has.

use std::f64::consts::{PI, TAU};

use super::hemisphere;
use super::reading::{BinWeights, Reading};
use super::receptor::Receptor;
use crate::instrument::{GridKind, Region};
use crate::table::BrdfTable;

/// An aperture of an arm stands for a receptor whose axis is as near as this, radians.
const SAME_DIRECTION: f64 = TAU / 360.0;
/// Bins are all of the hemisphere where their projected solid angles make up pi to this.
const WHOLE: f64 = 1e-6;
const NOT_WHOLE: &str = "the sensor does not see the whole hemisphere";

impl Reading {
    /// The reading of a receptor at an incidence, whose bins may be as large as `part` of its angles. Errors, in words: of a sensor
    /// that is no hemisphere of bins, and of bins that were not measured.
    pub fn new(table: &BrdfTable, incidence: usize, receptor: &Receptor, part: f64) -> Result<Self, String> {
        let found = match table.grid.kind {
            GridKind::Hemisphere if !hemisphere::is_whole(&table.grid) => Err(NOT_WHOLE.into()),
            GridKind::Hemisphere => Ok(hemisphere::reading(&table.grid, incidence, receptor)),
            GridKind::Arm | GridKind::Points if receptor.is_cone() => {
                of_direction(table, incidence, receptor)
            }
            _ => Err("the sensor is no hemisphere of bins".into()),
        }?;
        if found.terms.iter().any(|(entry, _)| table.is_gap(*entry)) {
            return Err("bins there were not measured".into());
        }
        let most_deg = receptor.size_deg().map(|size| part * size);
        Ok(Reading { most_deg, ..found })
    }

    /// The reading of all light above the horizon at an incidence, which is exact.
    pub fn of_all(table: &BrdfTable, incidence: usize) -> Result<Self, String> {
        let grid = &table.grid;
        if !matches!(grid.kind, GridKind::Hemisphere | GridKind::Patches) {
            return Err(NOT_WHOLE.into());
        }
        let first = incidence * grid.bins();
        let (mut terms, mut measure) = (Vec::new(), 0.0);
        for (bin, region) in
            grid.regions(incidence).iter().enumerate().filter(|(_, region)| !region.is_below())
        {
            let size = region.projected_solid_angle();
            measure += size;
            terms.push((first + bin, BinWeights::certain(size)));
        }
        if (measure / PI - 1.0).abs() > WHOLE {
            return Err(NOT_WHOLE.into());
        }
        if terms.iter().any(|(entry, _)| table.is_gap(*entry)) {
            return Err("some bins were not measured".into());
        }
        Ok(Reading { terms, measure, ..Reading::default() })
    }
}

/// The aperture of an arm, or the single direction, that is nearest to the receptor's axis: the mean there.
fn of_direction(table: &BrdfTable, incidence: usize, receptor: &Receptor) -> Result<Reading, String> {
    let off = |region: &Region| region.middle().angle_between(receptor.axis());
    let regions = table.grid.regions(incidence);
    let nearest = regions.iter().enumerate().min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
    let Some((bin, _)) = nearest.filter(|(_, region)| off(region) <= SAME_DIRECTION) else {
        return Err("the sensor has no position there".into());
    };
    let terms = vec![(incidence * table.grid.bins() + bin, BinWeights::certain(1.0))];
    Ok(Reading { terms, measure: 1.0, ..Reading::default() })
}
