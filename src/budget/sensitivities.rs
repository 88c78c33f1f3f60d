//! Measures the derivatives of every pair of directions, with steps that are judged by what they give.

use super::differences::{Derivative, FivePoints, mixed};
use super::positions::{Displacement, Position};
use super::response::{Group, Response, is_angle};
use super::rig::{OpticsChange, Rig, Seen, Setting, Wanted};
use super::steps::balanced;
use crate::campaign::{InputQuantity, Optics, Quantity, SurfaceKind};
use crate::error::{Error, Result};

/// Slopes, half-angles and constants of materials move by this part of themselves, twice for the outer points; of slopes
/// the first step and the largest.
const SLOPE_STEPS: [f64; 2] = [0.1, 0.25];
const HALF_ANGLE_STEP: f64 = 0.2;
const CONSTANT_STEP: f64 = 0.02;
/// The arms move by this part of the lobe's width, and by this part of the aperture at least.
const LOBE_PART: f64 = 0.3;
const APERTURE_PART: f64 = 0.5;
/// Largest and smallest first step of the arms, degrees.
const LARGEST_STEP_DEG: f64 = 6.0;
const SMALLEST_STEP_DEG: f64 = 0.05;
/// The arms stay by twice the step and so much more above the horizon, parts of the step.
const ROOM: f64 = 2.2;

/// The responses of all pairs: \[pair\]\[colour\]. `values` are those of the campaign itself, by pair and colour;
/// `middle` what is seen of it with the random numbers of moved pairs.
pub fn responses(
    rig: &mut Rig,
    inputs: &[InputQuantity],
    positions: &[Position],
    values: &[Vec<f64>],
    middle: &[Seen],
    stage: &dyn Fn(&str),
) -> Result<Vec<Vec<Response>>> {
    let has = |quantity: Quantity| inputs.iter().any(|input| input.quantity == quantity);
    let blank = |(position, values): (&Position, &Vec<f64>)| {
        let of = |(colour, &value): (usize, &f64)| Response {
            position: *position,
            value,
            arms: None,
            slopes: None,
            cone: None,
            aperture: None,
            optics: None,
            constants: constants(&rig.campaign().optics, colour, inputs),
        };
        values.iter().enumerate().map(of).collect()
    };
    let mut all: Vec<Vec<Response>> = positions.iter().zip(values).map(blank).collect();
    if inputs.iter().any(|input| is_angle(input.quantity)) {
        stage("moving the arms");
        let groups = arms(rig, positions, values)?;
        fill(&mut all, groups, |response| &mut response.arms);
    }
    let nominal = Setting::NOMINAL;
    if has(Quantity::HeightScale) || has(Quantity::PitchScale) {
        stage("scaling the heights");
        let set = |x: f64| Setting { slopes: 1.0 + x, ..nominal };
        let groups = balanced(SLOPE_STEPS, values, |step| single(rig, positions, middle, step, &set))?;
        fill(&mut all, groups, |response| &mut response.slopes);
    }
    let [cone, aperture] = rig.half_angles_deg();
    let room = positions.iter().map(|position| position.room_deg(0.0, 0.0)).fold(90.0, f64::min);
    let step = |half_angle: f64| HALF_ANGLE_STEP.min((room / half_angle - 1.0) / ROOM);
    if has(Quantity::LampCone) {
        stage("widening the light's cone");
        let groups = single(rig, positions, middle, step(cone), &|x| Setting { cone: 1.0 + x, ..nominal })?;
        fill(&mut all, groups, |response| &mut response.cone);
    }
    if has(Quantity::SensorAperture) {
        stage("widening the aperture");
        let set = |x: f64| Setting { aperture: 1.0 + x, ..nominal };
        let groups = single(rig, positions, middle, step(aperture), &set)?;
        fill(&mut all, groups, |response| &mut response.aperture);
    }
    if !all[0][0].constants.is_empty() {
        stage("changing the material");
        let moved: Vec<Quantity> = all[0][0].constants.iter().map(|(quantity, _)| *quantity).collect();
        let groups = optics(rig, positions, middle, &moved)?;
        fill(&mut all, groups, |response| &mut response.optics);
    }
    Ok(all)
}

fn fill(
    all: &mut [Vec<Response>],
    groups: Vec<Vec<Group>>,
    of: impl Fn(&mut Response) -> &mut Option<Group>,
) {
    for (responses, groups) in all.iter_mut().zip(groups) {
        for (response, group) in responses.iter_mut().zip(groups) {
            *of(response) = Some(group);
        }
    }
}

