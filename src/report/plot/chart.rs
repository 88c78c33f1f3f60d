//! One chart as SVG: axes with ticks, lines, bands, points and a legend below the frame.
//!
//! Input: series of numbers. Output: text that reads the same in grey: every series has a dash or a marker of its own.

use super::axis::ChartAxis;
use super::drawing::{Drawing, csv_field, escaped, metadata, path, picture};
use super::style::SeriesStyle;

/// Size of the frame, and the room to its left, right, top and bottom (without the legend).
const FRAME: [f64; 2] = [400.0, 230.0];
const ROOM: [f64; 4] = [66.0, 14.0, 34.0, 62.0];
const LEGEND_ROW: f64 = 22.0;
/// Room of a letter in the legend and of a sample of a line.
const LETTER: f64 = 7.6;
const SAMPLE: f64 = 34.0;
/// Most curves with an error whose bands can be told apart.
const MOST_BANDS: usize = 4;
/// Letters beside the frame: a longer label would lie upon the title.
const LETTERS_UPWARDS: usize = 42;
/// Steps of a curve.
const CURVE: u32 = 60;

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

impl Series {
    /// Without errors.
    pub fn new(label: impl Into<String>, points: Vec<[f64; 2]>, style: SeriesStyle) -> Self {
        Series { label: label.into(), points, error: vec![], style }
    }
}

/// The smallest and the largest of some values; [infinity, 0] without any.
pub(super) fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, 0.0], |[low, high], value| [low.min(value), high.max(value)])
}

/// The curve y(x) between two x, evenly in log x.
pub(super) fn curve(first: f64, last: f64, y: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let at = |k: u32| first * (last / first).powf(f64::from(k) / f64::from(CURVE));
    (0..=CURVE).map(at).map(|x| [x, y(x)]).collect()
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

impl Chart {
    /// The chart as an `<svg>` element.
    pub fn svg(&self) -> String {
        picture(&self.title, self.size(), &(self.data() + &self.content()))
    }

    /// The numbers behind the chart, which the page offers as CSV: a line a point, with the half-width of its error.
    fn data(&self) -> String {
        let mut lines = vec![format!(
            "series,{},{},half-width of the error",
            csv_field(&self.x.label),
            csv_field(&self.y.label)
        )];
        for (k, series) in self.series.iter().enumerate() {
            let name =
                if series.label.is_empty() { format!("series {}", k + 1) } else { series.label.clone() };
            for (place, [x, y]) in series.points.iter().enumerate() {
                let error =
                    series.error.get(place).map_or(String::new(), |error| (*error as f32).to_string());
                lines.push(format!("{},{},{},{error}", csv_field(&name), *x as f32, *y as f32));
            }
        }
        metadata(&lines)
    }

    /// Width and height.
    pub fn size(&self) -> [f64; 2] {
        let rows = self.legend().iter().map(|entry| entry.row + 1).max().unwrap_or(0);
        [ROOM[0] + FRAME[0] + ROOM[1], ROOM[2] + FRAME[1] + ROOM[3] + LEGEND_ROW * rows as f64]
    }

    /// What stands below the title.
    pub fn content(&self) -> String {
        let mut out = Drawing::default();
        out.add(format_args!("<g transform=\"translate({} {})\">", ROOM[0], ROOM[2]));
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
        debug_assert!(self.y.label.chars().count() <= LETTERS_UPWARDS, "too long: {}", self.y.label);
        for (value, label) in self.x.ticks() {
            let x = width * self.x.place(value);
            out.add(format_args!(
                "<path class=\"grid\" d=\"M{x:.1} 0V{height}\"/>\
                 <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                height + 24.0
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
            height + 45.0,
            escaped(&self.x.label),
            height / 2.0,
            escaped(&self.y.label)
        ));
    }

    /// Whether errors are bands besides bars: those of many curves cover each other.
    fn has_bands(&self) -> bool {
        self.series.iter().filter(|series| !series.error.is_empty()).count() <= MOST_BANDS
    }

    fn draw(&self, out: &mut Drawing, series: &Series) {
        let SeriesStyle { colour, dashes, marker, line } = series.style;
        let places: Vec<[f64; 2]> = series.points.iter().map(|&point| self.at(point)).collect();
        if !series.error.is_empty() {
            let edge = |sign: f64| {
                let ends = series.points.iter().zip(&series.error);
                ends.map(move |(&[x, y], error)| self.at([x, y + sign * error]))
            };
            if line && self.has_bands() {
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

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn bands_of_many_curves_do_not_cover_each_other() {
        let chart = |curves: usize| {
            let series = Series {
                error: vec![0.1; 2],
                ..Series::new("a", vec![[0.2, 0.5], [0.8, 0.5]], crate::report::plot::style::series_style(0))
            };
            Chart {
                title: "t".into(),
                x: ChartAxis::linear("x", [0.0, 1.0]),
                y: ChartAxis::linear("y", [0.0, 1.0]),
                series: vec![series; curves],
            }
        };
        for (curves, bands) in [(4, 4), (5, 0)] {
            let svg = chart(curves).svg();
            assert_eq!(
                (svg.matches("class=\"band\"").count(), svg.matches("class=\"bar\"").count()),
                (bands, 2 * curves)
            );
        }
    }
}
