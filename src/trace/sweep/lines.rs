//! Parallel lines over a field, the measure that they turn to each light, and the starts along them.

use glam::{DVec2, DVec3};

use super::beam::{Beam, Carried, LINES};
use super::layout::Layout;
use super::pass::Pass;
use super::steps::{Due, Steps};
use super::strip::Course;
use crate::trace::walk::Place;

/// Lines of one azimuth over a field, and what each turns to each of several lights.
pub struct Sweep<'a> {
    pub(super) layout: &'a Layout<'a>,
    /// Whether lines run along x, else along y.
    pub(super) along_x: bool,
    pub(super) course: Course,
    beams: Vec<Beam>,
}

impl<'a> Sweep<'a> {
    /// Lines against `heading` (field coordinates, towards the lights; any length, zero included) across the whole
    /// field, at `offset` in [0, 1) of a cell, and the measure that each turns to `lights`.
    ///
    /// - `lights`: canonical directions in field coordinates, z > 0, all over `heading`.
    /// - Over a uniform offset every point of the field is on a line with the same density.
    /// - Held by: `tests/it/trace/sweep.rs`.
    pub fn new(layout: &'a Layout<'a>, heading: DVec2, lights: &[DVec3], offset: f64) -> Self {
        let along_x = heading.x.abs() > heading.y.abs();
        let (along, across) = if along_x { (heading.x, heading.y) } else { (heading.y, heading.x) };
        let (nx, ny) = (layout.field.cells_x(), layout.field.cells_y());
        let course = Course {
            forward: along < 0.0,
            slope: if along == 0.0 { 0.0 } else { -across / along.abs() },
            offset,
            cells: if along_x { (nx, ny) } else { (ny, nx) },
        };
        let beam = |light: &DVec3| {
            let reach = if along_x { light.x.abs() } else { light.y.abs() };
            Beam::new(reach, light.z, layout.range)
        };
        let mut sweep = Sweep { layout, along_x, course, beams: lights.iter().map(beam).collect() };
        sweep.sum_turned();
        sweep
    }

    /// Number of lines.
    fn lines(&self) -> usize {
        self.course.cells.1
    }

    /// Number of counted strips.
    fn strips(&self) -> i64 {
        self.course.cells.0 as i64
    }

    /// The measure that the lines turn to light `light`, in cells: its mean over offsets is the sum of
    /// max(0, wi.m) A over all facets.
    pub fn turned(&self, light: usize) -> f64 {
        self.beams[light].before[self.lines()]
    }

    /// The flux of one start of a block of `count`, as a share of the flux that falls on the field: the measure
    /// turned by *these lines* over light.z x cells x count. As both it and the starts follow the offset, the
    /// starts' flux times any function of the facet is unbiased, and all starts of a block weigh the same.
    pub fn share(&self, light: usize, count: u64) -> f64 {
        let cells = self.lines() as f64 * self.strips() as f64;
        self.turned(light) / (self.beams[light].rise * cells * count as f64)
    }

    /// The part of `turned` that each light sees. On a torus it is light.z x cells up to the lines' ends.
    pub fn visible(&self) -> Vec<f64> {
        let mut visible = vec![0.0; self.beams.len()];
        for first in (0..self.lines()).step_by(LINES) {
            let mut depths = vec![[0.0; LINES]; self.beams.len()];
            // Lit measure of a line = all changes of g + what the depth grew: counted from the first strip on.
            let lines = (self.lines() - first).min(LINES);
            let begin = -self.longest_run_in();
            let mut pass = Pass::new(self, first, begin);
            for index in begin..self.strips() {
                let strip = pass.enter(index);
                for ((beam, depths), visible) in self.beams.iter().zip(&mut depths).zip(&mut visible) {
                    if index == 0 {
                        let at = |j: usize| beam.reach * pass.heights[0][j] + depths[j];
                        *visible -= (0..lines).map(at).sum::<f64>();
                    }
                    if index >= -beam.run_in {
                        beam.sink(&strip, &pass.heights, depths);
                    }
                    if index + 1 == self.strips() {
                        let end = &pass.heights[strip.segments().len()];
                        let at = |j: usize| beam.reach * end[j] + depths[j];
                        *visible += (0..lines).map(at).sum::<f64>();
                        *visible += beam.rise * self.strips() as f64 * lines as f64;
                    }
                }
                pass.leave(&strip);
            }
        }
        visible
    }

    /// Calls `visit(light, place, lit)` with `count` starts of equal flux for each light: equal steps along the
    /// running sum of the turned measure, line by line, from `offsets[light]` in [0, 1) of a step. The order of the
    /// calls is that of the pass. What a light gets does not depend on the others.
    pub fn each(&self, count: u64, offsets: &[f64], mut visit: impl FnMut(usize, Place, bool)) {
        let steps = self.beams.iter().zip(offsets).map(|(beam, &offset)| Steps::new(beam, count, offset));
        let steps: Vec<Steps> = steps.collect();
        for first in (0..self.lines()).step_by(LINES) {
            let mut due: Vec<Due> = steps.iter().map(|steps| Due::new(steps, first)).collect();
            let mut carried = vec![[Carried::START; 2]; self.beams.len()];
            let begin = -self.longest_run_in();
            let mut pass = Pass::new(self, first, begin);
            for index in begin..self.strips() {
                let strip = pass.enter(index);
                for (light, ([before, after], beam)) in carried.iter_mut().zip(&self.beams).enumerate() {
                    if index >= 0 {
                        beam.carry(&strip, &pass.heights, before, after);
                        let due = (&steps[light], &mut due[light]);
                        pass.take_due(&strip, due, before, after, &mut |place, lit| visit(light, place, lit));
                        std::mem::swap(before, after);
                    } else if index >= -beam.run_in {
                        beam.sink(&strip, &pass.heights, &mut before.depths);
                    }
                }
                pass.leave(&strip);
            }
        }
    }

    fn longest_run_in(&self) -> i64 {
        self.beams.iter().map(|beam| beam.run_in).max().unwrap_or(0)
    }

    /// Fills `before` of all beams.
    fn sum_turned(&mut self) {
        for first in (0..self.lines()).step_by(LINES) {
            let mut sums = vec![[0.0; LINES]; self.beams.len()];
            let mut pass = Pass::new(self, first, 0);
            for index in 0..self.strips() {
                let strip = pass.enter(index);
                for (beam, sums) in self.beams.iter().zip(&mut sums) {
                    beam.sum(&strip, &pass.heights, sums);
                }
                pass.leave(&strip);
            }
            let lines = (self.lines() - first).min(LINES);
            for (beam, sums) in self.beams.iter_mut().zip(&sums) {
                beam.add_lines(&sums[..lines]);
            }
        }
    }
}
