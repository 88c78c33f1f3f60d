//! What the measurement itself may be off by: differences from the same measurement done otherwise.

use super::positions::Position;
use super::rig::{Rig, Seen, Setting};
use crate::campaign::{Campaign, Detrend, Gaps, SurfaceKind};
use crate::error::Result;
use crate::stats;

/// One way in which a value may be off, by pair and colour.
#[derive(Debug, Clone)]
pub struct Alternative {
    /// What was done otherwise.
    pub name: &'static str,
    /// \[pair\]\[colour\]: half-width of a rectangular error.
    pub half_widths: Vec<Vec<HalfWidth>>,
}

/// Half of the width of a rectangular error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfWidth {
    /// 1/sr, >= 0.
    pub value: f64,
    /// Its standard error over realisations; `None` where it is a bound.
    pub error: Option<f64>,
}

/// Something that was not looked at, and why.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct LeftOut {
    /// Its name.
    pub name: &'static str,
    /// Why it is no part of the budget.
    pub why: String,
}

/// f(a) - f(0) from f(a) - f(a/2), where f(a) = f(0) + c a^2.
const OF_HALF: f64 = 4.0 / 3.0;

/// All that exist of a campaign; `nominal` and `middle` are what is seen of it anew, and as if moved.
pub fn alternatives(
    rig: &mut Rig,
    positions: &[Position],
    nominal: &[Seen],
    middle: &[Seen],
    stage: &dyn Fn(&str),
) -> Result<(Vec<Alternative>, Vec<LeftOut>)> {
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    let [cone, _] = rig.half_angles_deg();
    stage("halving the apertures");
    let half = Setting { aperture: 0.5, ..Setting::NOMINAL };
    found.push(of_half_angle(rig, "aperture size", &half, positions, middle)?);
    if cone > 0.0 {
        let half = Setting { cone: 0.5, ..Setting::NOMINAL };
        found.push(of_half_angle(rig, "cone size", &half, positions, middle)?);
    } else {
        left_out.push(LeftOut { name: "cone size", why: "the light is parallel".into() });
    }
    for (name, other) in others(rig) {
        match other {
            Ok(campaign) => {
                stage(&format!("{name}: measuring it otherwise"));
                let [_, aperture] = rig.half_angles_deg();
                let samples = campaign.stop.samples;
                let mut otherwise = Rig::new(&campaign, aperture, samples, &mut Vec::new())?;
                let seen = otherwise.read_anew(positions)?;
                found.push(Alternative { name, half_widths: differences(nominal, &seen, 1.0) });
            }
            Err(why) => left_out.push(LeftOut { name, why }),
        }
    }
    if let Some(edge) = map_edge(nominal) {
        found.push(edge);
    }
    Ok((found, left_out))
}

fn of_half_angle(
    rig: &mut Rig,
    name: &'static str,
    half: &Setting,
    positions: &[Position],
    whole: &[Seen],
) -> Result<Alternative> {
    let half = rig.read_as_moved(half, positions)?;
    Ok(Alternative { name, half_widths: differences(whole, &half, OF_HALF) })
}

/// |mean of the differences| times `scale`, realisation by realisation.
fn differences(one: &[Seen], other: &[Seen], scale: f64) -> Vec<Vec<HalfWidth>> {
    let colour = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        let (mean, se) = stats::mean_and_se(a.iter().zip(b).map(|(a, b)| scale * (a - b)));
        HalfWidth { value: mean.abs(), error: se }
    };
    let pair = |(a, b): (&Seen, &Seen)| a.brdf.iter().zip(&b.brdf).map(colour).collect();
    one.iter().zip(other).map(pair).collect()
}

/// Light over the edge of an open map: a bound, with nothing to compare with.
fn map_edge(nominal: &[Seen]) -> Option<Alternative> {
    let of = |seen: &Seen| seen.left_map.iter().map(|&value| HalfWidth { value, error: None }).collect();
    let has = nominal.iter().any(|seen| !seen.left_map.is_empty());
    has.then(|| Alternative { name: "map edge", half_widths: nominal.iter().map(of).collect() })
}

/// The same campaign with other cells, and of a measured map with another form and other gaps; or why there is none.
fn others(rig: &Rig) -> Vec<(&'static str, std::result::Result<Campaign, String>)> {
    let campaign = rig.campaign();
    let with = |kind: SurfaceKind| {
        let mut other = campaign.clone();
        other.surface.kind = kind;
        other
    };
    let mut all = vec![("discretisation", coarser(campaign, rig.map_steps()))];
    if let SurfaceKind::File(map) = &campaign.surface.kind {
        let mut other = map.clone();
        other.detrend = match map.detrend {
            Detrend::None => Detrend::Plane,
            Detrend::Polynomial(degree) => Detrend::Polynomial(if degree < 10 { degree + 1 } else { 9 }),
            Detrend::Plane | Detrend::Sphere | Detrend::Cylinder => Detrend::Polynomial(2),
        };
        all.push(("detrend", Ok(with(SurfaceKind::File(other)))));
        let mut other = map.clone();
        let gaps = match map.preparation.gaps {
            Gaps::Refuse => Err("the map has no gaps".into()),
            Gaps::Interpolate => Ok(Gaps::Exclude),
            Gaps::Exclude => Ok(Gaps::Interpolate),
        };
        all.push((
            "gaps",
            gaps.map(|gaps| {
                other.preparation.gaps = gaps;
                with(SurfaceKind::File(other))
            }),
        ));
    }
    all
}

/// Half as many cells for the correlation length, or of a measured map other cells for each of the file's.
fn coarser(campaign: &Campaign, map_steps: Option<usize>) -> std::result::Result<Campaign, String> {
    let mut other = campaign.clone();
    let surface = &mut other.surface;
    match &mut surface.kind {
        SurfaceKind::Smith(_) => return Err("a statistical surface has no cells".into()),
        SurfaceKind::Psd(_) => return Err("the pitch of [surface.psd] decides which waves there are".into()),
        SurfaceKind::File(map) => {
            map.refine = Some(match map_steps {
                Some(steps) if steps > 1 => steps as u32 / 2,
                _ => 2,
            });
            return Ok(other);
        }
        kind if !kind.has_own_correlation() => return Err("grains and shapes are exact".into()),
        _ => {}
    }
    if surface.cells < 32 || surface.correlation_cells < 4.0 {
        return Err(format!(
            "half of {} cells with half of correlation_cells = {} resolves nothing",
            surface.cells, surface.correlation_cells
        ));
    }
    surface.cells /= 2;
    surface.correlation_cells *= 0.5;
    Ok(other)
}
