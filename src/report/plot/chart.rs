//! One chart as SVG: axes with ticks, lines, bands, points and a legend below the frame.
//!
//! Input: series of numbers. Output: text that reads the same in grey: every series has a dash or a marker of its own.

use crate::error::is_unseen;
use std::fmt::Write;

/// Size of the frame, and the room to its left, right, top and bottom (without the legend).
const FRAME: [f64; 2] = [400.0, 230.0];
const ROOM: [f64; 4] = [66.0, 14.0, 34.0, 62.0];
const LEGEND_ROW: f64 = 22.0;
/// Room of a letter in the legend and of a sample of a line.
const LETTER: f64 = 7.6;
const SAMPLE: f64 = 34.0;

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

/// One series.
#[derive(Debug, Clone)]
pub struct Series {
    /// Its name in the legend; empty: not listed.
    pub label: String,
    /// (x, y), x increasing.
    pub points: Vec<[f64; 2]>,
    /// Half-width of the error band or bar at each point; empty: none.
    pub error: Vec<f64>,
    /// How it looks.
    pub style: SeriesStyle,
}

/// One axis.
#[derive(Debug, Clone)]
pub struct ChartAxis {
    /// Quantity and unit.
    pub label: String,
    /// Lowest and highest value shown.
    pub range: [f64; 2],
    /// Whether it is logarithmic.
    pub log: bool,
    /// Distance of the ticks; `None`: a round number that suits.
    pub step: Option<f64>,
}

impl ChartAxis {
    /// A linear axis.
    pub fn linear(label: &str, range: [f64; 2]) -> Self {
        ChartAxis { label: label.into(), range, log: false, step: None }
    }

    /// An axis of angles, ticks at multiples of 15, 30 or 60 degrees.
    pub fn degrees(label: &str, range: [f64; 2]) -> Self {
        let width = range[1] - range[0];
        let step = [15.0, 30.0, 60.0].into_iter().find(|step| width / step <= 6.0).unwrap_or(90.0);
        ChartAxis { step: Some(step), ..ChartAxis::linear(label, range) }
    }

    /// A logarithmic axis from the decade at or below to that at or above.
    pub fn decades(label: &str, [low, high]: [f64; 2]) -> Self {
        let first = low.log10().floor();
        let last = high.log10().ceil().max(first + 1.0);
        ChartAxis { label: label.into(), range: [10f64.powf(first), 10f64.powf(last)], log: true, step: None }
    }

    /// Where a value lies between the ends, 0 to 1 inside.
    fn place(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if self.log { (value / low).log10() / (high / low).log10() } else { (value - low) / (high - low) }
    }

    /// The values that get a tick and a number.
    fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.range;
        if self.log {
            let (first, last) = (low.log10().round() as i32, high.log10().round() as i32);
            let step = ((last - first) as usize).div_ceil(6).max(1);
            return (first..=last).step_by(step).map(|k| (10f64.powi(k), decade(k))).collect();
        }
        let step = self.step.unwrap_or_else(|| nice_step((high - low) / 5.0));
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        (first..=last).map(|k| (k as f64 * step, format!("{:.decimals$}", k as f64 * step))).collect()
    }
}

/// 10^k as SVG text.
fn decade(k: i32) -> String {
    match k {
        0 => "1".into(),
        1 => "10".into(),
        -1 => "0.1".into(),
        _ => format!("10<tspan dy=\"-6\" font-size=\"11\">{k}</tspan>"),
    }
}

/// 1, 2, 3 or 5 (as degrees like it) times a power of ten, at least `rough`.
fn nice_step(rough: f64) -> f64 {
    let unit = 10f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 3.0, 5.0, 10.0];
    unit * steps.into_iter().find(|step| step * unit >= rough * 0.999).unwrap_or(10.0)
}

/// One chart.
#[derive(Debug, Clone)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// To the right.
    pub x: ChartAxis,
    /// Upwards.
    pub y: ChartAxis,
    /// The series; the first lies at the bottom.
    pub series: Vec<Series>,
}

