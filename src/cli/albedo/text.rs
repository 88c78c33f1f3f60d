//! What `gonio albedo` prints of a table, at most 100 wide: some rows and columns of a large one.

use crate::albedo::{AlbedoTable, Certificate, Quantity};
use crate::cli::text::layout::{columns, wrapped};

/// Columns of mu, rows of alpha, and etas that are shown.
const SHOWN: [usize; 3] = [7, 6, 3];

/// The main quantities, how large the errors are, and what is certified.
pub fn lines(table: &AlbedoTable, certificate: Option<&Certificate>) -> Vec<String> {
    let mut lines = wrapped("", &table.title);
    // Orders by themselves and formulas are in the files and in the verdict.
    for quantity in table.quantities.iter().filter(|quantity| !quantity.name.contains("_order")) {
        lines.push(String::new());
        lines.extend(wrapped(&format!("{}: ", quantity.name), &quantity.about));
        lines.extend(shown(table, quantity));
    }
    lines.push(String::new());
    let all = || table.quantities.iter().flat_map(|quantity| quantity.cells.iter().chain(&quantity.averages));
    let largest = all().map(|cell| cell.error).try_fold(0.0f64, |largest, error| Some(largest.max(error?)));
    let largest = largest.map_or("n/a".into(), |largest| format!("up to {largest:.1e}"));
    lines.extend(wrapped("errors: ", &format!("{largest}; {}", table.errors)));
    lines.extend(
        certificate.iter().flat_map(|certificate| certificate.lines()).flat_map(|line| wrapped("", &line)),
    );
    lines
}

/// Some cells of a quantity.
fn shown(table: &AlbedoTable, quantity: &Quantity) -> Vec<String> {
    let axes = &table.axes;
    let (mus, alphas) = (axes.mu.len(), axes.alpha.len());
    let mu = some(mus, SHOWN[0]);
    let mut headings: Vec<String> = axes.eta.first().map(|_| "eta".into()).into_iter().collect();
    headings.push("alpha".into());
    headings.extend(mu.iter().map(|&k| format!("mu {}", short(axes.mu[k]))));
    headings.push("average".into());
    let row = |slab: usize, alpha: usize| {
        let at = slab * alphas + alpha;
        let eta = axes.eta.get(slab).map(|&eta| short(eta));
        let values = mu.iter().map(|&k| &quantity.cells[at * mus + k]).chain([&quantity.averages[at]]);
        // What rounds to 0 has no sign.
        let values = values.map(|cell| format!("{:.5}", cell.value).replace("-0.00000", "0.00000"));
        eta.into_iter().chain([short(axes.alpha[alpha])]).chain(values).collect::<Vec<String>>()
    };
    let slabs = some(axes.slabs(), SHOWN[2]);
    let rows: Vec<Vec<String>> = slabs
        .into_iter()
        .flat_map(|slab| some(alphas, SHOWN[1]).into_iter().map(move |alpha| (slab, alpha)))
        .map(|(slab, alpha)| row(slab, alpha))
        .collect();
    columns(&headings.iter().map(String::as_str).collect::<Vec<_>>(), &rows)
}

/// At most so many of `count` indices, evenly spread, the ends among them.
fn some(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|k| k * (count - 1) / (most - 1)).collect()
}

/// A node in few digits.
fn short(node: f64) -> String {
    let text = format!("{node:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}
