//! How much light a file sends back, or lets through, at the table's incidences and between them, as the file's own reader sees it.

use rayon::prelude::*;
use serde::Serialize;

use super::resample::sampling::{integral, samples};
use super::{Brdf, Lookup, in_mirror};
use crate::error::{Checked, wrong};
use crate::sphere;

/// Directions of each of three kinds in an integral: of smooth lobes right to 0.1 %.
const SAMPLES: usize = 1 << 11;
/// Incidences of the table that are looked at, at most.
const INCIDENCES: usize = 12;
/// Where to look between two incidences: 1 less the golden ratio, far from every fraction of small numbers.
const PLACE: f64 = 0.381_966;
/// Azimuths where all are alike: formats of cells distinguish them.
const AZIMUTHS_DEG: [f64; 3] = [0.0, 37.0, 130.0];
/// Differences above this are said, and refused between the table's incidences unless more is allowed, relative.
pub const ALLOWED: f64 = 0.01;
/// A file may exceed the larger of 1 and the table's own albedo by this, relative; more is refused.
pub const REFUSED_ABOVE: f64 = 0.02;

/// A direction of the light, and the albedo of table and file there, by colour.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlbedoPoint {
    /// Degrees.
    pub theta_i_deg: f64,
    /// Degrees.
    pub phi_i_deg: f64,
    /// The table's: at its incidences the one of its bins, between them interpolated.
    pub table: Vec<f64>,
    /// The file's.
    pub file: Vec<f64>,
}

/// The albedo of a file next to the table's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlbedoCurve {
    /// By polar angle of the light, then azimuth.
    pub points: Vec<AlbedoPoint>,
    /// The table's last incidence, degrees: beyond it the table's albedo is a guess, and the file is held to no bar.
    pub theta_i_last_deg: f64,
    /// Light beyond this polar angle of the sensor is left out: the format ends there.
    pub theta_r_up_to_deg: f64,
    /// Of light that has gone through: transmittances, not albedos.
    pub through: bool,
    /// The largest |file/table - 1|.
    pub worst: f64,
    /// Which of `points` has it.
    pub worst_point: usize,
}

impl AlbedoPoint {
    /// The largest |file/table - 1| of its colours.
    fn off(&self) -> f64 {
        let lit = self.table.iter().zip(&self.file).filter(|(table, _)| **table > 0.0);
        lit.map(|(table, file)| (file / table - 1.0).abs()).fold(0.0, f64::max)
    }

    /// Both albedos, means of the colours, the difference, and where.
    fn difference(&self) -> String {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        format!(
            "{:.4} where the table's is {:.4} ({:.1} % off), light {:.2} {:.2}",
            mean(&self.file),
            mean(&self.table),
            100.0 * self.off(),
            self.theta_i_deg,
            self.phi_i_deg
        )
    }
}

impl AlbedoCurve {
    /// The curve of a file whose light and sensor go up to these angles, degrees; `None` where the table is dark. Of light
    /// that has gone `through`, the table is what a mirror in the horizon shows.
    pub fn of(
        lookup: &Lookup,
        file: &dyn Brdf,
        through: bool,
        [theta_i_end, theta_r_end]: [f64; 2],
    ) -> Option<Self> {
        let horizon = theta_r_end.to_radians().cos();
        let thetas =
            between(&lookup.theta_i().iter().map(|t| t.to_degrees()).collect::<Vec<_>>(), theta_i_end);
        let phis = azimuths(lookup);
        let colours = lookup.colours().min(3);
        let seen = |wo| if through { in_mirror(wo) } else { wo };
        let point = |k: usize| {
            let (theta_i_deg, phi_i_deg) = (thetas[k / phis.len()], phis[k % phis.len()]);
            let wi = sphere::direction_deg(theta_i_deg, phi_i_deg);
            let mut to = samples(wi, lookup.guide().lobe(), SAMPLES);
            to.retain(|to| to.wo.z >= horizon);
            let [table, found] =
                [integral(&to, |wo| lookup.brdf(wi, wo)), integral(&to, |wo| file.brdf(wi, seen(wo)))];
            let last = file.colours() - 1;
            AlbedoPoint {
                theta_i_deg,
                phi_i_deg,
                table: table[..colours].to_vec(),
                file: (0..colours).map(|c| found[c.min(last)]).collect(),
            }
        };
        let points: Vec<AlbedoPoint> = (0..thetas.len() * phis.len()).into_par_iter().map(point).collect();
        let (worst_point, worst) =
            points.iter().map(AlbedoPoint::off).enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let lit = points.iter().any(|point| point.table.iter().any(|&value| value > 0.0));
        let theta_i_last_deg = lookup.last_theta_i_deg();
        lit.then_some(AlbedoCurve {
            points,
            theta_i_last_deg,
            theta_r_up_to_deg: theta_r_end,
            through,
            worst,
            worst_point,
        })
    }

