//! Parts of a sum as bars, the largest first.

use super::drawing::{csv_field, escaped, metadata, picture};

/// Bars that are drawn; the numbers behind the chart are all.
const MOST_BARS: usize = 10;
/// Width of the names, of the bars, and of the numbers beside them; height of a bar, and what stands above them.
const NAMES: f64 = 150.0;
const BARS: f64 = 240.0;
const NUMBERS: f64 = 70.0;
const BAR: f64 = 22.0;
const ABOVE: f64 = 34.0;

/// A chart of named parts, in their order; negative ones are drawn faint.
pub fn shares(title: &str, parts: &[(&str, f64)]) -> String {
    let shown = &parts[..parts.len().min(MOST_BARS)];
    let largest = shown.iter().map(|(_, share)| share.abs()).fold(f64::MIN_POSITIVE, f64::max);
    let size = [NAMES + BARS + NUMBERS, ABOVE + BAR * shown.len() as f64 + 8.0];
    let bar = |(k, (name, share)): (usize, &(&str, f64))| {
        let (y, width) = (ABOVE + BAR * k as f64, BARS * share.abs() / largest);
        let opacity = if *share < 0.0 { 0.35 } else { 1.0 };
        format!(
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><rect x=\"{NAMES}\" y=\"{:.1}\" width=\"{width:.1}\" \
             height=\"{:.1}\" fill=\"currentColor\" fill-opacity=\"{opacity}\"/><text x=\"{:.1}\" y=\"{:.1}\">{:.1} %</text>",
            NAMES - 8.0,
            y + 14.0,
            escaped(name),
            y + 3.0,
            BAR - 6.0,
            NAMES + width + 6.0,
            y + 14.0,
            100.0 * share
        )
    };
    let drawn: String = shown.iter().enumerate().map(bar).collect();
    let rows = parts.iter().map(|(name, share)| format!("{},{share}", csv_field(name)));
    let lines: Vec<String> = std::iter::once("component,share".into()).chain(rows).collect();
    picture(title, size, &(metadata(&lines) + &drawn))
}
