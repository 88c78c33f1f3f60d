//! A scene: heights and rays from files, rates by processor time.

use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use gonio::surface::Heightfield;
use gonio::trace::{Facet, GridTraversal, Kernel, MaxPyramid, SimdTraversal, SurfacePoint};
use rustix::time::{ClockId, clock_gettime};

use super::array;
use super::work::{self, Tracing};

/// What is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Workload {
    /// Any hit along one direction.
    Mask,
    /// Any hit along the facets' mirror directions.
    Shadow,
    /// From above: closest hit, mirror, any hit.
    Full,
    /// From above: closest hits through up to 10 mirrors.
    Path,
}

impl Workload {
    /// All of them.
    pub const ALL: [Workload; 4] = [Workload::Mask, Workload::Shadow, Workload::Full, Workload::Path];

    /// Its name: w0 to w3.
    pub fn name(self) -> &'static str {
        ["w0", "w1", "w2", "w3"][self as usize]
    }

    /// The rays' file; paths start as the full workload does.
    fn file(self) -> &'static str {
        ["w0", "w1", "w2", "w2"][self as usize]
    }
}

/// A scene to trace.
pub struct Scene {
    folder: PathBuf,
    cells: usize,
    field: Heightfield,
}

/// One line of the result.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What was traced.
    pub work: Workload,
    /// Rays in the file.
    pub samples: usize,
    /// Rays traced for each of them.
    pub rays_per_sample: f64,
    /// Processor seconds of each repetition, ascending.
    pub seconds: Vec<f64>,
    /// Share of the samples that escape.
    pub escaped: f64,
    /// Share of the rays that the f64 walk hits otherwise; for paths the summed differences of the arrivals'
    /// histogram over the samples.
    pub differs: f64,
}

impl Row {
    /// Millions of rays per processor second, median of the repetitions.
    pub fn rate(&self) -> f64 {
        self.samples as f64 * self.rays_per_sample / self.median_seconds() * 1e-6
    }

    /// Processor time of the median repetition.
    pub fn median_seconds(&self) -> f64 {
        self.seconds[self.seconds.len() / 2]
    }

    /// `seconds` for all samples, in nanoseconds for each.
    pub fn nanoseconds(&self, seconds: f64) -> f64 {
        seconds / self.samples as f64 * 1e9
    }
}

impl Scene {
    /// Reads the heights of the scene of `cells` x `cells` in `folder`.
    pub fn read(folder: &Path, cells: usize) -> Result<Self, String> {
        let path = folder.join(format!("hf_{cells}.npy"));
        let heights = array::read(&path, &[Some(cells), Some(cells)])?;
        let field = Heightfield::new(cells, cells, true, heights.into_iter().map(f64::from).collect());
        Ok(Scene { folder: folder.to_path_buf(), cells, field })
    }

    /// Traces one workload `repetitions` times, after one that is dropped.
    pub fn run(&self, work: Workload, kernel: Kernel, repetitions: usize) -> Result<Row, String> {
        let path = self.folder.join(format!("{}_{}.npy", work.file(), self.cells));
        let values = array::read(&path, &[None, Some(6)])?;
        let rays: Vec<[f32; 6]> = values.as_chunks().0.to_vec();
        let lanes = MaxPyramid::new(&self.field)
            .ok_or_else(|| format!("{} cells a side: the lanes take powers of two from 8", self.cells))?;
        let traversal = GridTraversal::new(&self.field);
        let over = SimdTraversal::new(traversal, &lanes, kernel);
        let mut seconds = Vec::new();
        let mut found = Tracing::default();
        for repetition in 0..=repetitions {
            let before = thread_seconds();
            found = work::trace(work, &over, &rays);
            if repetition > 0 {
                seconds.push(thread_seconds() - before);
            }
        }
        seconds.sort_by(f64::total_cmp);
        let reference = work::trace_by_walk(work, &traversal, &rays);
        Ok(Row {
            work,
            samples: rays.len(),
            rays_per_sample: found.rays as f64 / rays.len() as f64,
            seconds,
            escaped: found.escaped as f64 / rays.len() as f64,
            differs: found.differences(&reference) as f64 / rays.len() as f64,
        })
    }
}

/// Processor time of this thread.
fn thread_seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// A ray of the scene as the walk takes it: start and direction.
#[inline]
pub fn start_of(field: &Heightfield, ray: &[f32; 6]) -> (SurfacePoint, DVec3) {
    let ((x, u), (y, v)) = (cell_of(ray[0]), cell_of(ray[1]));
    // Sides are powers of two: a mask wraps negative cells too.
    let facet = Facet {
        x: x as usize & (field.cells_x() - 1),
        y: y as usize & (field.cells_y() - 1),
        upper: u + v > 1.0,
    };
    let [z, dx, dy, dz] = [ray[2], ray[3], ray[4], ray[5]].map(f64::from);
    // What a ray meets does not ask for the slope where it starts.
    let slope = DVec2::ZERO;
    (SurfacePoint { facet, u: f64::from(u), v: f64::from(v), z, slope }, DVec3::new(dx, dy, dz))
}

/// The cell of a coordinate, and the place inside it.
#[inline]
fn cell_of(at: f32) -> (i64, f32) {
    let towards_zero = at as i64;
    let cell = towards_zero - i64::from(towards_zero as f32 > at);
    (cell, at - cell as f32)
}
