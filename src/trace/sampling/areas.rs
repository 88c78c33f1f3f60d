//! Surface samples, where paths begin: points on the facets, in proportion to the projected area, which is what a facet
//! shows the light.
//!
//! A block is one systematic pass over the patch: equal steps along the running sum of max(0, wi.m) A over all
//! facets, one offset, a uniform point in the facet. All samples of a block carry the same flux.

use glam::DVec3;
use rand_pcg::Pcg64Dxsm;

use super::systematic_steps::SystematicSteps;
use crate::rng;
use crate::surface::Heightfield;
use crate::surface::io::prepare::cell_mask::CellMask;
use crate::trace::ray::surface_point::{Facet, SurfacePoint};

/// Surface samples in a block.
pub const BLOCK: u64 = 65_536;

/// A rectangle of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Columns [first, end).
    pub x: (usize, usize),
    /// Rows [first, end).
    pub y: (usize, usize),
}

impl Window {
    /// The whole field.
    pub fn all(field: &Heightfield) -> Self {
        Window { x: (0, field.cells_x()), y: (0, field.cells_y()) }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        (self.x.1 - self.x.0) * (self.y.1 - self.y.0)
    }

    /// Number of cells that `excluded` does not hold.
    pub fn cells_outside(&self, excluded: Option<&CellMask>) -> usize {
        let Some(excluded) = excluded else { return self.cells() };
        let row = |y: usize| (self.x.0..self.x.1).filter(|&x| !excluded.holds(x, y)).count();
        (self.y.0..self.y.1).map(row).sum()
    }
}

/// Cells whose projected areas are summed together: a sample evaluates one such group.
const GROUP: usize = 4;

/// The projected areas of a window's facets towards one light direction, summed by groups of cells: what a block
/// steps along. Serves any number of blocks.
pub struct AreaSampler<'a> {
    field: &'a Heightfield,
    window: Window,
    /// Cells of the window that no sample lies on.
    excluded: Option<&'a CellMask>,
    /// The others.
    cells: usize,
    /// Canonical light direction in field coordinates.
    light: DVec3,
    /// `before[k]` = area of the groups before group k, row by row; one entry more than groups.
    before: Vec<f64>,
}

impl<'a> AreaSampler<'a> {
    /// Sums the projected areas of `field`'s facets in `window` towards `light` (canonical, field coordinates): that of
    /// a facet of slope (p, q) is max(0, light.z - light.x p - light.y q)/2 of a cell's.
    pub fn new(field: &'a Heightfield, window: Window, light: DVec3) -> Self {
        Self::outside(field, window, light, None)
    }

    /// The same without the cells that `excluded` holds: the window is what is left of it.
    // Tested by `excluded_cells_have_no_samples_and_no_area` (tests/it/surface/prepared_maps.rs).
    pub fn outside(
        field: &'a Heightfield,
        window: Window,
        light: DVec3,
        excluded: Option<&'a CellMask>,
    ) -> Self {
        let cells = window.cells_outside(excluded);
        let mut starts = AreaSampler { field, window, excluded, cells, light, before: vec![0.0] };
        let mut areas = vec![[0.0; 2]; window.x.1 - window.x.0];
        let (mut near, mut far) = (vec![0.0; areas.len() + 1], vec![0.0; areas.len() + 1]);
        copy_heights(field, window.y.0, window.x.0, &mut far);
        let mut sum = 0.0;
        for y in window.y.0..window.y.1 {
            std::mem::swap(&mut near, &mut far);
            copy_heights(field, y + 1, window.x.0, &mut far);
            projected_areas(&near, &far, light, &mut areas);
            starts.leave_out(window.x.0, y, &mut areas);
            for group in areas.chunks(GROUP) {
                sum += group.as_flattened().iter().sum::<f64>();
                starts.before.push(sum);
            }
        }
        starts
    }

