//! The provenance card of a table: what it is, what made it, how good it is, and what it is not. Markdown, to be kept
//! next to the table wherever it goes.

use super::markdown::{code, fence, listing, plain};
use super::quality::{Facts, Quality};
use super::summary::{PlannedSamples, Summary};
use crate::measure::{Cost, StoppedBy};
use crate::table::{BrdfTable, header};
use crate::validate::Judgement;

/// By this a card is recognised as one of ours.
pub const MARK: &str = "<!-- gonio: provenance card -->";

/// The card of a table from its header, its digest, what was gathered of its values, and its summary.
pub fn card(header: &BrdfTable, digest: &str, mut facts: Facts, summary: &Summary) -> String {
    let mut lines =
        vec![MARK.into(), format!("# {}: a measured BRDF table", plain(&summary.name)), String::new()];
    lines.extend(["| | |".into(), "|---|---|".into()]);
    let quality = facts.quality();
    let rows = [identity(header, digest, &facts.names), effort(summary), goodness(header, quality, summary)];
    lines.extend(rows.concat().iter().map(|(what, text)| format!("| {what} | {text} |")));
    lines.extend([String::new(), "## What it is not".into(), String::new()]);
    lines.extend(limits(&facts, summary).iter().map(|limit| format!("- {limit}")));
    lines.extend([String::new(), "## How it was made".into(), String::new()]);
    lines.push("`gonio measure` of this campaign gives the same bytes with the same version:".into());
    let campaign = header.campaign.trim_end();
    let fence = fence(campaign);
    lines.extend([String::new(), format!("{fence}toml"), listing(campaign), fence]);
    lines.join("\n") + "\n"
}

type CardRow = (String, String);

fn row(what: &str, text: String) -> CardRow {
    (what.into(), text)
}

fn identity(table: &BrdfTable, digest: &str, colours: &str) -> Vec<CardRow> {
    let (incidences, bins) = (table.grid.incidences(), table.grid.bins());
    let mut rows = vec![
        row("what", "BRDF without cosine, 1/sr, mean over each bin, with standard errors and hits".into()),
        row("size", format!("{incidences} positions of the light x {bins} bins, channels {colours}")),
        row("convention", header::convention(&table.grid)),
        row("program", format!("gonio {}", plain(&table.version))),
        row("seed", table.seed.to_string()),
        row("table SHA-256", format!("{} (attribute `gonio.digest`)", code(digest))),
    ];
    if !table.patch_digest.is_empty() {
        rows.push(row("patches SHA-256", code(&table.patch_digest)));
    }
    rows
}

/// Samples and cost, which only the summary knows.
fn effort(summary: &Summary) -> Vec<CardRow> {
    let samples = summary.planned().map(|PlannedSamples { samples, realisations }| {
        let by = summary.stopped_by.unwrap_or(StoppedBy::Samples);
        let most = if by == StoppedBy::Samples { "" } else { "at most " };
        row(
            "samples",
            format!(
                "{most}{samples} surface samples at each position of the light on each of {realisations} realisations \
                 (ended by {by})"
            ),
        )
    });
    let time = summary.cost.as_ref().map(|Cost { wall_s, cpu_s, threads, .. }| {
        row("time", format!("{wall_s:.0} s on {threads} threads, {cpu_s:.0} s of processor time"))
    });
    samples.into_iter().chain(time).collect()
}

fn goodness(table: &BrdfTable, quality: Option<Quality>, summary: &Summary) -> Vec<CardRow> {
    let mut rows = Vec::new();
    if let Some(Quality { median, worst: (incidence, worst), bins: (counted, all) }) = quality {
        let (theta, phi) = table.grid.incidence_deg(incidence);
        rows.push(row(
            "quality",
            format!(
                "median relative standard error {:.2} % over the {counted} of {all} values above 1 % of their \
                 peak; worst position {:.2} % (theta_i {theta}, phi_i {phi})",
                100.0 * median,
                100.0 * worst
            ),
        ));
    }
    let albedo = summary.energy.as_ref().and_then(|energy| energy.largest_albedo);
    rows.extend(albedo.map(|albedo| row("largest albedo", format!("{albedo:.5}"))));
    rows.extend(summary.verdict.as_ref().map(|verdict| row("verdict", plain(verdict))));
    let law = |judgement: &Judgement| {
        row(&plain(&judgement.law), plain(&format!("{}: {}", judgement.ruling, judgement.reason)))
    };
    rows.extend(summary.judgements.iter().map(law));
    rows
}

fn limits(facts: &Facts, summary: &Summary) -> Vec<String> {
    let mut limits = vec![
        "Geometric optics: facets are flat, without diffraction or interference.".into(),
        "Values are means over bins, not values at their centres; compare them with means.".into(),
        "Error bars come from the spread of independent realisations; they do not hold what the surface's grid does \
         to the steepest slopes (docs/physics.md, limits of validity)."
            .into(),
        format!(
            "{} of {} bins had no arrival: value 0, error the BRDF of 1.5 arrivals.",
            facts.empty.0, facts.empty.1
        ),
    ];
    if facts.gaps > 0 {
        limits.push(format!("{} pairs of directions were not measured: value 0, error -2.", facts.gaps));
    }
    if summary.surface.is_some() {
        let why =
            "The surface is a heightfield of its own: D F G2/(4 |n.l||n.v|) is near it, not equal to it";
        limits.push(match summary.nearest().and_then(|comparison| comparison.figures.l1_model) {
            Some(l1) => format!("{why} (L1 {l1:.4} with the nearest masking)."),
            None => format!("{why}."),
        });
    }
    limits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::quality::tests::dim_table;
    use crate::table::store;

    #[test]
    fn a_card_of_a_table_alone_leaves_out_what_only_a_summary_knows() {
        let table = dim_table();
        let digest = store::digest(&table).expect("a digest");
        let summary = Summary::of_table("dim", &table, None, None, vec![]).expect("a summary");
        let text = card(&table, &digest, Facts::of(&table), &summary);
        for wanted in
            ["2 positions of the light x 12 bins", "| seed | 7 |", "name = \"dim\"", "24 of 24 bins"]
        {
            assert!(text.contains(wanted), "{wanted}: {text}");
        }
        assert!(text.contains(&digest) && !text.contains("time") && !text.contains("null"), "{text}");
    }
}
