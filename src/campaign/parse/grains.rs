//! `[surface.grains]`.

use super::reader::{Bounds, Slot, TableReader};
use super::roughness::{alphas_of, one_or_more};
use crate::campaign::schema::{Alpha, GrainBase, GrainShape, Grains};

/// Words for [`GrainBase`].
pub(crate) const BASES: [(&str, GrainBase); 2] =
    [("mirror", GrainBase::Mirror), ("absorbing", GrainBase::Absorbing)];

/// Words for [`GrainShape`].
pub(crate) const SHAPES: [(&str, GrainShape); 3] =
    [("grains", GrainShape::Grains), ("pits", GrainShape::Pits), ("heights", GrainShape::Heights)];

const COVERAGE: Bounds =
    Bounds::closed(1e-4, 0.999).advice("hardly a grain is hit", "the plane is never seen: take less");

/// Side of a patch in radii: below, grains meet themselves across its edges.
const SIDE: Bounds = Bounds::closed(8.0, 10_000.0)
    .advice("grains would meet their own copies", "take more realisations instead");

pub(super) fn grains(table: TableReader<'_>) -> Option<Grains> {
    let [coverage, side, base, shape, slopes @ ..] =
        table.keys(["coverage", "side", "base", "shape", "alpha", "alpha_x", "alpha_y"]);
    let given = coverage.required("the share of the plane that grains cover, such as 0.5");
    let coverages = given.and_then(|i| one_or_more(i, &COVERAGE, "coverage"));
    let shape = shape.or(GrainShape::Grains, |i| i.choice(&SHAPES));
    let heights = shape == Some(GrainShape::Heights);
    let absent = |slot: &Slot<'_>| slot.absent("belongs to grains and pits; heights have cells and no plane");
    let side =
        if heights { absent(&side).map(|()| None) } else { side.or(None, |i| i.float(&SIDE).map(Some)) };
    let base = if heights { absent(&base) } else { Some(()) }
        .and_then(|()| base.or(GrainBase::Mirror, |i| i.choice(&BASES)));
    let (alphas, coverages) = (alphas_of(slopes), coverages?);
    let (alphas, side, base, shape) = (alphas?, side?, base?, shape?);
    if heights && coverages.len() > 1 {
        return coverage.refuse("is a list: heights are made for one coverage at a time");
    }
    if alphas.len() > 1 && coverages.len() > 1 {
        return coverage.refuse("is a list, as alpha is: one of them at a time; give the other a number");
    }
    let with =
        |alpha: &Alpha| coverages.iter().map(|&c| Alpha { coverage: Some(c), ..*alpha }).collect::<Vec<_>>();
    Some(Grains { alphas: alphas.iter().flat_map(with).collect(), side, base, shape })
}
