//! The ladders of a bench as text.

use crate::bench::{Bench, ERROR_MEASURE, MeasuredRung, Varies};
use crate::cli::text::layout::columns;
use crate::cli::text::numbers::{duration, grouped};

/// A table of rungs and the fit for each ladder, and the time of all.
pub fn lines(bench: &Bench, replicates: u32) -> Vec<String> {
    let mut lines = vec![
        format!("error: {ERROR_MEASURE}, against {}", bench.truth.name),
        format!(
            "rows: {replicates} runs each (root mean square), factor 4; fit: err^2 = a/N + b^2, 95 % intervals"
        ),
    ];
    for ladder in &bench.ladders {
        lines.push(String::new());
        lines.push(match ladder.varies {
            Varies::Samples => "more samples in the same number of realisations".into(),
            Varies::Realisations => "more realisations of the same number of samples".into(),
        });
        const HEADINGS: [&str; 6] = ["samples", "realisations", "seconds", "Mrays/s", "error", "1/(err^2 s)"];
        lines.extend(columns(&HEADINGS, &ladder.rows.iter().map(cells).collect::<Vec<_>>()));
        // Fewer starts on heights are an uneven choice of facets: the last row says what is left of that.
        if let Some(most) = ladder.rows.last().and_then(|row| row.closure) {
            lines.push(format!(
                "orders + cut: within {most:.1e} of 1 in the last row (every incidence and run)"
            ));
        }
        lines.push(match &ladder.fit {
            None => "no fit: an error is 0".into(),
            Some(f) => format!(
                "a = {:.3} [{:.3}, {:.3}]  b = {:.2e} [{:.2e}, {:.2e}]  slope {:.4} +- {:.4}",
                f.a, f.a_low, f.a_high, f.b, f.b_low, f.b_high, f.slope, f.slope_se
            ),
        });
    }
    lines.push(String::new());
    let rows = bench.ladders.iter().flat_map(|ladder| &ladder.rows);
    let measured: f64 = rows.map(|row| row.seconds * f64::from(replicates)).sum();
    lines.push(format!("time          {} in the rungs", duration(measured)));
    lines
}

fn cells(row: &MeasuredRung) -> Vec<String> {
    vec![
        grouped(row.samples),
        row.realisations.to_string(),
        format!("{:.3}", row.seconds),
        format!("{:.3}", row.rays_per_s / 1e6),
        format!("{:.3e}", row.error),
        format!("{:.3e}", row.efficiency.unwrap_or(f64::INFINITY)),
    ]
}
