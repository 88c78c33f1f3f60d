//! SSDD about the mirror direction: the tables of Zemax files, whose frame and azimuths are the same.
//!
//! The sensor is at PARAM2 degrees from the mirror direction and PARAM3 degrees round it, 0 towards the normal. Source:
//! the specification, and libbsdf's `SpecularCoordinateSystem`.

use std::sync::Arc;

use glam::DVec3;

use super::azimuths::{check_round, check_whole, merged};
use super::header::SsddHeader;
use crate::interchange::resample::default_grid;
use crate::interchange::text::azimuths::Azimuths;
use crate::interchange::text::zemax::{Zemax, rotation_deg};
use crate::interchange::{Brdf, Checked, Colour, Imported};

/// A file as a function of at most three of its colours.
struct Specular {
    tables: Arc<Zemax>,
    values: Vec<Vec<f32>>,
}

impl Brdf for Specular {
    fn colours(&self) -> usize {
        self.values.len()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        self.tables.at(&self.values, wi, wo)
    }
}

/// The function that a file's values are, and notes on them.
pub fn function(header: &SsddHeader, total: &[Vec<f32>]) -> Checked<(Imported, Vec<String>)> {
    if header.reciprocal {
        return Err("REDUCTION_TYPE reciprocity: half_difference_coordinate_system needed".into());
    }
    if total.iter().flatten().any(|value| !value.is_finite()) {
        return Err("a value is no finite number".into());
    }
    let light = header.list(0, [0.0, 90.0])?;
    let radials = header.list(2, [0.0, 180.0])?;
    let most = if header.bilateral { 180.0 } else { 360.0 };
    let about = header.list(3, [most - 360.0, most])?;
    let turns = Azimuths::of(header.list(1, [-360.0, 360.0])?, 360.0, false);
    check_round(&turns)?;
    let about = match header.bilateral {
        true if about[0] < 0.0 => return Err("bilateral_symmetry: PARAM3_LIST in [0, 180] needed".into()),
        true => Azimuths { angles: about.to_vec(), places: (0..about.len()).map(|at| vec![at]).collect() },
        false => Azimuths::of(about, 360.0, false),
    };
    if !header.bilateral {
        check_whole(&about, 360.0)?;
    }
    let mut notes = vec![];
    // The sample's turns that bring the light to azimuth 0, increasing, as the tables have them.
    let mut order: Vec<(f64, usize)> = turns.angles.iter().map(|&phi| rotation_deg(phi)).zip(0..).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let alone = order.len() == 1;
    if alone && header.anisotropic {
        notes.push("PARAM1_LIST has one azimuth, which stands for all: read as isotropic".to_string());
    }
    let sizes = [light.len(), turns.angles.len(), radials.len(), about.angles.len()];
    let (values, seam) = merged(total, header.sizes(), &turns, &about);
    notes.extend(seam);
    let values: Vec<Vec<f32>> = values.iter().map(|values| turned(values, sizes, &order)).collect();
    let tables = Arc::new(Zemax {
        symmetric: header.bilateral,
        rotations: if alone { vec![0.0] } else { order.iter().map(|turn| turn.0).collect() },
        light: light.to_vec(),
        offsets: header.offsets.clone(),
        azimuths: about.angles,
        radials: radials.to_vec(),
        ..Zemax::default()
    });
    let grid = default_grid(tables.light.clone(), tables.phi_i_deg());
    let part = |values: &[Vec<f32>]| -> Box<dyn Brdf> {
        Box::new(Specular { tables: Arc::clone(&tables), values: values.to_vec() })
    };
    let (parts, wavelengths_nm) = (values.chunks(3).map(part).collect(), header.wavelengths_nm.clone());
    Ok((Imported::Function { parts, wavelengths_nm, grid }, notes))
}

/// Values over [light][turn][radial][azimuth] as [turn][light][azimuth][radial], the turns in another order.
fn turned(values: &[f32], [n0, n1, n2, n3]: [usize; 4], order: &[(f64, usize)]) -> Vec<f32> {
    let mut all = Vec::with_capacity(values.len());
    for &(_, i1) in order {
        for i0 in 0..n0 {
            for i3 in 0..n3 {
                all.extend((0..n2).map(|i2| values[((i0 * n1 + i1) * n2 + i2) * n3 + i3]));
            }
        }
    }
    all
}
