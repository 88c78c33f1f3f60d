//! Facets of a periodic square field, a vector of cells at a time.

use crate::lanes::vector::Lanes;

/// Cells that are always looked at together: sums over them have one order, whatever the lanes. No vector is wider.
pub(super) const GROUP: usize = 16;

/// Two neighbouring rows of heights, continued past their end by what a vector may read.
pub(super) struct Rows {
    near: Vec<f32>,
    far: Vec<f32>,
}

/// The slopes and mean heights of the facets of one family, as many cells as lanes.
pub(super) struct Facets<L: Lanes> {
    pub slope: [L::F; 2],
    pub mean: L::F,
}

impl Rows {
    /// Rows of `near` and `far`, of equal length.
    pub fn new(near: &[f32], far: &[f32]) -> Self {
        let mut rows = Rows { near: padded(near.len()), far: padded(near.len()) };
        copy(near, &mut rows.near);
        copy(far, &mut rows.far);
        rows
    }

    /// Goes on to the next row: the far one is the near one.
    pub fn advance(&mut self, far: &[f32]) {
        std::mem::swap(&mut self.near, &mut self.far);
        copy(far, &mut self.far);
    }

    /// The lower and the upper facets of the cells from `x` on; behind the last cell the first ones follow.
    #[inline(always)]
    pub fn facets<L: Lanes>(&self, l: L, x: usize) -> [Facets<L>; 2] {
        let (h00, h10) = (l.load(&self.near[x..]), l.load(&self.near[x + 1..]));
        let (h01, h11) = (l.load(&self.far[x..]), l.load(&self.far[x + 1..]));
        let diagonal = l.add(h10, h01);
        let mean = |corner| l.mul(l.splat(1.0 / 3.0), l.add(corner, diagonal));
        [
            Facets { slope: [l.sub(h10, h00), l.sub(h01, h00)], mean: mean(h00) },
            Facets { slope: [l.sub(h11, h01), l.sub(h11, h10)], mean: mean(h11) },
        ]
    }
}

impl<L: Lanes> Facets<L> {
    /// The squared lengths of the slopes.
    #[inline(always)]
    pub fn squared(&self, l: L) -> L::F {
        let [x, y] = self.slope;
        l.add(l.mul(x, x), l.mul(y, y))
    }
}

/// Calls `visit` with every row of cells of a square field.
#[inline(always)]
pub(super) fn each_row(heights: &[f32], side: usize, mut visit: impl FnMut(&Rows)) {
    let row = |y: usize| &heights[y * side..][..side];
    let mut rows = Rows::new(row(0), row(1));
    for y in 0..side {
        visit(&rows);
        rows.advance(row((y + 2) % side));
    }
}

/// Room for a row of `side` values and what vectors read or write past its end.
pub(super) fn padded(side: usize) -> Vec<f32> {
    vec![0.0; side.next_multiple_of(GROUP) + GROUP]
}

fn copy(row: &[f32], to: &mut [f32]) {
    for part in to.chunks_mut(row.len()) {
        part.copy_from_slice(&row[..part.len()]);
    }
}
