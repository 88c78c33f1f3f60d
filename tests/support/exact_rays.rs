//! The oracle of the cell walk: every facet under the ray in turn, in exact integer arithmetic.
//!
//! Heights and places in a cell are whole multiples of 1/S, heights along a ray of 1/S^2. The clearance (ray minus
//! surface) is linear over a facet; a ray is blocked where it becomes negative. No order of cells, no rounding.

use std::cmp::Ordering;

use glam::DVec3;
use gonio::surface::Heightfield;
use gonio::trace::{Facet, Outcome, SurfacePoint};

/// Units in a cell.
pub const S: i64 = 1 << 10;

/// A square periodic field.
pub struct ExactField {
    /// Cells per side.
    pub cells: i64,
    /// Heights, 1/S.
    pub heights: Vec<i64>,
}

/// A facet of the plane, its cell not reduced to the field.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ExactFacet {
    pub x: i64,
    pub y: i64,
    pub upper: bool,
}

/// A ray from a point of a facet.
#[derive(Clone, Copy, Debug)]
pub struct ExactRay {
    /// Where it starts, its cell inside the field.
    pub facet: ExactFacet,
    /// Place in the cell, 1/S.
    pub u: i64,
    pub v: i64,
    /// Direction: x and y in 1/S, z in 1/S^2.
    pub d: [i64; 3],
}

/// num/den, den > 0.
#[derive(Clone, Copy, Debug)]
struct Ratio {
    num: i128,
    den: i128,
}

impl Ratio {
    fn cmp(&self, other: &Ratio) -> Ordering {
        (self.num * other.den).cmp(&(other.num * self.den))
    }
}

/// How the walk and the oracle agree.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Agreement {
    /// The same facet, or free for both.
    Same,
    /// The ray touches a facet's border exactly, so that rounding may decide.
    Touch,
}

/// A facet that the ray meets: when first, and whether it goes below it.
struct Contact {
    facet: ExactFacet,
    time: Ratio,
    below: bool,
}

/// a + b t.
#[derive(Clone, Copy)]
struct Line(i128, i128);

impl Line {
    fn sign_at(self, t: Ratio) -> Ordering {
        (self.0 * t.den + self.1 * t.num).cmp(&0)
    }
}

impl ExactField {
    pub fn field(&self) -> Heightfield {
        let n = self.cells as usize;
        Heightfield::new(n, n, true, self.heights.iter().map(|&h| h as f64 / S as f64).collect())
    }

    pub fn height(&self, x: i64, y: i64) -> i64 {
        self.heights[(y.rem_euclid(self.cells) * self.cells + x.rem_euclid(self.cells)) as usize]
    }

    /// A corner of the facet where both its short sides meet (x, y, height), and its slopes in 1/S per cell.
    fn plane(&self, f: ExactFacet) -> ([i64; 3], [i64; 2]) {
        let (x, y) = (f.x + i64::from(f.upper), f.y + i64::from(f.upper));
        let (h, step) = (self.height(x, y), if f.upper { -1 } else { 1 });
        ([x, y, h], [step * (self.height(x + step, y) - h), step * (self.height(x, y + step) - h)])
    }

    /// Height of the ray's start, 1/S^2.
    pub fn start_z(&self, ray: &ExactRay) -> i64 {
        let ([x, y, h], [p, q]) = self.plane(ray.facet);
        S * h + p * (S * (ray.facet.x - x) + ray.u) + q * (S * (ray.facet.y - y) + ray.v)
    }

    /// Clearance over a facet's plane along the ray, 1/S^2.
    fn clearance(&self, ray: &ExactRay, f: ExactFacet) -> Line {
        let ([x, y, h], [p, q]) = self.plane(f);
        let [dx, dy, dz] = ray.d.map(i128::from);
        let (px, py) = (S * (ray.facet.x - x) + ray.u, S * (ray.facet.y - y) + ray.v);
        let over = i128::from(self.start_z(ray))
            - i128::from(S * h)
            - i128::from(p) * i128::from(px)
            - i128::from(q) * i128::from(py);
        Line(over, dz - i128::from(p) * dx - i128::from(q) * dy)
    }

    /// Whether the ray leaves its own facet upwards or along it.
    pub fn leaves_its_facet(&self, ray: &ExactRay) -> bool {
        self.clearance(ray, ray.facet).1 >= 0
    }

    /// Time by which the ray is above or below all heights; `None` for level rays and those that take too many cells.
    pub fn horizon(&self, ray: &ExactRay, most_cells: i64) -> Option<i64> {
        let z = self.start_z(ray);
        let (low, high) = (*self.heights.iter().min()?, *self.heights.iter().max()?);
        let height = if ray.d[2] > 0 { S * high - z } else { z - S * low };
        let time = (ray.d[2] != 0).then(|| height / ray.d[2].abs() + 1)?;
        let span = |d: i64| time.checked_mul(d.abs()).map(|s| s / S + 3);
        (span(ray.d[0])?.checked_mul(span(ray.d[1])?)? <= most_cells).then_some(time)
    }