/// The constants of a colour's material that have an uncertainty.
fn constants(optics: &Optics, colour: usize, inputs: &[InputQuantity]) -> Vec<(Quantity, f64)> {
    let media = match optics {
        Optics::Index(index) => index.by_colour(),
        Optics::Dielectric(clear) => clear.by_colour(),
        _ => vec![],
    };
    let value = |quantity: Quantity| match (quantity, optics) {
        (Quantity::N, Optics::Layered { eta, .. }) => Some(*eta),
        (Quantity::N, _) => media.get(colour).map(|medium| medium.eta),
        (Quantity::K, _) => media.get(colour).map(|medium| medium.k),
        (Quantity::F0, Optics::Schlick { f0, .. }) => f0.get(colour).copied(),
        (Quantity::Albedo, Optics::Diffuse { albedo } | Optics::Layered { albedo, .. }) => {
            albedo.get(colour).copied()
        }
        _ => None,
    };
    inputs.iter().filter_map(|input| Some((input.quantity, value(input.quantity)?))).collect()
}

/// One variable that leaves the directions alone.
fn single(
    rig: &mut Rig,
    positions: &[Position],
    middle: &[Seen],
    step: f64,
    set: &dyn Fn(f64) -> Setting,
) -> Result<Vec<Vec<Group>>> {
    let moved = moved_by(rig, positions, step, set)?;
    let of = |pair: usize, colour: usize| Group::of(vec![five(step, middle, &moved, pair, colour)]);
    Ok(each(middle, of))
}

/// Readings at -2, -1, 1 and 2 steps.
fn moved_by(
    rig: &mut Rig,
    positions: &[Position],
    step: f64,
    set: &dyn Fn(f64) -> Setting,
) -> Result<[Vec<Seen>; 4]> {
    let mut at = |steps: f64| rig.read_as_moved(&set(steps * step), positions);
    Ok([at(-2.0)?, at(-1.0)?, at(1.0)?, at(2.0)?])
}

fn five(step: f64, middle: &[Seen], moved: &[Vec<Seen>; 4], pair: usize, colour: usize) -> Derivative {
    let [a, b, c, d] = moved.each_ref().map(|seen| &seen[pair].brdf[colour][..]);
    let points: FivePoints = [a, b, &middle[pair].brdf[colour], c, d];
    Derivative::of(step, points)
}

fn each(middle: &[Seen], of: impl Fn(usize, usize) -> Group) -> Vec<Vec<Group>> {
    let colours = |pair: usize| (0..middle[pair].brdf.len()).map(|colour| of(pair, colour)).collect();
    (0..middle.len()).map(colours).collect()
}

/// n, f0 or albedo, and k: the same paths weighed anew. Two of them interact.
fn optics(
    rig: &mut Rig,
    positions: &[Position],
    middle: &[Seen],
    quantities: &[Quantity],
) -> Result<Vec<Vec<Group>>> {
    let step = constant_step(&rig.campaign().optics);
    let set = |moves: &[(Quantity, f64)]| {
        let mut optics = OpticsChange::NONE;
        moves.iter().for_each(|&(quantity, by)| optics.factors[OpticsChange::place(quantity)] += by);
        Setting { optics, ..Setting::NOMINAL }
    };
    let mut moved = Vec::new();
    for &quantity in quantities {
        moved.push(moved_by(rig, positions, step, &|x| set(&[(quantity, x)]))?);
    }
    let both = match quantities {
        &[a, b] => {
            let mut at = |x: f64| rig.read_as_moved(&set(&[(a, x), (b, x)]), positions);
            Some([at(step)?, at(-step)?])
        }
        _ => None,
    };
    let of = |pair: usize, colour: usize| {
        let first = moved.iter().map(|moved| five(step, middle, moved, pair, colour)).collect();
        let mut group = Group::of(first);
        if let Some(both) = &both {
            let values = |seen: &[Vec<Seen>; 2]| seen.each_ref().map(|seen| seen[pair].brdf[colour].clone());
            let alone =
                |k: usize| [&moved[k][2], &moved[k][1]].map(|seen: &Vec<Seen>| &seen[pair].brdf[colour][..]);
            let together = values(both);
            let together = together.each_ref().map(|values| &values[..]);
            let cross = mixed(step, &middle[pair].brdf[colour], together, alone(0), alone(1));
            group.second[0][1] = cross;
            group.second[1][0] = cross;
        }
        group
    };
    Ok(each(middle, of))
}