/// Text that is safe inside HTML and SVG, attributes included.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if is_unseen(c) && !matches!(c, '\n' | '\t') => out.push(char::REPLACEMENT_CHARACTER),
            c => out.push(c),
        }
    }
    out
}

impl Chart {
    /// The chart as an `<svg>` element.
    pub fn svg(&self) -> String {
        let [width, height] = self.size();
        let title = escaped(&self.title);
        format!(
            "<svg class=\"chart\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}\">\n{}</svg>\n",
            self.content()
        )
    }

    /// Width and height.
    pub fn size(&self) -> [f64; 2] {
        let rows = self.legend().iter().map(|entry| entry.row + 1).max().unwrap_or(0);
        [ROOM[0] + FRAME[0] + ROOM[1], ROOM[2] + FRAME[1] + ROOM[3] + LEGEND_ROW * rows as f64]
    }

    /// What stands in the element.
    pub fn content(&self) -> String {
        let mut out = Drawing::new();
        out.add(format_args!(
            "<text x=\"8\" y=\"20\" font-weight=\"bold\">{}</text>\n<g transform=\"translate({} {})\">",
            escaped(&self.title),
            ROOM[0],
            ROOM[2]
        ));
        self.axes(&mut out);
        out.add("<svg class=\"inside\" width=\"400\" height=\"230\">");
        self.series.iter().for_each(|series| self.draw(&mut out, series));
        out.add("</svg>");
        self.legend().iter().for_each(|entry| entry.draw(&mut out));
        out.text() + "</g>"
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        // A logarithmic axis has no place for 0: far below is as good, and the frame clips it.
        let y = self.y.place(y).clamp(-10.0, 10.0);
        [FRAME[0] * self.x.place(x), FRAME[1] * (1.0 - y)]
    }

    fn axes(&self, out: &mut Drawing) {
        let [width, height] = FRAME;
        for (value, label) in self.x.ticks() {
            let x = width * self.x.place(value);
            out.add(format_args!(
                "<path class=\"grid\" d=\"M{x:.1} 0V{height}\"/>\
                 <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                height + 19.0
            ));
        }
        for (value, label) in self.y.ticks() {
            let y = height * (1.0 - self.y.place(value));
            out.add(format_args!(
                "<path class=\"grid\" d=\"M0 {y:.1}H{width}\"/>\
                 <text x=\"-8\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
                y + 5.0
            ));
        }
        out.add(format_args!(
            "<rect width=\"{width}\" height=\"{height}\" class=\"frame\"/>\n\
             <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n\
             <text transform=\"translate(-50 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            width / 2.0,
            height + 41.0,
            escaped(&self.x.label),
            height / 2.0,
            escaped(&self.y.label)
        ));
    }

    fn draw(&self, out: &mut Drawing, series: &Series) {
        let SeriesStyle { colour, dashes, marker, line } = series.style;
        let places: Vec<[f64; 2]> = series.points.iter().map(|&point| self.at(point)).collect();
        if !series.error.is_empty() {
            let edge = |sign: f64| {
                let ends = series.points.iter().zip(&series.error);
                ends.map(move |(&[x, y], error)| self.at([x, y + sign * error]))
            };
            if line {
                let around: Vec<[f64; 2]> = edge(1.0).chain(edge(-1.0).rev()).collect();
                out.add(format_args!(
                    "<polygon class=\"band\" fill=\"{colour}\" points=\"{}\"/>",
                    path(&around)
                ));
            }
            for ([x, top], [_, bottom]) in edge(1.0).zip(edge(-1.0)) {
                out.add(format_args!(
                    "<path class=\"bar\" stroke=\"{colour}\" d=\"M{x:.1} {top:.1}V{bottom:.1}\"/>"
                ));
            }
        }
        if line {
            out.add(format_args!(
                "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\" stroke-dasharray=\"{dashes}\" \
                 points=\"{}\"/>",
                path(&places)
            ));
        }
        places.iter().for_each(|&place| out.marker(marker, place, colour));
    }

