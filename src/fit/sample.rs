//! Which values a fit looks at, and how many others each stands for.
//!
//! A first pass that ranks models needs a few thousand values, not a few hundred thousand. Half of them are drawn in
//! proportion to their flux, half to their size: values that would come up more than once are taken as they are, of the
//! others one at every step of the running sum. What each stands for, 1 over the chance to be drawn, keeps the
//! divergence of every model without bias.

use super::data::FitData;

/// Incidences of a sample at most: nodes have to be laid out for each.
const MOST_INCIDENCES: usize = 64;

/// Entries of a table, incidence by incidence.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSample {
    /// incidence * bins + bin, increasing.
    pub entries: Vec<usize>,
    /// How many entries each stands for, >= 1.
    pub shares: Vec<f64>,
    /// Whether these are all of the table.
    pub is_whole: bool,
}

impl FitSample {
    /// All entries.
    pub fn whole(data: &FitData) -> FitSample {
        let count = data.size.len();
        FitSample { entries: (0..count).collect(), shares: vec![1.0; count], is_whole: true }
    }

    /// About `wanted` entries; all where there are no more.
    pub fn drawn(data: &FitData, wanted: usize) -> FitSample {
        let (bins, incidences) = (data.grid.bins(), data.grid.incidences());
        if data.size.len() <= wanted {
            return FitSample::whole(data);
        }
        let looked_at = incidences.min(MOST_INCIDENCES);
        let entries = (0..looked_at).flat_map(|k| {
            let incidence = k * incidences / looked_at;
            incidence * bins..(incidence + 1) * bins
        });
        let chances: Vec<(usize, f64)> = entries.map(|entry| (entry, chance(data, entry))).collect();
        let whole: f64 = chances.iter().map(|(_, chance)| chance).sum();
        let of_incidences = incidences as f64 / looked_at as f64;
        let (mut drawn, mut sum) = (FitSample { entries: vec![], shares: vec![], is_whole: false }, 0.5);
        for (entry, chance) in chances {
            let expected = wanted as f64 * chance / whole;
            if expected < 1.0 {
                sum += expected;
                if sum < 1.0 {
                    continue;
                }
                sum -= 1.0;
            }
            drawn.entries.push(entry);
            drawn.shares.push(of_incidences / expected.min(1.0));
        }
        drawn
    }
}

/// Half the entry's share of the flux of all colours, and half that of its size, in units of a whole table.
fn chance(data: &FitData, entry: usize) -> f64 {
    // The floor is a fixed share of each colour's mean.
    let bright = data.value.iter().zip(&data.floor).map(|(values, floor)| values[entry].abs() / floor);
    let mean = bright.sum::<f64>() * super::data::FLOOR / data.value.len() as f64;
    data.size[entry] * (mean + 1.0)
}
