//! The surface samples of several blocks, in the order of their places.

use rand_pcg::Pcg64Dxsm;

use super::areas::point_in;
use super::slope_index::SlopeIndex;
use super::slope_order::SlopeSampler;
use crate::surface::Heightfield;
use crate::surface::heightfield::Corners;
use crate::trace::ray::surface_point::{Facet, SurfacePoint};

/// The surface samples of several blocks, to be followed together: rays that begin in one part of a patch look at the same
/// heights, whichever block they belong to.
#[derive(Default)]
pub struct BatchedStarts {
    /// The places in the index of each block's facets, by slope.
    places: Vec<Vec<u32>>,
    /// What is left of each block's stream.
    streams: Vec<Pcg64Dxsm>,
}

/// One sample.
#[derive(Clone, Copy, Default)]
struct Start {
    facet: u32,
    tile: u16,
    block: u16,
}

/// Samples of one tile follow each other: it has so many cells a side, more in fields of more than 4096, and what its
/// samples read first fits the cache nearest to a core.
const TILE: usize = 16;
/// Tiles along a side, at most: their number has 16 bits.
const MOST_TILES: usize = 256;

impl BatchedStarts {
    /// Blocks that can be followed together.
    pub const MOST_BLOCKS: usize = 1 << 8;
    /// Bytes of a sample: its place, and twice what it is put in order by.
    pub const BYTES: usize = size_of::<u32>() + 2 * size_of::<Start>();

    /// Adds `count` samples of equal flux; its number is how many blocks there were before. How many of them a bin of
    /// the index gets follows from equal steps; which of its facets, from their areas, by rejection.
    pub fn add(&mut self, starts: &SlopeSampler, count: u64, mut stream: Pcg64Dxsm) {
        self.places.push(starts.places(count, &mut stream));
        self.streams.push(stream);
    }

    /// Calls `visit` with every sample and its block, in the order of the places: for each block the same samples in the
    /// same order as if it were alone.
    ///
    /// `corners` are the heights of a facet's cell.
    // Tested by `blocks_together_start_where_each_starts_alone`.
    pub fn each(
        mut self,
        index: &SlopeIndex,
        field: &Heightfield,
        corners: impl Fn(&Facet) -> Corners,
        mut visit: impl FnMut(usize, SurfacePoint),
    ) {
        let streams = &mut std::mem::take(&mut self.streams);
        for Start { facet, block, .. } in self.in_tiles(index, field) {
            let (facet, block) = (index.at(facet), usize::from(block));
            let (u, v) = point_in(facet.upper, &mut streams[block]);
            visit(block, SurfacePoint::between(corners(&facet), facet, u, v));
        }
    }

    /// The samples by tile, those of a block in a tile in the order in which they are, by counting.
    fn in_tiles(self, index: &SlopeIndex, field: &Heightfield) -> Vec<Start> {
        let (cells_x, cells_y) = (field.cells_x(), field.cells_y());
        let side = TILE.max(cells_x.max(cells_y).div_ceil(MOST_TILES)).next_power_of_two();
        let (log_side, tiles_x) = (side.trailing_zeros(), cells_x.div_ceil(side));
        let mut first = vec![0u32; tiles_x * cells_y.div_ceil(side)];
        let mut starts = Vec::with_capacity(self.places.iter().map(Vec::len).sum());
        // Row by row of the index, of which all blocks read the same part then.
        let mut left: Vec<&[u32]> = self.places.iter().map(Vec::as_slice).collect();
        for row in 0..index.rows() {
            for (block, left) in left.iter_mut().enumerate() {
                let (here, later) =
                    left.split_at(left.partition_point(|&place| place < index.end_of_row(row)));
                *left = later;
                starts.extend(here.iter().map(|&place| {
                    let facet = index.number(place);
                    let Facet { x, y, .. } = index.at(facet);
                    let tile = (y >> log_side) * tiles_x + (x >> log_side);
                    first[tile] += 1;
                    Start { facet, tile: tile as u16, block: block as u16 }
                }));
            }
        }
        let mut before = 0;
        for first in &mut first {
            before += std::mem::replace(first, before);
        }
        let mut sorted = vec![Start::default(); starts.len()];
        for start in starts {
            let next = &mut first[usize::from(start.tile)];
            sorted[*next as usize] = start;
            *next += 1;
        }
        sorted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{self, Purpose, StreamId};
    use crate::sphere;

    const SIDE: usize = 32;

    fn field() -> Heightfield {
        let height = |k: usize| 3.0 * (0.37 * k as f64).sin() * (1.3 * k as f64).cos();
        Heightfield::new(SIDE, SIDE, true, (0..SIDE * SIDE).map(height).collect())
    }

    #[test]
    fn blocks_together_start_where_each_starts_alone() {
        let field = field();
        let index = SlopeIndex::new(&field).expect("periodic");
        let lights = [10.0, 130.0, 250.0].map(|phi| sphere::direction_deg(50.0, phi));
        let stream = |block: usize| {
            let id = StreamId {
                seed: 7,
                purpose: Purpose::Test,
                realisation: 0,
                incidence: 0,
                block: block as u64,
            };
            rng::stream(id)
        };
        let starts_of = |blocks: &[usize]| {
            let mut together = BatchedStarts::default();
            for &block in blocks {
                let mut stream = stream(block);
                together.add(&SlopeSampler::new(&index, &field, lights[block], &mut stream), 500, stream);
            }
            let mut starts = vec![Vec::new(); blocks.len()];
            let corners = |facet: &Facet| field.corners(facet.x, facet.y);
            together.each(&index, &field, corners, |block, place| starts[block].push(place));
            starts
        };
        let alone = [0, 1, 2].map(|block| starts_of(&[block]).concat());
        assert_eq!(starts_of(&[0, 1, 2]), alone);
        assert!(alone.iter().all(|starts| starts.len() == 500));
    }
}
