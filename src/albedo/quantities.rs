//! What is tabulated of a measurement: albedos of all orders together and of each, and what did not leave.

use super::formula::{self, SIDES};
use crate::campaign::LightSide;
use crate::measure::IncidenceResult;

/// Orders that have columns of their own; all of them together always have.
const LISTED_ORDERS: usize = 8;

/// What a quantity is of: the incidence in all materials of a slab, as one value for each realisation.
pub(super) type OfIncidences = Box<dyn Fn(&[&IncidenceResult]) -> Vec<f64>>;

/// Values of all realisations, added up.
fn sum(orders: &[Vec<f64>], realisations: usize) -> Vec<f64> {
    (0..realisations).map(|k| orders.iter().map(|order| order[k]).sum()).collect()
}

fn all_back(incidence: &IncidenceResult) -> Vec<f64> {
    sum(&incidence.albedo_by_order, incidence.closure.len())
}

fn all_through(incidence: &IncidenceResult) -> Vec<f64> {
    sum(&incidence.transmittance_by_order, incidence.closure.len())
}

/// What was followed and did not leave.
fn rest(incidence: &IncidenceResult) -> Vec<f64> {
    let left = all_back(incidence).into_iter().zip(all_through(incidence));
    incidence.closure.iter().zip(left).map(|(closure, (back, through))| closure - back - through).collect()
}

const REST: &str = "followed and not left: beyond the last order, or absorbed";

/// Of mirror facets; the materials are F = 1 and F0 = 0.
pub(super) fn mirror(orders: usize) -> Vec<(String, String, OfIncidences)> {
    let [(_, _), (_, of_f0), (_, of_f90)] = formula::MIRROR;
    let mut all: Vec<(String, String, OfIncidences)> = vec![
        ("E".into(), "albedo with F = 1, all orders".into(), Box::new(|incidences| all_back(incidences[0]))),
        ("rest".into(), REST.into(), Box::new(|incidences| rest(incidences[0]))),
        (
            "E_f0_order1".into(),
            format!("{of_f0}; order 1"),
            Box::new(|incidences| {
                let [white, f90] = [0, 1].map(|k| &incidences[k].albedo_by_order[0]);
                white.iter().zip(f90).map(|(white, f90)| white - f90).collect()
            }),
        ),
        (
            "E_f90_order1".into(),
            format!("{of_f90}; order 1"),
            Box::new(|incidences| incidences[1].albedo_by_order[0].clone()),
        ),
    ];
    all.extend((0..orders.min(LISTED_ORDERS)).map(|order| {
        let of: OfIncidences = Box::new(move |incidences| incidences[0].albedo_by_order[order].clone());
        (format!("E_order{}", order + 1), format!("albedo with F = 1; order {}", order + 1), of)
    }));
    all
}

/// Of clear facets; the materials are the sides.
pub(super) fn clear(sides: &[LightSide], orders: usize) -> Vec<(String, String, OfIncidences)> {
    let mut all: Vec<(String, String, OfIncidences)> = Vec::new();
    for (k, &side) in sides.iter().enumerate() {
        let side = SIDES[usize::from(side == LightSide::Back)];
        let [(_, back), (_, through), _] = formula::CLEAR;
        let from = format!("light from {side}");
        all.extend([
            (
                format!("R_{side}"),
                format!("{back}; all orders, {from}"),
                Box::new(move |incidences: &[&IncidenceResult]| all_back(incidences[k])) as OfIncidences,
            ),
            (
                format!("T_{side}"),
                format!("{through}; all orders, {from}"),
                Box::new(move |incidences: &[&IncidenceResult]| all_through(incidences[k])),
            ),
            (
                format!("rest_{side}"),
                format!("{REST}; {from}"),
                Box::new(move |incidences: &[&IncidenceResult]| rest(incidences[k])),
            ),
        ]);
        for order in 0..orders.min(LISTED_ORDERS) {
            let number = order + 1;
            all.extend([
                (
                    format!("R_{side}_order{number}"),
                    format!("{back}; order {number}, {from}"),
                    Box::new(move |incidences: &[&IncidenceResult]| {
                        incidences[k].albedo_by_order[order].clone()
                    }) as OfIncidences,
                ),
                (
                    format!("T_{side}_order{number}"),
                    format!("{through}; order {number}, {from}"),
                    Box::new(move |incidences: &[&IncidenceResult]| {
                        incidences[k].transmittance_by_order[order].clone()
                    }),
                ),
            ]);
        }
    }
    all
}