    /// The places of the legend's entries: rows below the label of x.
    fn legend(&self) -> Vec<LegendEntry<'_>> {
        let (mut x, mut row) = (-ROOM[0] + 10.0, 0);
        let right = FRAME[0] + ROOM[1];
        let mut entries = Vec::new();
        for series in self.series.iter().filter(|series| !series.label.is_empty()) {
            let width = SAMPLE + 8.0 + LETTER * series.label.chars().count() as f64 + 18.0;
            if x + width > right && x > 0.0 {
                (x, row) = (-ROOM[0] + 10.0, row + 1);
            }
            entries.push(LegendEntry { series, x, row });
            x += width;
        }
        entries
    }
}

/// One entry of a legend.
struct LegendEntry<'a> {
    series: &'a Series,
    x: f64,
    row: usize,
}

impl LegendEntry<'_> {
    fn draw(&self, out: &mut Drawing) {
        let SeriesStyle { colour, dashes, marker, line } = self.series.style;
        let y = FRAME[1] + ROOM[3] + LEGEND_ROW * self.row as f64;
        if line {
            out.add(format_args!(
                "<path fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\" stroke-dasharray=\"{dashes}\" \
                 d=\"M{:.1} {y:.1}h{SAMPLE}\"/>",
                self.x
            ));
        }
        out.marker(marker, [self.x + SAMPLE / 2.0, y], colour);
        let label = escaped(&self.series.label);
        out.add(format_args!("<text x=\"{:.1}\" y=\"{:.1}\">{label}</text>", self.x + SAMPLE + 8.0, y + 5.0));
    }
}

fn path(places: &[[f64; 2]]) -> String {
    places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
}

/// SVG in the making.
pub struct Drawing(String);

impl Drawing {
    /// Nothing yet.
    pub fn new() -> Self {
        Drawing(String::new())
    }

    /// Adds a line of text.
    pub fn add(&mut self, text: impl std::fmt::Display) {
        // Writing to a string does not fail.
        writeln!(self.0, "{text}").ok();
    }

    fn marker(&mut self, marker: Marker, [x, y]: [f64; 2], colour: &str) {
        let open = format!("class=\"open\" stroke=\"{colour}\"");
        match marker {
            Marker::Off => {}
            Marker::Disc => {
                self.add(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\" fill=\"{colour}\"/>"))
            }
            Marker::Ring => self.add(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.4\" {open}/>")),
            Marker::Square => {
                self.add(format_args!("<path d=\"M{:.1} {:.1}h6v6h-6z\" {open}/>", x - 3.0, y - 3.0));
            }
            Marker::Triangle => {
                self.add(format_args!("<path d=\"M{x:.1} {:.1}l4 7h-8z\" {open}/>", y - 4.5));
            }
        }
    }

    /// The text.
    pub fn text(self) -> String {
        self.0
    }
}

impl Default for Drawing {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |axis: ChartAxis| axis.ticks().into_iter().map(|tick| tick.1).collect::<Vec<_>>();
        assert_eq!(
            labels(ChartAxis::degrees("", [-90.0, 90.0])),
            ["-90", "-60", "-30", "0", "30", "60", "90"]
        );
        assert_eq!(labels(ChartAxis::linear("", [0.0, 1.0])), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(ChartAxis::decades("", [0.02, 30.0]).range, [0.01, 100.0]);
        assert_eq!(labels(ChartAxis::decades("", [0.2, 3.0])), ["0.1", "1", "10"]);
    }

    #[test]
    fn names_cannot_break_out_of_the_text() {
        let chart = Chart {
            title: "<script>\"&'".into(),
            x: ChartAxis::linear("x", [0.0, 1.0]),
            y: ChartAxis::linear("y", [0.0, 1.0]),
            series: vec![],
        };
        let svg = chart.svg();
        assert!(svg.contains("&lt;script&gt;&quot;&amp;&#39;") && !svg.contains("<script"), "{svg}");
    }
}