    /// What it is a curve of.
    fn name(&self) -> &'static str {
        if self.through { "transmittance" } else { "albedo" }
    }

    /// The curve of all light, of those of what comes back and what goes through; of one of them that one.
    pub fn sum(curves: &[Self]) -> Option<Self> {
        let mut whole = curves.first()?.clone();
        for other in &curves[1..] {
            for (point, more) in whole.points.iter_mut().zip(&other.points) {
                let add =
                    |sum: &mut Vec<f64>, more: &[f64]| sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
                add(&mut point.table, &more.table);
                add(&mut point.file, &more.file);
            }
        }
        Some(whole)
    }

    /// Refuses a file that makes light (more than 1, and more than the table, by [`REFUSED_ABOVE`]).
    // Tested by `an_export_that_makes_light_is_refused` (tests/it/interchange/interchange_albedo.rs).
    pub fn check_no_gain(&self) -> Checked<()> {
        let most = |pick: fn(&AlbedoPoint) -> &Vec<f64>| {
            let of = |point| pick(point).iter().copied().fold(0.0, f64::max);
            self.points.iter().map(|point| (of(point), point)).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        if let (Some((file, at)), Some((table, _))) = (most(|p| &p.file), most(|p| &p.table))
            && file > table.max(1.0) * (1.0 + REFUSED_ABOVE)
        {
            return Err(wrong!(
                "a reader of the file would find the albedo {file:.4} under light from {:.2} {:.2} degrees (the table: \
                 {table:.4} at most): the format's directions do not hold the lobe; choose another format, a wider \
                 lobe, or more incidences and bins",
                at.theta_i_deg,
                at.phi_i_deg
            ));
        }
        Ok(())
    }

    /// Refuses a file that is off by more than `allowed` between the table's incidences.
    // Tested by `an_export_with_another_albedo_is_refused_unless_allowed` (tests/it/interchange/interchange_albedo.rs).
    pub fn check(&self, allowed: f64) -> Checked<()> {
        let inside = self.points.iter().filter(|point| !self.is_beyond(point));
        match inside.max_by(|a, b| a.off().total_cmp(&b.off())).filter(|at| at.off() > allowed) {
            None => Ok(()),
            Some(at) => Err(wrong!(
                "its {} would be {}; at most {} % is allowed: choose another format, measure more incidences and \
                 bins, or allow it by --allow-albedo-error {:.0}",
                self.name(),
                at.difference(),
                100.0 * allowed,
                (100.0 * at.off()).ceil()
            )),
        }
    }

    /// Whether a point lies beyond the table's last incidence, by more than the rounding of its angle.
    fn is_beyond(&self, point: &AlbedoPoint) -> bool {
        point.theta_i_deg > self.theta_i_last_deg + 1e-3
    }

    /// The note on differences above [`ALLOWED`].
    pub fn note(&self) -> Option<String> {
        let at = &self.points[self.worst_point];
        let why = if self.is_beyond(at) {
            format!("beyond the table's last incidence, {:.4}, both are guesses", self.theta_i_last_deg)
        } else {
            "the format's directions do not hold the lobe there".into()
        };
        (self.worst > ALLOWED).then(|| format!("its {} is {}: {why}", self.name(), at.difference()))
    }

    /// theta_i in degrees, the table's albedo and the file's, means over azimuths and colours.
    pub fn by_theta(&self) -> Vec<[f64; 3]> {
        let mut rows: Vec<[f64; 4]> = Vec::new();
        for point in &self.points {
            if rows.last().is_none_or(|row| row[0] != point.theta_i_deg) {
                rows.push([point.theta_i_deg, 0.0, 0.0, 0.0]);
            }
            if let Some(row) = rows.last_mut() {
                row[1] += point.table.iter().sum::<f64>();
                row[2] += point.file.iter().sum::<f64>();
                row[3] += point.table.len() as f64;
            }
        }
        rows.into_iter().map(|[theta, table, file, count]| [theta, table / count, file / count]).collect()
    }
}

/// Some of the incidences, a place between each two, and the end where they stop before it. The place is not the
/// middle: where a format halves gaps, the middle is one of its own incidences.
fn between(incidences: &[f64], end: f64) -> Vec<f64> {
    let step = incidences.len().div_ceil(INCIDENCES);
    let mut chosen: Vec<f64> =
        incidences.iter().copied().step_by(step).filter(|&theta| theta <= end).collect();
    let before = chosen.last().copied().unwrap_or(0.0);
    chosen.extend((end > before + 1.0).then_some(end));
    let places: Vec<f64> = chosen.windows(2).map(|pair| pair[0] + PLACE * (pair[1] - pair[0])).collect();
    chosen.extend(places);
    chosen.sort_by(f64::total_cmp);
    // A tenth of a thousandth of a degree: angles are said with few digits.
    chosen.iter().map(|theta| (theta * 1e4).round() / 1e4).collect()
}

/// Two azimuths of the light and the middles behind them, degrees.
fn azimuths(lookup: &Lookup) -> Vec<f64> {
    if lookup.is_isotropic() {
        return AZIMUTHS_DEG.to_vec();
    }
    let all = lookup.phi_i();
    let next = |k: usize| if k + 1 < all.len() { all[k + 1] } else { all[0] + std::f64::consts::TAU };
    let both = |k: usize| [all[k], 0.5 * (all[k] + next(k))];
    let mut chosen: Vec<f64> = [0, all.len() / 3].into_iter().flat_map(both).collect();
    chosen.dedup();
    chosen.iter().map(|phi| (phi.to_degrees() * 1e4).round() / 1e4).collect()
}
