//! The provenance card of a table: what it is, what made it, how good it is, and what it is not. Markdown, to be kept
//! beside the table wherever it goes.

use serde_json::Value;

use super::markdown::{code, fence, listing, plain};
use crate::error::Result;
use crate::instrument::Grid;
use crate::table::{BrdfTable, store};
use crate::validate::judgement::LAWS;

/// Bins below this share of their stop's peak do not count for the quality, as in `stop.relative_error`.
const COUNTED_ABOVE: f64 = 0.01;

/// What a table's error bars say.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Median relative standard error over the counted bins of all stops and colours.
    pub median: f64,
    /// The stop with the largest median, and that.
    pub worst: (usize, f64),
    /// Bins that count, and all of them (each colour by itself).
    pub bins: (usize, usize),
}

/// The quality of a table; `None` where it has no error bars, or no light.
///
/// Held by: `quality_is_the_median_error_of_the_bright_bins`.
pub fn quality(table: &BrdfTable) -> Option<Quality> {
    let mut errors = Errors::new(&table.grid, table.colours.len());
    errors.add(table, 0);
    errors.quality()
}

/// Values beyond which their median is that of classes.
const MOST_VALUES: usize = 1 << 22;

/// Relative errors of the counted bins, stop by stop. Of a large table they are counted in classes a 4096th wide, from
/// which the median follows to that.
struct Errors {
    values: Vec<f64>,
    classes: Vec<u64>,
    worst: (usize, f64),
    bins: (usize, usize),
}

impl Errors {
    fn new(grid: &Grid, colours: usize) -> Self {
        let all = grid.stops() * grid.bins() * colours;
        let classes = if all > MOST_VALUES { vec![0; 1 << CLASS_BITS] } else { vec![] };
        Errors { values: Vec::new(), classes, worst: (0, 0.0), bins: (0, all) }
    }

    fn add(&mut self, band: &BrdfTable, first_stop: usize) {
        let bins = band.grid.bins();
        for stop in 0..band.grid.stops() {
            let mut here = Vec::new();
            for colour in &band.colours {
                let values = &colour.total[stop * bins..][..bins];
                let peak = values.iter().fold(0.0f32, |peak, &value| peak.max(value));
                for (k, &value) in values.iter().enumerate() {
                    let (value, se) = (f64::from(value), f64::from(colour.stderr[stop * bins + k]));
                    if value > COUNTED_ABOVE * f64::from(peak) && se >= 0.0 {
                        here.push(se / value);
                    }
                }
            }
            if let Some(median) = upper_median(&mut here).filter(|&median| median > self.worst.1) {
                self.worst = (first_stop + stop, median);
            }
            self.bins.0 += here.len();
            if self.classes.is_empty() {
                self.values.append(&mut here);
            } else {
                here.iter().for_each(|&error| self.classes[class_of(error)] += 1);
            }
        }
    }

    fn quality(mut self) -> Option<Quality> {
        let median = if self.classes.is_empty() {
            upper_median(&mut self.values)
        } else {
            let mut below = 0;
            let middle = self.classes.iter().position(|&count| {
                below += count;
                below > self.bins.0 as u64 / 2
            });
            middle.map(value_of)
        };
        median.map(|median| Quality { median, worst: self.worst, bins: self.bins })
    }
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

fn upper_median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// By this a card is told as one of ours.
pub const MARK: &str = "<!-- gonio: provenance card -->";

/// What a card says of the values, gathered in bands of stops.
pub struct Facts {
    errors: Errors,
    /// Bins without arrivals, and all.
    empty: (usize, usize),
    /// Pairs that were not measured.
    gaps: usize,
    names: String,
}

impl Facts {
    /// Of a table of all stops of `grid`.
    pub fn new(grid: &Grid, colours: usize) -> Self {
        Facts { errors: Errors::new(grid, colours), empty: (0, 0), gaps: 0, names: String::new() }
    }

