//! The provenance card of a table: what it is, what made it, how good it is, and what it is not. Markdown, to be kept
//! beside the table wherever it goes.

use serde_json::Value;

use crate::error::Result;
use crate::table::{BrdfTable, store};

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
    let bins = table.grid.bins();
    let (mut all, mut worst) = (Vec::new(), (0, 0.0));
    for stop in 0..table.grid.stops() {
        let mut here = Vec::new();
        for colour in &table.colours {
            let values = &colour.total[stop * bins..][..bins];
            let peak = values.iter().fold(0.0f32, |peak, &value| peak.max(value));
            for (k, &value) in values.iter().enumerate() {
                let (value, se) = (f64::from(value), f64::from(colour.stderr[stop * bins + k]));
                if value > COUNTED_ABOVE * f64::from(peak) && se >= 0.0 {
                    here.push(se / value);
                }
            }
        }
        if let Some(median) = upper_median(&mut here).filter(|&median| median > worst.1) {
            worst = (stop, median);
        }
        all.append(&mut here);
    }
    let bins = (all.len(), table.grid.stops() * bins * table.colours.len());
    upper_median(&mut all).map(|median| Quality { median, worst, bins })
}

fn upper_median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The card of a table; `summary` is its summary document, of which null fields are left out. Errors: those of
/// encoding the table for its digest.
pub fn card(table: &BrdfTable, summary: &Value) -> Result<String> {
    let name = summary["name"].as_str().unwrap_or("table");
    let mut lines = vec![format!("# {name}: a measured BRDF table"), String::new()];
    lines.extend(["| | |".into(), "|---|---|".into()]);
    let rows = [facts(table)?, summarised(summary), goodness(table, summary)].concat();
    lines.extend(rows.iter().map(|(what, text)| format!("| {what} | {text} |")));
    lines.extend([String::new(), "## What it is not".into(), String::new()]);
    lines.extend(limits(table, summary).iter().map(|limit| format!("- {limit}")));
    lines.extend([String::new(), "## How it was made".into(), String::new()]);
    lines.push("`gonio measure` of this campaign gives the same bytes with the same version:".into());
    lines.extend([String::new(), "```toml".into(), table.campaign.trim_end().into(), "```".into()]);
    Ok(lines.join("\n") + "\n")
}

type Row = (&'static str, String);

fn facts(table: &BrdfTable) -> Result<Vec<Row>> {
    let (stops, bins) = (table.grid.stops(), table.grid.bins());
    let colours = table.colour_names().join(" ");
    let mut rows = vec![
        ("what", "BRDF without cosine, 1/sr, mean over each bin, with standard errors and hits".into()),
        ("size", format!("{stops} positions of the light x {bins} bins, channels {colours}")),
        ("convention", store::CONVENTION_TEXT.into()),
        ("program", format!("gonio {}", table.version)),
        ("seed", table.seed.to_string()),
        ("table SHA-256", format!("`{}` (attribute `gonio.digest`)", store::digest(table)?)),
    ];
    if !table.patch_digest.is_empty() {
        rows.push(("patches SHA-256", format!("`{}`", table.patch_digest)));
    }
    Ok(rows)
}

/// What only the summary knows: samples, cost.
fn summarised(summary: &Value) -> Vec<Row> {
    let mut rows = Vec::new();
    let plan = &summary["plan"];
    if let (Some(samples), Some(realisations)) = (plan["samples"].as_u64(), plan["realisations"].as_u64()) {
        let by = summary["stopped_by"].as_str().unwrap_or("samples");
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

fn goodness(table: &BrdfTable, summary: &Value) -> Vec<Row> {
    let mut rows = Vec::new();
    if let Some(Quality { median, worst: (stop, worst), bins: (counted, all) }) = quality(table) {
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
    if let Some(ok) = summary["ok"].as_bool() {
        let failures = summary["failures"].as_array().map_or(0, Vec::len);
        let text = if ok { "all held".into() } else { format!("{failures} not held: see the summary") };
        rows.push(("laws and expectations", text));
    }
    rows
}

fn position(table: &BrdfTable, stop: usize) -> String {
    let (theta, phi) = table.grid.stop_deg(stop);
    format!("theta_i {theta}, phi_i {phi}")
}

fn limits(table: &BrdfTable, summary: &Value) -> Vec<String> {
    let empty = table.hits.iter().filter(|&&hits| hits == 0).count();
    let mut limits = vec![
        "Geometric optics: facets are flat mirrors, without diffraction or interference.".into(),
        "Values are means over bins, not values at their centres; compare them with means.".into(),
        "Error bars come from the spread of independent realisations; they do not hold what the surface's grid does \
         to the steepest slopes (README, limits of validity)."
            .into(),
        format!("{empty} of {} bins had no arrival: value 0, error the BRDF of 1.5 arrivals.", table.hits.len()),
    ];
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