/// A part of the constants that leaves reflectances below 1, and indices on their side of 1.
fn constant_step(optics: &Optics) -> f64 {
    let of_reflectances =
        |all: &[f64; 3]| all.iter().map(|value| (1.0 / value - 1.0) / ROOM).fold(CONSTANT_STEP, f64::min);
    let of_index = |eta: f64| CONSTANT_STEP * ((eta - 1.0).abs() / eta).min(1.0);
    let media = optics.media();
    let indices = media.iter().filter(|medium| medium.k == 0.0).map(|medium| of_index(medium.eta));
    match optics {
        Optics::Schlick { f0: all, .. } | Optics::Diffuse { albedo: all } => of_reflectances(all),
        Optics::Layered { albedo, eta } => of_reflectances(albedo).min(of_index(*eta)),
        _ => indices.fold(CONSTANT_STEP, f64::min),
    }
}

/// Pairs of the four moves of the arms.
const CROSSED: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Moves of both arms, with the step at which truncation and noise are balanced, or both small enough.
fn arms(rig: &mut Rig, positions: &[Position], values: &[Vec<f64>]) -> Result<Vec<Vec<Group>>> {
    let [cone, aperture] = rig.half_angles_deg();
    let room = positions.iter().map(|position| position.room_deg(cone, aperture)).fold(90.0, f64::min);
    let most = (room / ROOM).min(LARGEST_STEP_DEG);
    if most < SMALLEST_STEP_DEG {
        return Err(Error::Refused(format!(
            "{}: an arm keeps {room:.2} degrees from the horizon, too few to move it by: lower theta_i_deg, theta_r_deg or \
             aperture_deg, or leave out the angles of [uncertainty]",
            rig.campaign().name
        )));
    }
    let step = first_step(rig, aperture.max(cone)).min(most);
    balanced([step, most], values, |step| arms_by(rig, positions, step))
}

/// A part of the lobe's half width, about alpha radians of the sensor, where a law says it.
fn first_step(rig: &Rig, half_angle: f64) -> f64 {
    let kind: &SurfaceKind = &rig.campaign().surface.kind;
    let alphas = kind.alphas().into_iter().flatten().map(|alpha| alpha.x.min(alpha.y));
    let lobe = alphas.reduce(f64::min).map_or(0.0, |alpha| LOBE_PART * alpha.to_degrees());
    lobe.max(APERTURE_PART * half_angle).max(SMALLEST_STEP_DEG)
}

fn arms_by(rig: &mut Rig, positions: &[Position], step: f64) -> Result<Vec<Vec<Group>>> {
    let along = |places: &[usize], steps: f64| {
        let mut by: Displacement = [0.0; 4];
        places.iter().for_each(|&place| by[place] = steps * step);
        by
    };
    let mut moves = vec![[0.0; 4]];
    moves.extend((0..4).flat_map(|k| [-2.0, -1.0, 1.0, 2.0].map(|steps| along(&[k], steps))));
    moves.extend(CROSSED.iter().flat_map(|both| [1.0, -1.0].map(|steps| along(both, steps))));
    let one = |position: &Position| {
        let of = |by: &Displacement| Wanted { drawn_as: Some(*position), at: position.moved(*by) };
        moves.iter().map(of).collect::<Vec<_>>()
    };
    let wanted: Vec<Wanted> = positions.iter().flat_map(one).collect();
    let seen = rig.read(&Setting::NOMINAL, &wanted)?;
    let of = |seen: &[Seen], colour: usize| {
        let at = |place: usize| &seen[place].brdf[colour][..];
        let alone = |k: usize| [0, 1, 2, 3].map(|place| at(1 + 4 * k + place));
        let first = |k: usize| {
            let [a, b, c, d] = alone(k);
            Derivative::of(step, [a, b, at(0), c, d])
        };
        let mut group = Group::of((0..4).map(first).collect());
        for (place, &[j, k]) in CROSSED.iter().enumerate() {
            let inner = |k: usize| [alone(k)[2], alone(k)[1]];
            let both = [at(17 + 2 * place), at(18 + 2 * place)];
            let cross = mixed(step, at(0), both, inner(j), inner(k));
            group.second[j][k] = cross;
            group.second[k][j] = cross;
        }
        group
    };
    let colours = |seen: &[Seen]| (0..seen[0].brdf.len()).map(|colour| of(seen, colour)).collect();
    Ok(seen.chunks(moves.len()).map(colours).collect())
}
