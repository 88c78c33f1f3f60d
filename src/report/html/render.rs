//! The page: one self-contained HTML file that asks for nothing, with the viewer's code and data inside.
//!
//! Input: a table, what validation found, its summary. Output: text that depends on these alone.

use serde_json::{Value, json};

use super::figures::figures;
use super::head::head;
use super::inline::{Inline, LARGEST, inline};
use super::page::Page;
use super::{appearance, sections, through};
use crate::error::seen_in_json;
use crate::fit::NearestLaw;
use crate::render::light::{LAMP, TOWARDS_DEG};
use crate::render::{Camera, Sky};
use crate::report::plot::escaped;
use crate::report::slices::Scene;
use crate::sphere;

/// By this a page is recognised as one of ours.
pub const MARK: &str = "<meta name=\"generator\" content=\"gonio\">";

const TEMPLATE: &str = include_str!("assets/page.html");
/// The style of all pages.
const STYLE: &str = include_str!("assets/page.css");
/// What offers plots as files.
const SAVE_SCRIPT: &str = include_str!("assets/save.js");
/// In the order in which they build upon each other.
const SCRIPTS: [&str; 10] = [
    include_str!("assets/table.js"),
    include_str!("assets/colours.js"),
    include_str!("assets/discs.js"),
    include_str!("assets/pictures.js"),
    include_str!("assets/orbit.js"),
    include_str!("assets/lobe.js"),
    include_str!("assets/shading.js"),
    include_str!("assets/scene.js"),
    SAVE_SCRIPT,
    include_str!("assets/main.js"),
];

/// What a page shows of its table.
enum Shown<'a> {
    /// Light that comes back.
    Back,
    /// That, and light that has gone through.
    Both(&'a Page<'a>),
    /// Light that has gone through alone.
    Through,
}

/// The whole file.
///
/// Nothing in it changes from run to run except what the summary says of its cost.
// Tested by `the_page_follows_from_the_table_and_its_summary` (tests/it/report.rs).
pub fn page(page: &Page) -> String {
    let (table, prediction) = (page.scene.table, page.scene.prediction);
    if !table.grid.looks_below() {
        return filled_page(page, &Shown::Back);
    }
    let sides = [false, true].map(|below| {
        let half = table.half(below)?;
        let of_half = prediction.and_then(|prediction| prediction.half(&table.grid, below));
        let bins = table.grid.half(below)?;
        let best = page.best.as_ref().map(|best| NearestLaw {
            name: best.name.clone(),
            means: best.means.iter().map(|colour| bins.of(colour, table.grid.incidences())).collect(),
        });
        Some((half, of_half, page.summary.half(below), best))
    });
    let shown = sides.each_ref().map(|side| {
        let (table, prediction, summary, best) = side.as_ref()?;
        let scene = Scene { table, prediction: prediction.as_ref(), ..page.scene };
        let specimen = page.specimen.clone();
        Some(Page { scene, summary, specimen, best: best.clone(), ..*page })
    });
    match &shown {
        [Some(back), Some(through)] => filled_page(back, &Shown::Both(through)),
        [Some(back), None] => filled_page(back, &Shown::Back),
        [None, through] => {
            through.as_ref().map_or(String::new(), |through| filled_page(through, &Shown::Through))
        }
    }
}

/// The page of a table, or of one half of it that `page` is of.
fn filled_page(page: &Page, shown: &Shown) -> String {
    let of = |page: &Page, largest| inline(page, largest);
    let [back, through] = match shown {
        Shown::Back => [of(page, LARGEST), None],
        Shown::Both(through) => [of(page, LARGEST / 2), of(through, LARGEST / 2)],
        Shown::Through => [None, of(page, LARGEST)],
    };
    let picture = page.specimen.as_ref().ok().map(sections::picture);
    let table = |inlined: &Option<Inline>| inlined.as_ref().map_or(Value::Null, |it| it.data.clone());
    let mut data = json!({
        "name": page.summary.name,
        "table": table(&back),
        "specimen": picture,
        "sphere": sphere_scene(),
    });
    let (mut view, mut hint, mut further, mut first) = ("", "", String::new(), Vec::new());
    let mut scripts = SCRIPTS.to_vec();
    if !matches!(shown, Shown::Back) {
        data["through"] = table(&through);
        data["interface"] = through::interface(page);
        (view, hint) = (through::VIEW, through::HINT);
        // Before the last, which puts all together.
        scripts.insert(scripts.len() - 1, through::SCRIPT);
        further = through::ALONE.into();
    }
    if let Shown::Both(through) = shown {
        further = through::section(through);
        first = through::shares(page, through);
    }
    let halves: Vec<&Inline> = [&back, &through].into_iter().flatten().collect();
    let parts = [
        ("TITLE", escaped(&page.summary.name)),
        ("STYLE", STYLE.to_string()),
        ("HEAD", head(page)),
        ("PROOF", sections::proof(page)),
        ("FIGURES", figures(page)),
        ("SPECIMEN", sections::specimen(page)),
        ("VIEW", view.to_string()),
        ("HINT", hint.to_string()),
        ("PLOTS", sections::plots(page, first)),
        ("THROUGH", further),
        ("APPEARANCE", appearance::section(page)),
        ("REDUCED", sections::reduced(page, &halves)),
        ("FOOT", sections::foot(page)),
        ("DATA", inside_script(&data)),
        ("SCRIPT", format!("\"use strict\";\n{}", scripts.join("\n"))),
    ];
    filled(TEMPLATE, &parts)
}

/// Sky, lamp and camera of the spheres, as `gonio render` has them; its last step is where the light is.
fn sphere_scene() -> Value {
    let [theta_deg, phi_deg] = TOWARDS_DEG;
    let sky = Sky::soft(sphere::direction_deg(theta_deg, phi_deg));
    json!({ "sky": sky, "lamp": LAMP, "camera": Camera::beside(phi_deg) })
}

/// The template with its `{{NAME}}` marks replaced, once and from the left: no part is searched for marks.
fn filled(template: &str, parts: &[(&str, String)]) -> String {
    let mut out = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        out.push_str(before);
        let Some((name, after)) = after.split_once("}}") else { break };
        out.push_str(parts.iter().find(|(mark, _)| *mark == name).map_or("", |(_, text)| text));
        rest = after;
    }
    out.push_str(rest);
    out
}

/// JSON that cannot end the element it stands in, nor turn the text around it.
fn inside_script(data: &Value) -> String {
    seen_in_json(&data.to_string()).replace('<', "\\u003c")
}

/// A page of plots and tables alone: its title, what stands below that, and its sections, all as HTML.
pub(crate) fn plain_page(title: &str, below: &str, sections: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n{MARK}\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; \
         script-src 'unsafe-inline'; img-src data:\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>{title}</h1>\n{below}</header>\n<main>\n{sections}</main>\n\
         <script>\n\"use strict\";\n{SAVE_SCRIPT}\nofferDownloads();\n</script>\n</body>\n</html>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_in_the_parts_stay_as_they_are() {
        let parts = [("A", "{{B}}".to_string()), ("B", "b".to_string())];
        assert_eq!(filled("x{{A}}y{{B}}z{{C}}", &parts), "x{{B}}ybz");
    }

    #[test]
    fn data_cannot_end_its_element() {
        let text = inside_script(&json!({ "name": "</script><!--" }));
        assert!(!text.contains('<'), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).expect("JSON")["name"], "</script><!--");
    }
}
