//! What `gonio appearance` prints.

use crate::appearance::colorimetry::{Illuminant, Observer};
use crate::appearance::report::AppearanceAtAzimuth;
use crate::appearance::{Appearance, Quantity};
use crate::cli::text::layout::{columns, wrapped};
use crate::cli::text::numbers::with_error;

/// Azimuths that are printed; JSON and CSV have all.
const MOST_AZIMUTHS: usize = 4;

/// Remarks that are printed below a table.
const MOST_REMARKS: usize = 4;

/// Reasons, and which figures they are said of.
#[derive(Default)]
struct Remarks(Vec<(String, Vec<String>)>);

impl Remarks {
    /// Notes why a figure is missing or how it came about.
    fn add(&mut self, name: String, quantity: &Quantity) {
        let Some(note) = &quantity.note else { return };
        let text = if quantity.value.is_none() { format!("n/a: {note}") } else { note.clone() };
        match self.0.iter_mut().find(|(known, _)| *known == text) {
            Some((_, names)) => names.push(name),
            None => self.0.push((text, vec![name])),
        }
    }

    fn lines(self) -> Vec<String> {
        let rest = self.0.len().saturating_sub(MOST_REMARKS);
        let line =
            |(text, names): (String, Vec<String>)| wrapped("  ", &format!("{}: {text}", names.join(", ")));
        let more = (rest > 0).then(|| format!("  {rest} more such remarks; --json has all"));
        self.0.into_iter().take(MOST_REMARKS).flat_map(line).chain(more).collect()
    }
}

/// The figures of every azimuth, up to some.
pub fn lines(found: &Appearance) -> Vec<String> {
    let mut lines = wrapped("colours  ", &found.colours);
    let errors = match found.realisations {
        0 => "n/a: no realisations are next to the table".into(),
        count => format!("standard errors of a jackknife over {count} realisations"),
    };
    lines.extend(wrapped("errors   ", &errors));
    for at in found.azimuths.iter().take(MOST_AZIMUTHS) {
        if found.azimuths.len() > 1 {
            lines.push(String::new());
            lines.push(format!("light from phi_i {}", at.phi_i_deg));
        }
        lines.extend([glossy(at), scattered(at), coloured(at)].concat());
    }
    if found.azimuths.len() > MOST_AZIMUTHS {
        let rest = format!("{MOST_AZIMUTHS} of {} azimuths; --json and -o have all", found.azimuths.len());
        lines.extend(wrapped("", &rest));
    }
    lines
}

fn shown(quantity: &Quantity) -> String {
    match (quantity.value, quantity.se) {
        (None, _) => "n/a".into(),
        // That there are no errors stands above.
        (Some(value), None) => format!("{value:.4}"),
        (Some(value), se) => with_error(value, se),
    }
}

fn glossy(at: &AppearanceAtAzimuth) -> Vec<String> {
    let haze = &at.haze;
    let of_gloss = at.gloss.iter().map(|gloss| (format!("gloss {}", gloss.angle_deg), &gloss.gloss));
    let of_haze = [
        ("haze 20", &haze.reflection_haze),
        ("log haze 20", &haze.log_haze),
        ("haze 30/2", &haze.haze_2),
        ("haze 30/5", &haze.haze_5),
        ("DOI 30", &haze.doi),
    ];
    let all = of_gloss.chain(of_haze.map(|(name, quantity)| (name.to_string(), quantity)));
    let (mut rows, mut remarks) = (Vec::new(), Remarks::default());
    for (name, quantity) in all {
        let bins = quantity.bins.filter(|_| quantity.value.is_some());
        rows.push(vec![
            name.clone(),
            shown(quantity),
            bins.map_or(String::new(), |bins| format!("{bins:.2}")),
        ]);
        remarks.add(name, quantity);
    }
    let heads = ["angle", "gloss units, indices", "bins"];
    [vec![String::new()], columns(&heads, &rows), remarks.lines()].concat()
}

fn scattered(at: &AppearanceAtAzimuth) -> Vec<String> {
    let mut remarks = Remarks::default();
    let rows: Vec<Vec<String>> = at
        .scatter
        .iter()
        .map(|scatter| {
            remarks.add(format!("reflectance at {}", scatter.theta_i_deg), &scatter.reflectance);
            remarks.add(format!("TIS at {}", scatter.theta_i_deg), &scatter.tis);
            vec![scatter.theta_i_deg.to_string(), shown(&scatter.reflectance), shown(&scatter.tis)]
        })
        .collect();
    [vec![String::new()], columns(&["theta_i", "reflectance", "TIS"], &rows), remarks.lines()].concat()
}

fn coloured(at: &AppearanceAtAzimuth) -> Vec<String> {
    let (mut rows, mut remarks) = (Vec::new(), Remarks::default());
    let mut has_colours = false;
    for reflected in &at.reflectance {
        let name = match reflected.geometry.as_str() {
            geometry @ ("mirror" | "hemisphere") => format!("{geometry} {}", reflected.theta_i_deg),
            geometry => geometry.into(),
        };
        // Without colours the hemisphere's reflectances stand above.
        if reflected.geometry == "hemisphere" && reflected.colours.is_empty() {
            continue;
        }
        remarks.add(name.clone(), &reflected.factor);
        if reflected.factor.value.is_none() {
            continue;
        }
        let daylight = reflected
            .colours
            .iter()
            .find(|colour| (colour.observer, colour.illuminant) == (Observer::Two, Illuminant::D65));
        has_colours |= daylight.is_some();
        let lab = daylight.map_or(vec![], |colour| {
            (0..3).map(|k| short(colour.lab[k], colour.lab_se[k])).collect::<Vec<_>>()
        });
        rows.push([vec![name, shown(&reflected.factor)], lab].concat());
    }
    let heads = ["geometry", "factor", "L*", "a*", "b*"];
    let heads = if has_colours { &heads[..] } else { &heads[..2] };
    let title = if has_colours { "colours under D65, 2 degrees; --json and -o have the others" } else { "" };
    let table = if rows.is_empty() { Vec::new() } else { columns(heads, &rows) };
    [
        vec![String::new()],
        (!title.is_empty()).then(|| title.into()).into_iter().collect(),
        table,
        remarks.lines(),
    ]
    .concat()
}

/// A coordinate of a colour with its error, two digits after the point.
fn short(value: f64, se: Option<f64>) -> String {
    se.map_or(format!("{value:.2}"), |se| format!("{value:.2} +- {se:.2}"))
}
