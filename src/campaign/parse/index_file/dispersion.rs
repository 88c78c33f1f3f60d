//! n and k as functions of the wavelength: points joined by straight lines, or Sellmeier's formula.

use crate::campaign::parse::reader::plain;
use crate::campaign::schema::Medium;

use super::{ETA, K, MOST_LINES, WAVELENGTH};

/// n and k over wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dispersion {
    eta: Curve,
    /// `None`: the medium absorbs nothing.
    k: Option<Curve>,
}

/// One quantity over the wavelength in nm.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Curve {
    /// (nm, value), nm increasing.
    Points(Vec<(f64, f64)>),
    /// n^2 - 1 = first + sum_i b_i l^2/(l^2 - c_i), l in um; `terms` are (b_i, c_i). `range` in nm.
    Sellmeier { first: f64, terms: Vec<(f64, f64)>, range: [f64; 2] },
}

impl Curve {
    /// The value at a wavelength; `None` where it is not known.
    fn at(&self, nm: f64) -> Option<f64> {
        match self {
            Curve::Points(points) => {
                let after = points.partition_point(|point| point.0 < nm);
                let above = *points.get(after)?;
                if above.0 == nm {
                    return Some(above.1);
                }
                let below = points[after.checked_sub(1)?];
                let t = (nm - below.0) / (above.0 - below.0);
                Some(below.1 + t * (above.1 - below.1))
            }
            Curve::Sellmeier { first, terms, range } => {
                let square = (1e-3 * nm) * (1e-3 * nm);
                let term = |&(b, c): &(f64, f64)| b * square / (square - c);
                let eta = (1.0 + first + terms.iter().map(term).sum::<f64>()).sqrt();
                (range[0] <= nm && nm <= range[1] && eta.is_finite()).then_some(eta)
            }
        }
    }

    fn ends(&self) -> [f64; 2] {
        match self {
            Curve::Points(points) => [0, points.len() - 1].map(|at| points[at].0),
            Curve::Sellmeier { range, .. } => *range,
        }
    }
}

impl Dispersion {
    /// A clear medium: n^2 - 1 = sum b l^2/(l^2 - c) with (b, c) for l in um, over `range` in nm.
    pub(crate) fn sellmeier(terms: Vec<(f64, f64)>, range: [f64; 2]) -> Self {
        Dispersion { eta: Curve::Sellmeier { first: 0.0, terms, range }, k: None }
    }

    /// n, and k where the medium absorbs; refused where the two have no wavelength in common.
    pub(crate) fn new(eta: Curve, k: Option<Curve>) -> Result<Self, String> {
        let found = Dispersion { eta, k };
        let [low, high] = found.ends();
        if low <= high {
            Ok(found)
        } else {
            Err(format!(
                "n and k share no wavelength: one begins at {} nm, the other ends at {} nm",
                plain(low),
                plain(high)
            ))
        }
    }

    /// Of media at increasing wavelengths.
    pub(crate) fn of(media: &[Medium]) -> Self {
        let points = |pick: fn(&Medium) -> f64| {
            Curve::Points(media.iter().map(|m| (m.wavelength_nm.unwrap_or_default(), pick(m))).collect())
        };
        Dispersion { eta: points(|medium| medium.eta), k: Some(points(|medium| medium.k)) }
    }

    /// The medium at a wavelength; `None` where n or k is not known.
    // Tested by `a_formula_is_the_published_glass`, `lists_of_n_and_k_are_read_or_refused_by_line`.
    pub(crate) fn at(&self, nm: f64) -> Option<Medium> {
        let k = self.k.as_ref().map_or(Some(0.0), |k| k.at(nm))?;
        Some(Medium { wavelength_nm: Some(nm), eta: self.eta.at(nm)?, k })
    }

    /// The first and the last wavelength where both are known, nm.
    pub(crate) fn ends(&self) -> [f64; 2] {
        let [low, high] = self.eta.ends();
        let k = self.k.as_ref().map_or([low, high], Curve::ends);
        [low.max(k[0]), high.min(k[1])]
    }

    /// The media at the wavelengths of n's own points where k is known; none for a formula.
    pub(crate) fn points(&self) -> Vec<Medium> {
        match &self.eta {
            Curve::Points(points) => points.iter().filter_map(|point| self.at(point.0)).collect(),
            Curve::Sellmeier { .. } => vec![],
        }
    }
}

/// Points of one quantity as they come by; which line each is of, for messages.
#[derive(Default)]
pub(crate) struct Points(Vec<(f64, f64)>);

impl Points {
    /// Adds n or k (`name`) at a wavelength.
    pub fn push(&mut self, line: usize, nm: f64, name: &str, value: f64) -> Result<(), String> {
        let bounds = if name == "n" { &ETA } else { &K };
        for (name, value, bounds) in [("wavelength_nm", nm, &WAVELENGTH), (name, value, bounds)] {
            if let Some(fault) = bounds.fault(value) {
                return Err(format!("line {line}: {name} = {} {fault}", plain(value)));
            }
        }
        if let Some(&(before, _)) = self.0.last().filter(|last| last.0 >= nm) {
            let (nm, before) = (plain(nm), plain(before));
            return Err(format!("line {line}: {nm} nm after {before} nm; wavelengths increase"));
        }
        self.0.push((nm, value));
        if self.0.len() > MOST_LINES { Err(format!("has more than {MOST_LINES} lines")) } else { Ok(()) }
    }

    /// The curve; `None` without points.
    pub fn curve(self) -> Option<Curve> {
        (!self.0.is_empty()).then_some(Curve::Points(self.0))
    }
}
