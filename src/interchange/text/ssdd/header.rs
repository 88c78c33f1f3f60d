//! What stands before the values of an SSDD file.

use std::io::BufRead;

use super::lines::NumberLines;
use crate::error::wrong;
use crate::interchange::Checked;

/// What the four lists of angles are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AngleKind {
    /// theta_i, phi_i, theta_o, phi_o.
    #[default]
    Spherical,
    /// theta_i, phi_i, and two angles about the mirror direction.
    Specular,
    /// theta_h, phi_h, theta_d, phi_d.
    HalfDifference,
}

/// What stands before the values.
#[derive(Default)]
pub struct SsddHeader {
    /// Light that has gone through: angles of the sensor are those that a mirror in the horizon shows.
    pub through: bool,
    pub parameters: AngleKind,
    /// Degrees; the second is 0 where the file has none.
    pub lists: [Vec<f64>; 4],
    /// What is added to the polar angle of the mirror direction at each theta_i; empty for nothing.
    pub offsets: Vec<f64>,
    /// Whether the file has the second list.
    pub anisotropic: bool,
    /// The last azimuths beyond half a turn are those before, mirrored at the plane of incidence.
    pub bilateral: bool,
    /// Half/difference: azimuths half a turn on are those before, the arms exchanged.
    pub reciprocal: bool,
    pub colours: usize,
    /// X, Y, Z instead of R, G, B.
    pub xyz: bool,
    pub wavelengths_nm: Vec<f64>,
    /// f32, little-endian, instead of text.
    pub binary: bool,
}

impl SsddHeader {
    /// Everything up to the values.
    pub fn read(lines: &mut NumberLines<impl BufRead>) -> Checked<Self> {
        if lines.next()?.is_none_or(|(_, line)| !line.starts_with("VERSION ")) {
            return Err("no VERSION line: not an SSDD file".into());
        }
        SsddHeader::default().block(lines)
    }

    /// What stands before the values of a further block, whose DATA_TYPE has been read.
    pub fn next(lines: &mut NumberLines<impl BufRead>, through: bool) -> Checked<Self> {
        SsddHeader { through, ..SsddHeader::default() }.block(lines)
    }

    fn block(mut self, lines: &mut NumberLines<impl BufRead>) -> Checked<Self> {
        loop {
            let Some((number, line)) = lines.next()? else { return Err("no DATA line".into()) };
            let (key, value) = line.split_once(char::is_whitespace).unwrap_or((&line, ""));
            if self.set(number, key, value.trim())? {
                break;
            }
        }
        self.finish()
    }

    /// Takes one line; whether it was the last before the values.
    fn set(&mut self, number: usize, key: &str, value: &str) -> Checked<bool> {
        let needs = |wanted: &str| Err(wrong!("line {number}: {key} {value}: {wanted} needed"));
        let numbers = || {
            let numbers = value.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>();
            numbers.map_err(|_| format!("line {number}: {key}: numbers needed"))
        };
        match (key, value) {
            ("DATA", "ascii") => return Ok(true),
            ("DATA", "binary") => {
                self.binary = true;
                return Ok(true);
            }
            ("DATA", _) => return needs("ascii or binary"),
            ("DATA_TYPE", "brdf" | "btdf") => self.through = value == "btdf",
            ("DATA_TYPE", _) => return needs("brdf or btdf"),
            ("PARAM_TYPE", "spherical_coordinate_system") => self.parameters = AngleKind::Spherical,
            ("PARAM_TYPE", "specular_coordinate_system") => self.parameters = AngleKind::Specular,
            ("PARAM_TYPE", "half_difference_coordinate_system") => {
                self.parameters = AngleKind::HalfDifference;
            }
            ("PARAM_TYPE", _) => {
                return needs("spherical_, specular_ or half_difference_coordinate_system");
            }
            ("REDUCTION_TYPE", _) => {
                for word in value.split_whitespace() {
                    match word {
                        "bilateral_symmetry" => self.bilateral = true,
                        "reciprocity" => self.reciprocal = true,
                        _ => return needs("bilateral_symmetry or reciprocity"),
                    }
                }
            }
            ("COLOR_MODEL", "monochrome") => self.colours = 1,
            ("COLOR_MODEL", "rgb" | "xyz") => (self.colours, self.xyz) = (3, value == "xyz"),
            ("COLOR_MODEL", "spectrum") => {}
            ("COLOR_MODEL", _) => return needs("monochrome, rgb, xyz or spectrum"),
            ("WAVELENGTH_LIST", _) => self.wavelengths_nm = numbers()?,
            _ => {
                let list = key.strip_prefix("PARAM").and_then(|rest| rest.strip_suffix("_LIST"));
                match list.and_then(|k| k.parse::<usize>().ok()) {
                    Some(k @ 0..4) => self.lists[k] = numbers()?,
                    Some(4) => self.offsets = numbers()?,
                    _ => {}
                }
            }
        }
        Ok(false)
    }

    /// Checks what its lines say together.
    fn finish(mut self) -> Checked<Self> {
        let nm = &self.wavelengths_nm;
        if !nm.windows(2).all(|pair| pair[0] < pair[1]) || !nm.iter().all(|nm| *nm > 0.0 && nm.is_finite()) {
            return Err("WAVELENGTH_LIST: increasing positive numbers needed".into());
        }
        match (self.colours, nm.len()) {
            (0, 0) => return Err("COLOR_MODEL spectrum needs a WAVELENGTH_LIST".into()),
            (0, count) => self.colours = count,
            _ => self.wavelengths_nm.clear(),
        }
        self.anisotropic = !self.lists[1].is_empty();
        if !self.anisotropic {
            self.lists[1].push(0.0);
        }
        let offsets = self.offsets.len();
        if offsets > 0 && (self.parameters != AngleKind::Specular || offsets != self.lists[0].len()) {
            return Err(
                "PARAM4_LIST: specular_coordinate_system and an offset for each angle of PARAM0_LIST \
                        needed"
                    .into(),
            );
        }
        Ok(self)
    }

    /// Lengths of the lists.
    pub fn sizes(&self) -> [usize; 4] {
        self.lists.each_ref().map(Vec::len)
    }

    /// One of the lists, if its angles increase within [least, most].
    pub fn list(&self, k: usize, [least, most]: [f64; 2]) -> Checked<&[f64]> {
        let list = &self.lists[k];
        let within = list.iter().all(|angle| (least..=most).contains(angle));
        if list.is_empty() || !within || list.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(wrong!("PARAM{k}_LIST: increasing angles in [{least}, {most}] needed"));
        }
        Ok(list)
    }
}
