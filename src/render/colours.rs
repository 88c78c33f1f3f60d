//! Which colours of a table a picture shows.

use crate::table::BrdfTable;

/// The wavelengths that stand for R, G and B, nm.
const RGB_NM: [f64; 3] = [650.0, 550.0, 450.0];

/// All colours of a plain table. Of wavelengths the three that stand for R, G and B; where there are no three, the middle
/// one.
pub fn shown_colours(table: &BrdfTable) -> Vec<usize> {
    if !table.is_spectral() {
        return (0..table.colours.len()).collect();
    }
    let nearest = |nm: f64| {
        let off =
            |colour: usize| table.colours[colour].wavelength_nm.map_or(f64::INFINITY, |at| (at - nm).abs());
        (0..table.colours.len()).min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(0)
    };
    let rgb = RGB_NM.map(nearest);
    if rgb[0] > rgb[1] && rgb[1] > rgb[2] { rgb.to_vec() } else { vec![table.colours.len() / 2] }
}

/// The table in the colours that are shown, and what is left out in words.
pub fn in_shown_colours(table: &BrdfTable) -> (BrdfTable, Option<String>) {
    let shown = shown_colours(table);
    let names = table.colour_names();
    let kept: Vec<&str> = shown.iter().map(|&colour| names[colour].as_str()).collect();
    let note = (kept.len() < names.len())
        .then(|| format!("of {} wavelengths only {}", names.len(), kept.join(", ")));
    let colours = shown.iter().map(|&colour| table.colours[colour].clone()).collect();
    (BrdfTable { colours, hits: table.hits.clone(), ..table.header(&table.grid) }, note)
}