    /// Bytes of its sums.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.before)
    }

    /// The flux of one sample of a block of `count`, as a fraction of the flux that falls on the window: the projected
    /// area over light.z x cells x count. Over all samples it sums to at least 1: those that are shadowed
    /// are counted, and dropped.
    pub fn flux_fraction(&self, count: u64) -> f64 {
        self.total() / (self.light.z * self.cells as f64 * count as f64)
    }

    fn total(&self) -> f64 {
        self.before[self.before.len() - 1]
    }

    /// Calls `visit` with `count` surface samples of equal flux, in the order of the facets.
    pub fn each(&self, count: u64, rng: &mut Pcg64Dxsm, mut visit: impl FnMut(SurfacePoint)) {
        let mut steps = SystematicSteps::new(count, self.total() / count as f64, rng::uniform(rng));
        let mut start = |facet: Facet| {
            let (u, v) = point_in(facet.upper, rng);
            visit(SurfacePoint::on(self.field, facet, u, v));
        };
        for (group, ends) in self.before.windows(2).enumerate() {
            if steps.is_before(ends[1]) {
                let facets = self.facets(group);
                while let Some(position) = steps.take(ends[1]) {
                    start(facets.at(position - ends[0]));
                }
            }
        }
        // Rounding may leave a step beyond the sum: it belongs to the last facet.
        if !steps.is_over()
            && let Some(group) = self.before.windows(2).rposition(|ends| ends[0] < ends[1])
        {
            let last = self.facets(group).at(f64::INFINITY);
            while steps.take(f64::INFINITY).is_some() {
                start(last);
            }
        }
    }

    /// The facets of a group and their projected areas.
    fn facets(&self, group: usize) -> Facets {
        let width = self.window.x.1 - self.window.x.0;
        let in_row = width.div_ceil(GROUP);
        let (y, left) = (self.window.y.0 + group / in_row, group % in_row * GROUP);
        let (first, cells) = (self.window.x.0 + left, GROUP.min(width - left));
        let (mut near, mut far) = ([0.0; GROUP + 1], [0.0; GROUP + 1]);
        copy_heights(self.field, y, first, &mut near[..=cells]);
        copy_heights(self.field, y + 1, first, &mut far[..=cells]);
        let mut areas = [[0.0; 2]; GROUP];
        projected_areas(&near, &far, self.light, &mut areas);
        areas[cells..].fill([0.0; 2]);
        self.leave_out(first, y, &mut areas[..cells]);
        Facets { first, y, areas }
    }

    /// Takes the areas of excluded cells away; the first is cell (first, y).
    fn leave_out(&self, first: usize, y: usize, areas: &mut [[f64; 2]]) {
        let Some(excluded) = self.excluded else { return };
        let out = areas.iter_mut().enumerate().filter(|(k, _)| excluded.holds(first + k, y));
        out.for_each(|(_, areas)| *areas = [0.0; 2]);
    }
}

/// The facets of one group of cells.
struct Facets {
    /// Column of the first cell.
    first: usize,
    y: usize,
    areas: [[f64; 2]; GROUP],
}

impl Facets {
    /// The facet in which the running sum over the group passes `position`; beyond the sum the last one that is
    /// turned to the light.
    fn at(&self, position: f64) -> Facet {
        let areas = self.areas.as_flattened();
        let mut sum = 0.0;
        // Counted, not searched: the processor cannot guess where a search ends.
        let passed = areas.iter().map(|area| {
            sum += area;
            usize::from(sum <= position)
        });
        let mut index = passed.sum();
        if index == areas.len() {
            index = areas.iter().rposition(|&area| area > 0.0).unwrap_or(0);
        }
        Facet { x: self.first + index / 2, y: self.y, upper: index % 2 == 1 }
    }
}

/// The areas of the lower and of the upper facet of neighbouring cells, from the heights along their two rows.
#[inline]
fn projected_areas(near: &[f64], far: &[f64], light: DVec3, areas: &mut [[f64; 2]]) {
    let cells = areas.len();
    let (near, far) = (&near[..=cells], &far[..=cells]);
    for k in 0..cells {
        let turned = |p: f64, q: f64| {
            let turned = 0.5 * (light.z - (light.x * p + light.y * q));
            // One instruction, unlike `f64::max`, which looks for NaN.
            if turned > 0.0 { turned } else { 0.0 }
        };
        areas[k] = [
            turned(near[k + 1] - near[k], far[k] - near[k]),
            turned(far[k + 1] - far[k], far[k + 1] - near[k + 1]),
        ];
    }
}

/// The heights of row `y` from column `first` on: the row after the last of a periodic field is its first, likewise
/// the column.
pub(crate) fn copy_heights(field: &Heightfield, y: usize, first: usize, into: &mut [f64]) {
    let width = field.heights().len() / (field.cells_y() + usize::from(!field.is_periodic()));
    let y = if field.is_periodic() && y == field.cells_y() { 0 } else { y };
    let row = &field.heights()[y * width..(y + 1) * width];
    // One by one for a group: calls that copy cost more than five numbers.
    if first + into.len() <= width {
        into.iter_mut().zip(&row[first..]).for_each(|(to, from)| *to = *from);
    } else {
        into.iter_mut().zip(row[first..].iter().chain(row)).for_each(|(to, from)| *to = *from);
    }
}

/// A uniform point of the lower (u + v <= 1) or of the upper facet: the square folded over its diagonal.
pub(crate) fn point_in(upper: bool, rng: &mut Pcg64Dxsm) -> (f64, f64) {
    let (a, b) = (rng::uniform(rng), rng::uniform(rng));
    let (u, v) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
    if upper { (1.0 - u, 1.0 - v) } else { (u, v) }
}
