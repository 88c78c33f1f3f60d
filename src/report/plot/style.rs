//! How series look: distinguished by colour, and without colour by dash and marker.

/// How a series looks: distinguished by colour, and without colour by dash and marker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesStyle {
    /// Colour, as in CSS.
    pub colour: &'static str,
    /// Dashes; empty: solid.
    pub dashes: &'static str,
    /// Marker at the points.
    pub marker: Marker,
    /// Whether the points are joined.
    pub line: bool,
}

/// Markers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// None.
    Off,
    /// A filled disc.
    Disc,
    /// An open ring.
    Ring,
    /// An open square.
    Square,
    /// An open triangle.
    Triangle,
}

/// What was measured.
pub const MEASURED: SeriesStyle =
    SeriesStyle { colour: "#111", dashes: "", marker: Marker::Disc, line: true };

const OTHERS: [(&str, &str); 6] = [
    ("#0072b2", "9 4"),
    ("#d55e00", "3 3"),
    ("#008a63", "10 3 2 3"),
    ("#a3336f", "14 5"),
    ("#7a5b00", "2 5"),
    ("#555", "6 2 2 2 2 2"),
];

/// The `index`th of the models.
pub fn model_style(index: usize) -> SeriesStyle {
    let (colour, dashes) = OTHERS[index % OTHERS.len()];
    SeriesStyle { colour, dashes, marker: Marker::Off, line: true }
}

/// The `index`th of the models where it is a row of points.
pub fn ratio_style(index: usize) -> SeriesStyle {
    SeriesStyle { marker: series_style(index).marker, line: false, ..model_style(index) }
}

/// The `index`th of several measured series of one chart.
pub fn series_style(index: usize) -> SeriesStyle {
    let markers = [Marker::Disc, Marker::Ring, Marker::Square, Marker::Triangle];
    let (colour, _) = OTHERS[index % OTHERS.len()];
    let dashes = ["", "7 3"][index / markers.len() % 2];
    SeriesStyle { colour, dashes, marker: markers[index % markers.len()], line: true }
}
