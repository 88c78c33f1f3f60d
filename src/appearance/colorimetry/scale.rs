//! How a table's colours are seen: what each weighs in a luminance and in X, Y, Z.

use super::cie::{Illuminant, Observer, weights};
use crate::table::BrdfTable;

/// Wavelengths that must be there for a colour, nm, and the widest step between them (ASTM E308 goes up to 20).
const NEEDED_NM: [f64; 2] = [400.0, 700.0];
const WIDEST_STEP_NM: f64 = 20.0;
/// Where luminous efficiency is highest, nm.
const BRIGHTEST_NM: f64 = 555.0;

/// X, Y, Z of linear R, G, B with the primaries of ITU-R BT.709 under D65, Y of white 1. Source: IEC 61966-2-1, matrix of the
/// primaries in full digits.
const RGB_TO_XYZ: [[f64; 3]; 3] = [
    [0.412_390_799_265_959_5, 0.357_584_339_383_878, 0.180_480_788_401_834_3],
    [0.212_639_005_871_510_36, 0.715_168_678_767_756, 0.072_192_315_360_733_71],
    [0.019_330_818_715_591_85, 0.119_194_779_794_625_99, 0.950_532_152_249_660_7],
];

/// Weights of a table's colours in X, Y, Z of one observer under one light.
#[derive(Debug, Clone, PartialEq)]
pub struct Tristimulus {
    /// The observer.
    pub observer: Observer,
    /// The light.
    pub illuminant: Illuminant,
    /// By X, Y, Z: what a reflectance of 1 in each colour of the table adds.
    pub weights: [Vec<f64>; 3],
    /// X, Y, Z of the perfect diffuser; Y is 100.
    pub white: [f64; 3],
}

/// What a table's colours weigh.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourScale {
    /// Weights in what a glossmeter sees, which add up to 1.
    pub luminance: Vec<f64>,
    /// Observers and lights whose colours the table says, none of one channel.
    pub tristimulus: Vec<Tristimulus>,
    /// What was taken for what, a sentence.
    pub words: String,
}

impl ColourScale {
    /// The weights for a table.
    ///
    /// Wavelengths: sums over CIE's tables of 5 nm, k = 100/sum S y, the reflectance between the table's wavelengths by the cubic
    /// through the nearest four and beyond them the last (CIE 015:2018, 7.2); all three lights, both observers. R, G, B: linear,
    /// primaries of BT.709, D65 and 2 degrees alone. One channel: Y alone.
    // Tested by `lab_is_that_of_colour_science`, `rgb_is_taken_as_linear_srgb` (tests/it/appearance/colours.rs).
    pub fn of(table: &BrdfTable) -> Self {
        let nm = table.wavelengths_nm();
        match (nm.is_empty(), table.colours.len()) {
            (true, 3) => Self::of_rgb(),
            (true, _) => ColourScale {
                luminance: vec![1.0],
                tristimulus: Vec::new(),
                words: "one channel: no colour, and gloss as of a grey surface".into(),
            },
            (false, _) => Self::of_wavelengths(&nm),
        }
    }

    fn of_rgb() -> Self {
        let weights = RGB_TO_XYZ.map(|row| row.map(|weight| 100.0 * weight).to_vec());
        let white = RGB_TO_XYZ.map(|row| 100.0 * row.iter().sum::<f64>());
        ColourScale {
            luminance: RGB_TO_XYZ[1].to_vec(),
            tristimulus: vec![Tristimulus {
                observer: Observer::Two,
                illuminant: Illuminant::D65,
                weights,
                white,
            }],
            words: "R, G, B as linear with the primaries of BT.709, so D65 and 2 degrees alone: A, F11 and 10 degrees need \
                    wavelengths"
                .into(),
        }
    }

    fn of_wavelengths(nm: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..nm.len()).collect();
        order.sort_by(|&a, &b| nm[a].total_cmp(&nm[b]));
        let sorted: Vec<f64> = order.iter().map(|&k| nm[k]).collect();
        let step = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        let [first, last] = [sorted[0], sorted[sorted.len() - 1]];
        if first > NEEDED_NM[0] || last < NEEDED_NM[1] || step > WIDEST_STEP_NM {
            let off = |k: &usize| (nm[*k] - BRIGHTEST_NM).abs();
            let nearest = (0..nm.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
            let alone = |k| if k == nearest { 1.0 } else { 0.0 };
            return ColourScale {
                luminance: (0..nm.len()).map(alone).collect(),
                tristimulus: Vec::new(),
                words: format!(
                    "gloss at {} nm, and no colour: that needs wavelengths from {} to {} nm, {WIDEST_STEP_NM} apart at most",
                    nm[nearest], NEEDED_NM[0], NEEDED_NM[1]
                ),
            };
        }
        let seen = |observer, illuminant| seen(&sorted, &order, observer, illuminant);
        let pairs = Observer::ALL.iter().flat_map(|&o| Illuminant::ALL.map(|i| (o, i)));
        let y = seen(Observer::Two, Illuminant::C).weights[1].clone();
        ColourScale {
            luminance: y.iter().map(|weight| weight / 100.0).collect(),
            tristimulus: pairs.map(|(o, i)| seen(o, i)).collect(),
            words: format!(
                "{} wavelengths from {first} to {last} nm; gloss under illuminant C with V(lambda)",
                nm.len()
            ),
        }
    }
}

/// The weights of wavelengths in increasing order, which stand in the table as `order` says.
fn seen(nm: &[f64], order: &[usize], observer: Observer, illuminant: Illuminant) -> Tristimulus {
    let mut sums = [0, 1, 2].map(|_| vec![0.0; nm.len()]);
    let mut white = [0.0; 3];
    for (at, weight) in weights(observer, illuminant) {
        for c in 0..3 {
            white[c] += weight[c];
            for (k, share) in interpolation(nm, at) {
                sums[c][order[k]] += weight[c] * share;
            }
        }
    }
    let scale = 100.0 / white[1];
    sums.iter_mut().flatten().for_each(|weight| *weight *= scale);
    Tristimulus { observer, illuminant, weights: sums, white: white.map(|sum| scale * sum) }
}

/// Lagrange's polynomial through the nearest four of increasing places; beyond them the last.
fn interpolation(nm: &[f64], at: f64) -> Vec<(usize, f64)> {
    let after = nm.partition_point(|&place| place < at);
    if after == nm.len() || (after == 0 && nm[0] > at) {
        return vec![(after.min(nm.len() - 1), 1.0)];
    }
    let count = nm.len().min(4);
    let first = after.saturating_sub(2).min(nm.len() - count);
    let nodes = first..first + count;
    let share = |k: usize| {
        let others = nodes.clone().filter(|&other| other != k);
        others.map(|other| (at - nm[other]) / (nm[k] - nm[other])).product()
    };
    nodes.clone().map(|k| (k, share(k))).collect()
}
