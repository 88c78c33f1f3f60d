//! How good the values of a table are: relative standard errors of its bright bins, and how many bins are empty.

use crate::instrument::Grid;
use crate::stats;
use crate::table::{BrdfTable, ColourChannels};

/// Values beyond which their median is that of classes.
const MOST_VALUES: usize = 1 << 22;

/// What a table's error bars say.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Median relative standard error over the counted bins of all incidences and colours.
    pub median: f64,
    /// The incidence with the largest median, and that.
    pub worst: (usize, f64),
    /// Bins that count, and all of them (each colour by itself).
    pub bins: (usize, usize),
}

/// What a card says of the values, gathered in bands of incidences. Relative errors of a large table are counted in classes
/// a 4096th wide, from which their median follows to that.
pub struct Facts {
    errors: Vec<f64>,
    classes: Vec<u64>,
    worst: (usize, f64),
    counted: (usize, usize),
    /// Bins without arrivals, and all.
    pub(super) empty: (usize, usize),
    /// Pairs that were not measured.
    pub(super) gaps: usize,
    /// The colours.
    pub(super) names: String,
}

impl Facts {
    /// Of a table of all incidences of `grid`.
    pub fn new(grid: &Grid, colours: usize) -> Self {
        let all = grid.incidences() * grid.bins() * colours;
        Facts {
            errors: Vec::new(),
            classes: if all > MOST_VALUES { vec![0; 1 << CLASS_BITS] } else { vec![] },
            worst: (0, 0.0),
            counted: (0, all),
            empty: (0, 0),
            gaps: 0,
            names: String::new(),
        }
    }

    /// Of a whole table.
    pub fn of(table: &BrdfTable) -> Self {
        let mut facts = Facts::new(&table.grid, table.colours.len());
        facts.add(table, 0);
        facts
    }

    /// Takes the next incidences.
    pub fn add(&mut self, band: &BrdfTable, first_incidence: usize) {
        let gaps = band.gaps();
        self.empty.0 += band.hits.iter().filter(|&&hits| hits == 0).count() - gaps;
        self.empty.1 += band.hits.len() - gaps;
        self.gaps += gaps;
        self.names = band.colour_names().join(" ");
        for incidence in 0..band.grid.incidences() {
            let mut errors = bright_errors(band, incidence);
            if let Some(median) = stats::upper_median(&mut errors).filter(|&median| median > self.worst.1) {
                self.worst = (first_incidence + incidence, median);
            }
            self.counted.0 += errors.len();
            if self.classes.is_empty() {
                self.errors.append(&mut errors);
            } else {
                errors.iter().for_each(|&error| self.classes[class_of(error)] += 1);
            }
        }
    }

    /// What the error bars say; `None` where the table has none, or no light.
    // Tested by `quality_is_the_median_error_of_the_bright_bins`.
    pub fn quality(&mut self) -> Option<Quality> {
        let median = if self.classes.is_empty() {
            stats::upper_median(&mut self.errors)
        } else {
            let mut below = 0;
            let middle = self.classes.iter().position(|&count| {
                below += count;
                below > self.counted.0 as u64 / 2
            });
            middle.map(value_of)
        };
        median.map(|median| Quality { median, worst: self.worst, bins: self.counted })
    }
}

/// Relative errors of the counted bins of an incidence, all colours.
fn bright_errors(band: &BrdfTable, incidence: usize) -> Vec<f64> {
    let here = incidence * band.grid.bins()..(incidence + 1) * band.grid.bins();
    let of_colour = |colour: &ColourChannels| {
        let (values, errors) = (&colour.total[here.clone()], &colour.stderr[here.clone()]);
        let least =
            stats::COUNTED_ABOVE * f64::from(values.iter().fold(0.0f32, |peak, &value| peak.max(value)));
        let both = values.iter().zip(errors).map(|(&value, &se)| (f64::from(value), f64::from(se)));
        both.filter(|&(value, se)| value > least && se >= 0.0)
            .map(|(value, se)| se / value)
            .collect::<Vec<_>>()
    };
    band.colours.iter().flat_map(of_colour).collect()
}

/// Exponent and first bits of an f32, which order positive numbers: 8 and 12 bits.
const CLASS_BITS: u32 = 20;

fn class_of(error: f64) -> usize {
    ((error as f32).to_bits() >> (31 - CLASS_BITS)) as usize
}

/// The middle of a class.
fn value_of(class: usize) -> f64 {
    let bits = (class as u32) << (31 - CLASS_BITS) | 1 << (30 - CLASS_BITS);
    f64::from(f32::from_bits(bits))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::instrument::grid::GridKind;

    /// Two incidences of 3 x 4 bins, one colour.
    pub(crate) fn dim_table() -> BrdfTable {
        let grid = Grid {
            kind: GridKind::Hemisphere,
            theta_i_deg: vec![0.0, 40.0],
            phi_i_deg: vec![0.0],
            phi_r_relative: true,
            theta_r_edges_deg: vec![0.0, 30.0, 60.0, 90.0],
            phi_r_edges_deg: vec![0.0, 90.0, 180.0, 270.0, 360.0],
            ..Grid::default()
        };
        let colour = ColourChannels {
            total: vec![0.001; 24],
            single: vec![0.001; 24],
            multiple: vec![0.0; 24],
            stderr: vec![1.0; 24],
            stderr_single: vec![1.0; 24],
            ..ColourChannels::default()
        };
        BrdfTable {
            grid,
            campaign: "name = \"dim\"\n".into(),
            version: "0.1.0".into(),
            seed: 7,
            patch_digest: "ab".into(),
            colours: vec![colour],
            hits: vec![0; 24],
            schlick: None,
        }
    }

    #[test]
    fn classes_of_errors_keep_their_order_and_a_4096th() {
        let mut before = 0;
        for k in 0..60_000 {
            let error = 1e-9 * 1.0005f64.powi(k);
            let class = class_of(error);
            // Half of a 4096th, and the rounding to f32.
            assert!(
                class >= before && (value_of(class) / error - 1.0).abs() < 1.0 / 8192.0 + 1e-7,
                "{error}"
            );
            before = class;
        }
    }

    #[test]
    fn quality_is_the_median_error_of_the_bright_bins() {
        let mut table = dim_table();
        for incidence in 0..2 {
            // Three bright bins: the others lie below 1 % of the peak.
            for (k, se) in [0.01, 0.02, 0.05].into_iter().enumerate() {
                table.colours[0].total[incidence * 12 + k] = 1.0;
                table.colours[0].stderr[incidence * 12 + k] = se * (1 + incidence) as f32;
            }
        }
        let found = Facts::of(&table).quality().expect("error bars");
        assert_eq!((found.bins, found.worst.0), ((6, 24), 1));
        // 1, 2, 2, 4, 5 and 10 %: the upper median of six is the fourth; errors are f32.
        assert!((found.median - 0.04).abs() < 1e-8 && (found.worst.1 - 0.04).abs() < 1e-8, "{found:?}");
        table.colours[0].stderr.fill(-1.0);
        assert_eq!(Facts::of(&table).quality(), None);
    }
}
