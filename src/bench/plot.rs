//! The ladders as an SVG picture: error against samples, both logarithmic, a panel for each ladder.

use std::fmt::Write;

use super::ERROR_MEASURE;
use super::fit::LadderFit;
use super::ladder::Varies;
use super::run::{Bench, Ladder};

/// Size of a panel's frame, and the room around it: left, right, top, bottom.
const FRAME: (f64, f64) = (620.0, 360.0);
const MARGIN: [f64; 4] = [92.0, 28.0, 56.0, 64.0];
/// Points of the fitted curve.
const CURVE_STEPS: u32 = 100;
const INK: &str = "#222";
const FIT: &str = "#c4451c";
const POINT: &str = "#1f5fa8";

/// By this a picture is told as one of ours.
pub const MARK: &str = "data-made-by=\"gonio bench\"";

/// The picture as text. Every rung is one `<circle>`, its bar the range of the replicates; the solid curve is
/// sqrt(a/N + b^2), the dashed line falls as 1/sqrt(N) from the first rung, the dotted one is b.
pub fn svg(name: &str, bench: &Bench) -> String {
    let (width, height) = (MARGIN[0] + FRAME.0 + MARGIN[1], MARGIN[2] + FRAME.1 + MARGIN[3]);
    let total = height * bench.ladders.len() as f64;
    let mut out = Svg(String::new());
    out.add(format_args!(
        "<svg {MARK} xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {total}\" width=\"{width}\" \
         height=\"{total}\" font-family=\"sans-serif\" font-size=\"14\" fill=\"{INK}\">\n\
         <rect width=\"{width}\" height=\"{total}\" fill=\"white\"/>"
    ));
    for (index, ladder) in bench.ladders.iter().enumerate() {
        out.add(format_args!(
            "<g transform=\"translate({} {})\">",
            MARGIN[0],
            height * index as f64 + MARGIN[2]
        ));
        panel(&mut out, ladder, &title(name, bench, ladder));
        out.add("</g>");
    }
    out.add("</svg>");
    out.0
}

struct Svg(String);

impl Svg {
    fn add(&mut self, text: impl std::fmt::Display) {
        // Writing to a string does not fail.
        writeln!(self.0, "{text}").ok();
    }

    fn text(&mut self, (x, y): (f64, f64), attributes: &str, text: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        self.add(format_args!("<text x=\"{x:.1}\" y=\"{y:.1}\" {attributes}>{text}</text>"));
    }

    fn line(&mut self, [(x1, y1), (x2, y2)]: [(f64, f64); 2], attributes: &str) {
        self.add(format_args!(
            "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" {attributes}/>"
        ));
    }
}

fn title(name: &str, bench: &Bench, ladder: &Ladder) -> [String; 2] {
    let fixed = match ladder.varies {
        Varies::Samples => {
            format!(
                "{} realisations, more samples in each",
                ladder.rows.first().map_or(0, |r| r.realisations)
            )
        }
        Varies::Realisations => {
            let each = ladder.rows.first().map_or(0, |row| row.samples / u64::from(row.realisations));
            format!("{each} samples in each realisation, more realisations")
        }
    };
    let fit = ladder.fit.map_or("no fit".into(), |fit| {
        let LadderFit { slope, slope_se, b, b_low, b_high, .. } = fit;
        format!("slope {slope:.3} ± {slope_se:.3}, b = {b:.2e} [{b_low:.1e}, {b_high:.1e}]")
    });
    [format!("{name}: {fixed}"), format!("truth: {}; {fit}", bench.truth.name)]
}

/// Both axes: decades that hold every point and bar.
struct Axes {
    x: [f64; 2],
    y: [f64; 2],
}

impl Axes {
    fn of(ladder: &Ladder) -> Self {
        let range = |values: &mut dyn Iterator<Item = f64>| {
            let positive = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
            let (low, high) =
                positive.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            if low > high { [0.0, 1.0] } else { [(low - 0.05).floor(), (high + 0.05).ceil()] }
        };
        Axes {
            x: range(&mut ladder.rows.iter().map(|row| row.samples as f64)),
            y: range(&mut ladder.rows.iter().flat_map(|row| row.errors.iter().copied().chain([row.error]))),
        }
    }

    fn at(&self, samples: f64, error: f64) -> (f64, f64) {
        let place = |value: f64, [low, high]: [f64; 2]| (value.log10() - low) / (high - low);
        // An error of 0 stands on the axis.
        let y = place(error, self.y).clamp(0.0, 1.0);
        (FRAME.0 * place(samples, self.x), FRAME.1 * (1.0 - y))
    }
}

