//! The sphere: a table on it, and within it where light goes through.

use glam::DVec3;

use super::colours::in_shown_colours;
use super::direction_rule::{DirectionRule, of_pair};
use super::inside::seen_inside;
use super::light::Lighting;
use crate::error::{Checked, wrong};
use crate::interchange::content::light::index_of;
use crate::interchange::{Brdf, Colour, Lookup};
use crate::sphere;
use crate::table::BrdfTable;

/// The functions of a table that a sphere needs.
pub struct Material {
    /// Light that comes back.
    back: Option<Lookup>,
    /// Light that has gone through, and the index beyond over the index here.
    through: Option<(Lookup, f64)>,
    /// What of the table is not shown, in words.
    pub notes: Vec<String>,
}

/// The sphere.
pub struct MaterialSphere<'a> {
    back: Option<DirectionRule<'a>>,
    through: Option<(DirectionRule<'a>, f64)>,
}

impl Material {
    /// The material of a table. Errors: of one whose directions say nothing of a whole hemisphere, and of one of light that
    /// goes through alone into an unknown index.
    pub fn new(table: &BrdfTable) -> Checked<Self> {
        let (rgb, note) = in_shown_colours(table);
        let mut notes: Vec<String> = note.into_iter().collect();
        if !rgb.grid.looks_below() {
            return Ok(Material { back: Some(Lookup::new(&rgb)?), through: None, notes });
        }
        let of = |below: bool| -> Checked<_> {
            let Some(half) = rgb.half(below) else { return Ok(None) };
            Ok(Some((Lookup::of_side(&half, below)?, index_of(&half))))
        };
        let back = of(false)?.map(|(lookup, _)| lookup);
        let through = match of(true)? {
            Some((lookup, Some(eta))) => Some((lookup, eta)),
            Some(_) if back.is_some() => {
                notes.push("what goes through is not shown: the index beyond is not known".into());
                None
            }
            _ => None,
        };
        if back.is_none() && through.is_none() {
            return Err(wrong!("holds light that goes through alone, into an index that it does not say"));
        }
        Ok(Material { back, through, notes })
    }

    /// What it is, in words.
    pub fn in_words(&self) -> String {
        match (&self.back, &self.through) {
            (_, Some((_, eta))) => format!(
                "a sphere of {} times the index around it, rough towards the eye and smooth behind{}",
                (1e4 * eta).round() / 1e4,
                if self.back.is_some() { "" } else { "; light that comes back is not in the table" }
            ),
            _ => "a sphere of the table's material".into(),
        }
    }
}

impl<'a> MaterialSphere<'a> {
    /// The sphere of a material.
    pub fn new(material: &'a Material) -> Self {
        MaterialSphere {
            back: material.back.as_ref().map(|lookup| DirectionRule::new(lookup, true)),
            through: material.through.as_ref().map(|(lookup, eta)| (DirectionRule::new(lookup, false), *eta)),
        }
    }

    /// The radiance that leaves the sphere at `place`, a unit vector, towards the unit vector `eye`.
    pub fn seen(&self, light: &Lighting, place: DVec3, eye: DVec3) -> Colour {
        let mut sum = [0.0; 3];
        let mut add = |part: Colour| sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        if let Some(back) = &self.back {
            let frame = Frame::at(place, eye, back.is_isotropic());
            let e = frame.inwards(eye);
            if let Some(sky) = &light.sky {
                add(back.seen(e, |w| sky.radiance(frame.outwards(w))));
            }
            if let Some(lamp) = light.lamp {
                let w = frame.inwards(light.towards);
                if w.z > 0.0 {
                    let (f, grey) = (of_pair(back.lookup(), e, w), back.lookup().colours() == 1);
                    add(std::array::from_fn(|c| lamp[c] * w.z * f[if grey { 0 } else { c }]));
                }
            }
        }
        if let (Some((through, eta)), Some(sky)) = (&self.through, &light.sky) {
            let frame = Frame::at(place, eye, through.is_isotropic());
            let within = |w: DVec3| seen_inside(sky, place, frame.outwards(DVec3 { z: -w.z, ..w }), *eta);
            add(through.seen(frame.inwards(eye), within));
        }
        sum
    }
}

/// The table's frame at a place of the sphere: z outwards; x level around the sphere, or, where all azimuths are alike, the
/// eye's azimuth.
struct Frame([DVec3; 3]);

impl Frame {
    fn at(place: DVec3, eye: DVec3, isotropic: bool) -> Self {
        let along = if isotropic { eye - eye.dot(place) * place } else { DVec3::Z.cross(place) };
        let x = if along.length() > 1e-9 { along.normalize() } else { sphere::frame(place).0 };
        Frame([x, place.cross(x), place])
    }

    fn inwards(&self, w: DVec3) -> DVec3 {
        DVec3::from_array(self.0.map(|axis| axis.dot(w)))
    }

    fn outwards(&self, w: DVec3) -> DVec3 {
        w.x * self.0[0] + w.y * self.0[1] + w.z * self.0[2]
    }
}
