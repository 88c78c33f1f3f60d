//! SVG as text.

use std::fmt::Write;

use super::style::Marker;
use crate::error::is_unseen;

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

/// A picture of the page: its title, and `content` below it.
pub(super) fn picture(title: &str, [width, height]: [f64; 2], content: &str) -> String {
    let title = escaped(title);
    format!(
        "<svg class=\"chart\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}\">\n{}\n{content}</svg>\n",
        heading(&title)
    )
}

/// Lines of CSV inside a picture, which show nowhere.
pub(super) fn metadata(lines: &[String]) -> String {
    format!("<metadata>\n{}\n</metadata>\n", escaped(&lines.join("\n")))
}

/// A text as a field of CSV.
pub(crate) fn csv_field(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() }
}

/// The title of a picture, escaped already.
pub(super) fn heading(title: &str) -> String {
    format!("<text x=\"8\" y=\"20\" font-weight=\"bold\">{title}</text>")
}

/// Places as a polyline has them.
pub(super) fn path(places: &[[f64; 2]]) -> String {
    places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
}

/// SVG in the making.
#[derive(Default)]
pub struct Drawing(String);

impl Drawing {
    /// Adds a line of text.
    pub fn add(&mut self, text: impl std::fmt::Display) {
        // Writing to a string does not fail.
        writeln!(self.0, "{text}").ok();
    }

    pub(super) fn marker(&mut self, marker: Marker, [x, y]: [f64; 2], colour: &str) {
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
