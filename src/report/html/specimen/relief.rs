//! The piece of the patch as a relief: its heights, how much too high they are drawn, and a bar for the scale.

use crate::surface::Heightfield;

/// Heights for the script.
#[derive(Debug, Clone)]
pub struct Relief {
    /// Row 0 on top (largest y), 0 the lowest and 255 the highest of the piece.
    pub heights: Vec<u8>,
    /// From 0 to 255, in widths of a cell along x, as it is drawn.
    pub high: f64,
    /// How many times too high it is drawn.
    pub exaggeration: f64,
    /// Length of the bar along x, cells, and what it says.
    pub bar_cells: f64,
    /// The same in words.
    pub bar_text: String,
}

impl Relief {
    /// The corner of a patch with `cells`. `slope`: along x, of one unit of height a cell; `pitch_um`: width of a cell where it
    /// is known.
    pub fn new(
        field: &Heightfield,
        [columns, rows]: [usize; 2],
        slope: f64,
        exaggeration: f64,
        pitch_um: Option<f64>,
    ) -> Self {
        let height = |x: usize, y: usize| field.corners(x, y).h00;
        let all = || (0..rows).rev().flat_map(|y| (0..columns).map(move |x| height(x, y)));
        let [low, high] =
            all().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| [low.min(h), high.max(h)]);
        let range = (high - low).max(f64::MIN_POSITIVE);
        let (length, unit, pitch) = match pitch_um {
            Some(pitch) => (round(0.25 * columns as f64 * pitch), "µm", pitch),
            None => (round(0.25 * columns as f64).max(1.0), "cells", 1.0),
        };
        Relief {
            heights: all().map(|h| (255.0 * (h - low) / range).round() as u8).collect(),
            high: (high - low) * slope * exaggeration,
            exaggeration,
            bar_cells: length / pitch,
            bar_text: format!("{length} {unit}"),
        }
    }

    /// The factor in words, without its direction.
    pub fn times(&self) -> String {
        let times = self.exaggeration.max(1.0 / self.exaggeration);
        format!("{:.*}", if times < 10.0 { 1 } else { 0 }, times)
    }
}

/// 1, 2 or 5 times a power of ten, not above `most`.
fn round(most: f64) -> f64 {
    let decade = 10f64.powf(most.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * decade).find(|length| *length <= most).unwrap_or(decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relief_has_its_heights_and_a_round_bar() {
        // A plane of slope 2 along x over 64 cells, drawn half as high: 63 steps of 2 cells and a half.
        let field = Heightfield::new(64, 64, true, (0..64 * 64).map(|k| f64::from(k % 64)).collect());
        let relief = Relief::new(&field, [64, 32], 2.0, 0.5, Some(0.25));
        assert_eq!((relief.heights[0], relief.heights[63], relief.high), (0, 255, 63.0));
        // A quarter of 16 um is 4: 2 um are 8 cells.
        assert_eq!((relief.bar_cells, &*relief.bar_text, &*relief.times()), (8.0, "2 µm", "2.0"));
        assert_eq!([7.0, 4.9, 0.19, 1.0].map(round), [5.0, 2.0, 0.1, 1.0]);
    }
}