fn panel(out: &mut Svg, ladder: &Ladder, title: &[String; 2]) {
    let axes = Axes::of(ladder);
    out.text((0.0, -32.0), "font-weight=\"bold\"", &title[0]);
    out.text((0.0, -12.0), "", &title[1]);
    decades(out, &axes);
    let middle = (FRAME.0 / 2.0, FRAME.1 + 46.0);
    out.text(middle, "text-anchor=\"middle\"", "samples of one stop, N (all realisations)");
    let turned = format!("text-anchor=\"middle\" transform=\"rotate(-90 -62 {})\"", FRAME.1 / 2.0);
    out.text((-62.0, FRAME.1 / 2.0), &turned, ERROR_MEASURE);
    curves(out, &axes, ladder);
    for row in &ladder.rows {
        let range = |pick: fn(f64, f64) -> f64| row.errors.iter().copied().reduce(pick).unwrap_or(row.error);
        let [low, high] = [f64::min, f64::max].map(|pick| axes.at(row.samples as f64, range(pick)));
        let (x, y) = axes.at(row.samples as f64, row.error);
        let stroke = format!("stroke=\"{POINT}\" stroke-width=\"1.5\"");
        out.line([low, high], &stroke);
        for end in [low, high] {
            out.line([(end.0 - 5.0, end.1), (end.0 + 5.0, end.1)], &stroke);
        }
        out.add(format_args!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"4.5\" fill=\"{POINT}\"/>"));
    }
}

/// Frame, grid and the numbers of the decades.
fn decades(out: &mut Svg, axes: &Axes) {
    let (width, height) = FRAME;
    let whole = |[low, high]: [f64; 2]| (low as i32)..=(high as i32);
    for k in whole(axes.x) {
        let x = axes.at(10f64.powi(k), 1.0).0;
        out.line([(x, 0.0), (x, height)], "stroke=\"#ddd\"");
        let label = format!("10<tspan dy=\"-6\" font-size=\"10\">{k}</tspan>");
        out.add(format_args!(
            "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
            height + 22.0
        ));
    }
    for k in whole(axes.y) {
        let y = axes.at(1.0, 10f64.powi(k)).1;
        out.line([(0.0, y), (width, y)], "stroke=\"#ddd\"");
        let label = format!("10<tspan dy=\"-6\" font-size=\"10\">{k}</tspan>");
        out.add(format_args!("<text x=\"-16\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>", y + 5.0));
    }
    for k in whole([axes.y[0], axes.y[1] - 1.0]) {
        for step in 2..10 {
            let y = axes.at(1.0, f64::from(step) * 10f64.powi(k)).1;
            out.line([(0.0, y), (6.0, y)], &format!("stroke=\"{INK}\""));
        }
    }
    out.add(format_args!("<rect width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"{INK}\"/>"));
}

/// The guide, the fit, the bias, and what they are.
fn curves(out: &mut Svg, axes: &Axes, ladder: &Ladder) {
    let (Some(first), Some(last)) = (ladder.rows.first(), ladder.rows.last()) else { return };
    let (low, high) = (first.samples as f64, last.samples as f64);
    let curve = |of: &dyn Fn(f64) -> f64| {
        let point = |k: u32| {
            let samples = low * (high / low).powf(f64::from(k) / f64::from(CURVE_STEPS));
            let error = of(samples);
            (error.log10() >= axes.y[0]).then(|| axes.at(samples, error))
        };
        (0..=CURVE_STEPS).filter_map(point).map(|(x, y)| format!("{x:.1},{y:.1} ")).collect::<String>()
    };
    let guide = ladder.fit.map_or(first.error, |fit| (fit.a / low).sqrt());
    let mut shown = vec![(curve(&|n| guide * (low / n).sqrt()), "#888", "7 5", "1/√N")];
    if let Some(LadderFit { a, b, .. }) = ladder.fit {
        shown.push((curve(&|n| (a / n + b * b).sqrt()), FIT, "none", "√(a/N + b²)"));
        shown.push((curve(&|_| b), FIT, "2 4", "b"));
    }
    let mut x = 12.0;
    for (points, colour, dashes, label) in shown.iter().filter(|curve| !curve.0.is_empty()) {
        let style = format!("stroke=\"{colour}\" stroke-width=\"1.8\" stroke-dasharray=\"{dashes}\"");
        out.add(format_args!("<polyline points=\"{}\" fill=\"none\" {style}/>", points.trim_end()));
        out.line([(x, FRAME.1 - 16.0), (x + 30.0, FRAME.1 - 16.0)], &style);
        out.text((x + 36.0, FRAME.1 - 11.0), "", label);
        x += 140.0;
    }
}