    /// The part of [0, end] in which the ray is over the closed facet.
    fn over(ray: &ExactRay, f: ExactFacet, end: i64) -> Option<[Ratio; 2]> {
        let [dx, dy, _] = ray.d.map(i128::from);
        let x = Line(i128::from(S * (ray.facet.x - f.x) + ray.u), dx);
        let y = Line(i128::from(S * (ray.facet.y - f.y) + ray.v), dy);
        let one = i128::from(S);
        let rest = Line(one - x.0 - y.0, -dx - dy);
        let sides = if f.upper {
            [Line(one - x.0, -dx), Line(one - y.0, -dy), Line(-rest.0, -rest.1)]
        } else {
            [x, y, rest]
        };
        let (mut from, mut to) = (Ratio { num: 0, den: 1 }, Ratio { num: i128::from(end), den: 1 });
        for Line(a, b) in sides {
            let crossing = Ratio { num: if b > 0 { -a } else { a }, den: b.abs() };
            match b.cmp(&0) {
                Ordering::Equal if a < 0 => return None,
                Ordering::Greater if crossing.cmp(&from).is_gt() => from = crossing,
                Ordering::Less if crossing.cmp(&to).is_lt() => to = crossing,
                _ => {}
            }
        }
        from.cmp(&to).is_le().then_some([from, to])
    }

    /// When the ray first meets a facet: goes below it, or touches it after its start.
    fn contact(&self, ray: &ExactRay, facet: ExactFacet, end: i64) -> Option<Contact> {
        let [from, to] = Self::over(ray, facet, end)?;
        let clearance = self.clearance(ray, facet);
        let (first, last) = (clearance.sign_at(from), clearance.sign_at(to));
        let root = Ratio { num: clearance.0, den: -clearance.1 };
        let contact = |time, below| Some(Contact { facet, time, below });
        match (first, last) {
            (Ordering::Less, _) => contact(from, true),
            (Ordering::Equal, Ordering::Less) => contact(from, true),
            (Ordering::Greater, Ordering::Less) => contact(root, true),
            (_, Ordering::Equal) if to.num > 0 => contact(if first.is_eq() { from } else { to }, false),
            (Ordering::Equal, _) if from.num > 0 => contact(from, false),
            _ => None,
        }
    }

    /// Compares the walk's answer; panics where they disagree. `end` is the ray's `horizon`.
    pub fn compare(&self, ray: &ExactRay, end: i64, outcome: Outcome) -> Agreement {
        let range = |start: i64, d: i64| {
            let incidence = start + (d * end).div_euclid(S);
            start.min(incidence) - 2..=start.max(incidence) + 2
        };
        let mut contacts = Vec::new();
        for y in range(ray.facet.y, ray.d[1]) {
            for x in range(ray.facet.x, ray.d[0]) {
                let both = [false, true].map(|upper| ExactFacet { x, y, upper });
                contacts.extend(
                    both.iter().filter(|&&f| f != ray.facet).filter_map(|&f| self.contact(ray, f, end)),
                );
            }
        }
        let blocked = contacts.iter().filter(|c| c.below).map(|c| c.time).min_by(Ratio::cmp);
        match (outcome, blocked) {
            (Outcome::Escaped, None) => Agreement::Same,
            (Outcome::Hit(place), _) => {
                let met = contacts.iter().filter(|c| self.reduced(c.facet) == place.facet);
                let not_late = |time: &Ratio| blocked.is_none_or(|blocked| time.cmp(&blocked).is_le());
                let mut met = met.filter(|c| not_late(&c.time)).peekable();
                assert!(met.peek().is_some(), "{ray:?}: the walk hits {place:?}, exact {blocked:?}");
                if met.any(|c| c.below) { Agreement::Same } else { Agreement::Touch }
            }
            _ => panic!("{ray:?}: {outcome:?}, exact {blocked:?}"),
        }
    }

    fn reduced(&self, f: ExactFacet) -> Facet {
        let cell = |k: i64| k.rem_euclid(self.cells) as usize;
        Facet { x: cell(f.x), y: cell(f.y), upper: f.upper }
    }

    /// The ray as the walk takes it; every number is exact.
    pub fn as_walked(&self, field: &Heightfield, ray: &ExactRay) -> (SurfacePoint, DVec3) {
        let s = S as f64;
        let place = SurfacePoint::on(field, self.reduced(ray.facet), ray.u as f64 / s, ray.v as f64 / s);
        assert_eq!(place.z, self.start_z(ray) as f64 / (s * s));
        (place, DVec3::new(ray.d[0] as f64 / s, ray.d[1] as f64 / s, ray.d[2] as f64 / (s * s)))
    }
}