    /// Takes the next stops.
    pub fn add(&mut self, band: &BrdfTable, first_stop: usize) {
        self.errors.add(band, first_stop);
        let gaps = band.gaps();
        self.empty.0 += band.hits.iter().filter(|&&hits| hits == 0).count() - gaps;
        self.empty.1 += band.hits.len() - gaps;
        self.gaps += gaps;
        self.names = band.colour_names().join(" ");
    }
}

/// The card of a table; `summary` is its summary document, of which null fields are left out. Errors: those of
/// encoding the table for its digest.
pub fn card(table: &BrdfTable, summary: &Value) -> Result<String> {
    let mut facts = Facts::new(&table.grid, table.colours.len());
    facts.add(table, 0);
    Ok(card_of(table, &store::digest(table)?, facts, summary))
}

/// The card of a table from its heading, its digest, and what was gathered of its values.
pub fn card_of(heading: &BrdfTable, digest: &str, facts: Facts, summary: &Value) -> String {
    let name = plain(summary["name"].as_str().unwrap_or("table"));
    let mut lines = vec![MARK.into(), format!("# {name}: a measured BRDF table"), String::new()];
    lines.extend(["| | |".into(), "|---|---|".into()]);
    let (names, empty, gaps) = (facts.names.clone(), facts.empty, facts.gaps);
    let quality = facts.errors.quality();
    let rows =
        [said_of(heading, digest, &names), summarised(summary), goodness(heading, quality, summary)].concat();
    lines.extend(rows.iter().map(|(what, text)| format!("| {what} | {text} |")));
    lines.extend([String::new(), "## What it is not".into(), String::new()]);
    lines.extend(limits(empty, gaps, summary).iter().map(|limit| format!("- {limit}")));
    lines.extend([String::new(), "## How it was made".into(), String::new()]);
    lines.push("`gonio measure` of this campaign gives the same bytes with the same version:".into());
    let campaign = heading.campaign.trim_end();
    let fence = fence(campaign);
    lines.extend([String::new(), format!("{fence}toml"), listing(campaign), fence]);
    lines.join("\n") + "\n"
}

type CardRow = (&'static str, String);

fn said_of(table: &BrdfTable, digest: &str, colours: &str) -> Vec<CardRow> {
    let (stops, bins) = (table.grid.stops(), table.grid.bins());
    let mut rows = vec![
        ("what", "BRDF without cosine, 1/sr, mean over each bin, with standard errors and hits".into()),
        ("size", format!("{stops} positions of the light x {bins} bins, channels {colours}")),
        ("convention", store::CONVENTION_TEXT.into()),
        ("program", format!("gonio {}", plain(&table.version))),
        ("seed", table.seed.to_string()),
        ("table SHA-256", format!("{} (attribute `gonio.digest`)", code(digest))),
    ];
    if !table.patch_digest.is_empty() {
        rows.push(("patches SHA-256", code(&table.patch_digest)));
    }
    rows
}

/// What only the summary knows: samples, cost.
fn summarised(summary: &Value) -> Vec<CardRow> {
    let mut rows = Vec::new();
    let plan = &summary["plan"];
    if let (Some(samples), Some(realisations)) = (plan["samples"].as_u64(), plan["realisations"].as_u64()) {
        let by = plain(summary["stopped_by"].as_str().unwrap_or("samples"));
        let most = if by == "samples" { "" } else { "at most " };
        rows.push((
            "samples",
            format!("{most}{samples} starts at each position of the light on each of {realisations} realisations (ended by {by})"),
        ));
    }
    let cost = &summary["cost"];
    if let (Some(wall), Some(cpu), Some(threads)) =
        (cost["wall_s"].as_f64(), cost["cpu_s"].as_f64(), cost["threads"].as_u64())
    {
        rows.push(("time", format!("{wall:.0} s on {threads} threads, {cpu:.0} s of processor time")));
    }
    rows
}

fn goodness(table: &BrdfTable, quality: Option<Quality>, summary: &Value) -> Vec<CardRow> {
    let mut rows = Vec::new();
    if let Some(Quality { median, worst: (stop, worst), bins: (counted, all) }) = quality {
        rows.push((
            "quality",
            format!(
                "median relative standard error {:.2} % over the {counted} of {all} values above 1 % of their \
                 peak; worst position {:.2} % ({})",
                100.0 * median,
                100.0 * worst,
                position(table, stop)
            ),
        ));
    }
    if let Some(albedo) = summary["energy"]["largest_albedo"].as_f64() {
        rows.push(("largest albedo", format!("{albedo:.5}")));
    }
    rows.extend(summary["verdict"].as_str().map(|verdict| ("verdict", plain(verdict))));
    for judgement in summary["judgements"].as_array().into_iter().flatten() {
        let [law, words, reason] = ["law", "verdict", "reason"].map(|key| judgement[key].as_str());
        let words = words.zip(reason).map(|(words, reason)| plain(&format!("{words}: {reason}")));
        rows.extend(LAWS.iter().find(|name| Some(**name) == law).copied().zip(words));
    }
    rows
}

fn position(table: &BrdfTable, stop: usize) -> String {
    let (theta, phi) = table.grid.stop_deg(stop);
    format!("theta_i {theta}, phi_i {phi}")
}

fn limits((empty, all): (usize, usize), gaps: usize, summary: &Value) -> Vec<String> {
    let mut limits = vec![
        "Geometric optics: facets are flat mirrors, without diffraction or interference.".into(),
        "Values are means over bins, not values at their centres; compare them with means.".into(),
        "Error bars come from the spread of independent realisations; they do not hold what the surface's grid does \
         to the steepest slopes (docs/physics.md, limits of validity)."
            .into(),
        format!("{empty} of {all} bins had no arrival: value 0, error the BRDF of 1.5 arrivals."),
    ];
    if gaps > 0 {
        limits.push(format!("{gaps} pairs of directions were not measured: value 0, error -2."));
    }
    if summary["surface"].is_object() {
        let why =
            "The surface is a heightfield of its own: D F G2/(4 |n.l||n.v|) is near it, not equal to it";
        let mean = summary["comparisons"].as_array().into_iter().flatten().find_map(|comparison| {
            let nearest = comparison["masking"] == summary["nearest_masking"];
            comparison["l1_model"].as_f64().filter(|_| nearest)
        });
        limits.push(match mean {
            Some(l1) => format!("{why} (L1 {l1:.4} with the nearest masking)."),
            None => format!("{why}."),
        });
    }
    limits
}

#[cfg(test)]
mod tests {
    use super::*;

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
    use crate::instrument::Grid;
    use crate::instrument::grid::GridKind;
    use crate::table::ColourChannels;

    /// Two stops of 3 x 4 bins, one colour.
    fn dim_table() -> BrdfTable {
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
    fn quality_is_the_median_error_of_the_bright_bins() {
        let mut table = dim_table();
        for stop in 0..2 {
            // Three bright bins: the others lie below 1 % of the peak.
            for (k, se) in [0.01, 0.02, 0.05].into_iter().enumerate() {
                table.colours[0].total[stop * 12 + k] = 1.0;
                table.colours[0].stderr[stop * 12 + k] = se * (1 + stop) as f32;
            }
        }
        let found = quality(&table).expect("error bars");
        assert_eq!((found.bins, found.worst.0), ((6, 24), 1));
        // 1, 2, 2, 4, 5 and 10 %: the upper median of six is the fourth; errors are f32.
        assert!((found.median - 0.04).abs() < 1e-8 && (found.worst.1 - 0.04).abs() < 1e-8, "{found:?}");
        table.colours[0].stderr.fill(-1.0);
        assert_eq!(quality(&table), None);
    }

    #[test]
    fn a_card_of_a_table_alone_leaves_out_what_only_a_summary_knows() {
        let table = dim_table();
        let text = card(&table, &Value::Null).expect("a card");
        for wanted in
            ["2 positions of the light x 12 bins", "| seed | 7 |", "name = \"dim\"", "24 of 24 bins"]
        {
            assert!(text.contains(wanted), "{wanted}: {text}");
        }
        let digest = store::digest(&table).expect("a digest");
        assert!(text.contains(&digest) && !text.contains("time") && !text.contains("null"), "{text}");
    }
}
